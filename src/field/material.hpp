// What the fluid and a body are made of.
#pragma once

#include "grid/box.hpp"
#include "kernels/membrane_law.hpp"

#include <cmath>
#include <vector>

namespace eulastic {

/// f cos(frequency t + phase).
struct BodyForce {
  Real3 force{};         ///< length / time^2
  double frequency = 0;  ///< angular
  double phase = 0;      ///< rad
  bool acts() const { return force != Real3{}; }
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

/// red_cell: of options alone, a membrane with the numbers of a red blood cell.
enum class Law { neo_hookean, mooney_rivlin, membrane, red_cell, rigid };
using kernels::Membrane;

/// Pulls both ends of a body apart along x, as optical tweezers do; docs/method.md, (27a).
struct StretchForce {
  double force = 0;      ///< on each end, outwards; 2-D: per depth
  double volume = 0.02;  ///< of the body, the part at each end

  /// From the volumes of a body in columns of cells across x: the force along x in each column, per volume of it. It
  /// acts on the columns at the high end, and against x on those at the low end, until `volume` of the body is reached.
  std::vector<double> per_volume(const std::vector<double> &volumes) const;
};

/// Incompressible hyperelastic solid with the strain energy W = c1 (I - 3) + c2 (II - 3) + c3 (I - 3)^2 per volume, I
/// and II the invariants of B (Sugiyama et al., J. Comput. Phys. 230, 2011); neo-Hookean: c1 = G/2 alone.
struct Material {
  double shear_modulus = 0;  ///< G at rest, pressure units
  bool attached = false;     ///< to a wall, hardly moving (slab, tube)
  Law law = Law::neo_hookean;
  double c1 = 0, c2 = 0, c3 = 0;  ///< pressure units; neo-Hookean: unused
  double viscosity = 0;           ///< dynamic; 0: the fluid's
  double surface_tension = 0;     ///< force per length
  BodyForce body_force{};         ///< of its own, per mass
  Membrane membrane{};            ///< Law::membrane: B is B_s, all of it at centres
  StretchForce stretch_force{};   ///< Law::membrane

  bool is_rigid() const { return law == Law::rigid; }
  bool is_membrane() const { return law == Law::membrane; }
  /// Whether its surface exerts forces.
  bool has_surface() const { return is_membrane() || surface_tension > 0; }
  /// false: a marked part of the fluid, or a drop; its B is I.
  bool elastic() const { return shear_modulus > 0 || c3 > 0; }
  /// Whether anything is remembered beside phi: B, or B_s of a membrane.
  bool carries_tensor() const { return elastic() || is_membrane(); }
};

/// Dynamic viscosity of a body.
inline double viscosity_of(const Material &material, const Fluid &fluid) {
  return material.viscosity > 0 ? material.viscosity : fluid.viscosity;
}

}  // namespace eulastic
