// A molecular bond as a spring with rates of formation and rupture: Bell (1978), Dembo et al. (1988); docs/method.md,
// (37) to (39).
#pragma once

#include <cmath>

namespace eulastic::kernels {

/// Parameters and rates of a bond.
struct BondLaw {
  double stiffness = 0;              ///< k, force per length
  double length = 0;                 ///< l_0, length without tension
  double reach = 0;                  ///< receptors up to this distance may bind
  double rate_on = 0, rate_off = 0;  ///< rates of formation and rupture of a bond without tension, per time
  double reactive_compliance = 0;    ///< x_b/kT of a slip bond: the rate of rupture grows as exp(F x_b/kT)
  double catch_rate_off = 0;    ///< catch bond: rate of a second path of rupture, falls as exp(-F catch_compliance)
  double catch_compliance = 0;  ///< 1/force
  double thermal_energy = 0;    ///< kT; 0: the rate of formation does not depend on the distance

  /// Returns the tension at a length; negative if the bond is compressed.
  double tension(double at) const noexcept { return stiffness * (at - length); }
  double energy(double at) const noexcept { return 0.5 * stiffness * (at - length) * (at - length); }
  /// Returns the rate of rupture at a tension. Compression does not change it.
  double off_rate(double tension) const noexcept {
    const double F = tension > 0 ? tension : 0;
    return rate_off * std::exp(F * reactive_compliance) + catch_rate_off * std::exp(-F * catch_compliance);
  }
  /// Returns the rate of formation of a bond of this length. With kT > 0, on/off = (on/off)(l_0) exp(-energy/kT), which
  /// is detailed balance.
  double on_rate(double at) const noexcept {
    if (at > reach) return 0;
    if (!(thermal_energy > 0)) return rate_on;
    return rate_on * (off_rate(tension(at)) / off_rate(0)) * std::exp(-energy(at) / thermal_energy);
  }
};

/// Returns the probability that an event of a constant rate happens within dt.
inline double probability(double rate, double dt) noexcept { return -std::expm1(-rate * dt); }

}  // namespace eulastic::kernels
