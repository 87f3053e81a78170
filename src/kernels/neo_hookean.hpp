// The neo-Hookean law: sigma = G phi dev B, (3). Every law is a struct with the members of this one.
#pragma once

#include "kernels/tensor.hpp"

namespace eulastic::kernels {

/// Stress and energy of the neo-Hookean law at one point.
struct NeoHookean {
  /// Whether the stress contains products of off-diagonal components, so that the normal stress at a centre reads its
  /// edges.
  static constexpr bool couples_edges = false;
  double modulus;  ///< G

  NeoHookean scaled(double factor) const noexcept { return {factor * modulus}; }
  double shear_modulus() const noexcept { return modulus; }  ///< at rest
  /// The tangential traction on a plane with the normal n over the tangential part of Bn is shear_modulus() +
  /// stiffening() (tr B - 3).
  double stiffening() const noexcept { return 0; }
  /// Flops of the force per face.
  static constexpr double flops(int dimension) noexcept { return dimension == 2 ? 32 : 57; }
  /// Returns the largest rho c^2 of an elastic wave, (20).
  double stiffness(const StretchBounds &b) const noexcept { return modulus * b.stretch; }

  /// Returns sigma_aa - tr sigma / 3 at the centre at offset i.
  template <int Dim>
  EULASTIC_INLINE double normal_stress(double phi, const TensorAt<Dim> &t, std::ptrdiff_t i) const noexcept {
    const double zz = Dim == 3 ? t.cc[i] : 1.0;
    return modulus * phi * (1. / 3) * ((t.aa[i] - t.bb[i]) + (t.aa[i] - zz));
  }
  /// Returns sigma_ab on the edge at offset i.
  template <int Dim>
  EULASTIC_INLINE double shear_stress(const double *phi, const TensorAt<Dim> &t, std::ptrdiff_t i) const noexcept {
    return modulus * average4(phi + i, -t.a, -t.b) * t.ab[i];
  }
  /// Returns the factor of B_ab in the stress at a centre, over phi.
  template <int Dim>
  EULASTIC_INLINE double shear_factor(const TensorAt<Dim> &, std::ptrdiff_t) const noexcept {
    return modulus;
  }
  /// Returns W at a centre, over phi.
  template <int Dim>
  EULASTIC_INLINE double energy(const TensorAt<Dim> &t, std::ptrdiff_t i) const noexcept {
    return 0.5 * modulus * excess_trace(t, i);
  }
};

}  // namespace eulastic::kernels
