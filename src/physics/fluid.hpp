// The fluid and what drives it.
#pragma once

#include "grid/grid.hpp"

#include <cmath>

namespace eulastic {

/// f cos(frequency t + phase), a force per mass.
struct BodyForce {
  Real3 force{};         ///< length / time^2
  double frequency = 0;  ///< angular
  double phase = 0;      ///< rad
  Real3 at(double time) const {
    const double factor = frequency == 0 && phase == 0 ? 1.0 : std::cos(frequency * time + phase);
    return {force[0] * factor, force[1] * factor, force[2] * factor};
  }
};

struct Fluid {
  double density = 1;    ///< rho
  double viscosity = 1;  ///< mu, dynamic; of bodies too, unless they have their own
  bool inertia = true;   ///< false drops v.grad v
  BodyForce body_force;
  double kinematic_viscosity() const { return viscosity / density; }
};

}  // namespace eulastic
