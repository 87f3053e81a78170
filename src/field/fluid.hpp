// The fluid and its body force.
#pragma once

#include "field/body_force.hpp"
#include "field/material.hpp"

namespace eulastic {

/// Parameters of the fluid.
struct Fluid {
  double density = 1;    ///< rho
  double viscosity = 1;  ///< mu, dynamic; also of bodies without a viscosity of their own
  bool inertia = true;   ///< false omits v.grad v
  BodyForce body_force;
  double kinematic_viscosity() const { return viscosity / density; }
};

/// Returns the dynamic viscosity of a body.
inline double viscosity_of(const Material &material, const Fluid &fluid) {
  return material.viscosity > 0 ? material.viscosity : fluid.viscosity;
}

}  // namespace eulastic
