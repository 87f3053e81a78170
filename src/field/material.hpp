// Material properties of the fluid and of a body.
#pragma once

#include "grid/box.hpp"
#include "kernels/membrane_law.hpp"

#include <cmath>
#include <vector>

namespace eulastic {

/// The force per mass f cos(frequency t + phase).
struct BodyForce {
  Real3 force{};         ///< length / time^2
  double frequency = 0;  ///< angular, 1 / time
  double phase = 0;      ///< rad
  bool acts() const { return force != Real3{}; }
  Real3 at(double time) const {
    const double factor = frequency == 0 && phase == 0 ? 1.0 : std::cos(frequency * time + phase);
    return {force[0] * factor, force[1] * factor, force[2] * factor};
  }
};

/// Parameters of the fluid.
struct Fluid {
  double density = 1;    ///< rho
  double viscosity = 1;  ///< mu, dynamic; also of bodies without a viscosity of their own
  bool inertia = true;   ///< false omits v.grad v
  BodyForce body_force;
  double kinematic_viscosity() const { return viscosity / density; }
  /// Returns rho in terms that belong to v.grad v: kinetic energy through a boundary, dynamic pressure of backflow.
  double inertial_density() const { return inertia ? density : 0; }
};

/// red_cell occurs in options only: it stands for a membrane with the parameters of a red blood cell.
enum class Law { neo_hookean, mooney_rivlin, membrane, red_cell, rigid };
using kernels::Membrane;

/// Pulls both ends of a body apart along x, as optical tweezers do; docs/method.md, (27a).
struct StretchForce {
  double force = 0;      ///< on each end, outwards; in 2-D per unit depth
  double volume = 0.02;  ///< of each end, as a fraction of the body's volume

  /// Returns the force along x in each column of cells across x, per volume of the body in it, from the volumes in
  /// these columns. It is positive in the columns at the high end and negative at the low end, until each contains the
  /// fraction `volume`.
  std::vector<double> per_volume(const std::vector<double> &volumes) const;
};

/// An incompressible hyperelastic solid with the strain energy W = c1 (I - 3) + c2 (II - 3) + c3 (I - 3)^2 per volume,
/// where I and II are the invariants of B (Sugiyama et al., J. Comput. Phys. 230, 2011); neo-Hookean: c1 = G/2 alone.
struct Material {
  double shear_modulus = 0;  ///< G of the undeformed solid, a pressure
  bool anchored = false;     ///< anchored to a wall or boundary, hardly moving (slab, tube)
  Law law = Law::neo_hookean;
  double c1 = 0, c2 = 0, c3 = 0;  ///< pressures; not used by neo-Hookean
  double viscosity = 0;           ///< dynamic; 0: that of the fluid
  double surface_tension = 0;     ///< force per length
  BodyForce body_force{};         ///< of this species, per mass
  Membrane membrane{};            ///< used by Law::membrane: then B is B_s, with all components at centres
  StretchForce stretch_force{};   ///< used by Law::membrane

  bool is_rigid() const { return law == Law::rigid; }
  bool is_membrane() const { return law == Law::membrane; }
  /// Whether the surface exerts forces.
  bool has_surface() const { return is_membrane() || surface_tension > 0; }
  /// Whether the body has elastic stress. If not, it is a drop or a marked part of the fluid, and its B is I.
  bool elastic() const { return shear_modulus > 0 || c3 > 0; }
  /// Whether the phase transports a tensor: B, or B_s of a membrane.
  bool carries_tensor() const { return elastic() || is_membrane(); }
};

/// Returns the dynamic viscosity of a body.
inline double viscosity_of(const Material &material, const Fluid &fluid) {
  return material.viscosity > 0 ? material.viscosity : fluid.viscosity;
}

}  // namespace eulastic
