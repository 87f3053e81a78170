// The viscosity where a species has another one than the fluid; docs/method.md, "Viscosity contrast".
#pragma once

#include "base/petsc.hpp"
#include "field/material.hpp"
#include "field/phase.hpp"
#include "field/sides.hpp"
#include "flow/local_viscosity.hpp"
#include "grid/active_segments.hpp"

#include <limits>

namespace eulastic {

/// How far the viscosities of fluid and bodies lie apart, and what follows for the time step.
struct ViscosityContrast {
  double fluid, least, most;                                      ///< dynamic viscosities
  double kelvin_voigt = std::numeric_limits<double>::infinity();  ///< least 2 mu/(rho c^2) of any cell with solid
  double surface_tension = 0;                                     ///< the largest
  double capillary_speed = 0;  ///< the largest sigma over the mean viscosity on both sides of a surface
  double bending_modulus = 0;  ///< the largest
  double bending_rate = 0;     ///< the largest E_b over the mean viscosity on both sides of a surface

  explicit ViscosityContrast(const Fluid &f) : fluid(f.viscosity), least(f.viscosity), most(f.viscosity) {}
  /// A body, with the largest rho c^2 in it.
  void add(const Material &material, double stiffness);
  bool exists() const { return least < most; }
  /// Whether all viscosities lie within that factor of the fluid's.
  bool within(double factor) const { return most <= factor * fluid && fluid <= factor * least; }
  /// Up to this the pressure of the next step can be foreseen; beyond, it would swing for a hundred steps and more.
  bool settles() const { return exists() && within(20); }
};

/// Viscosity where it varies, of the phases of some moment.
struct LocalViscosity {
  Field fields;             ///< flow/local_viscosity.hpp
  ActiveSegments cut;       ///< cells around surfaces, a layer of ghosts included
  ActiveSegments stressed;  ///< those of them that have a viscosity along the surface, and some more
  ActiveSegments beside;    ///< points whose faces feel them
  Field stress;             ///< symmetric, at centres: work space of the force; 0 but for `stressed`

  LocalViscosity() = default;
  explicit LocalViscosity(const Box &box);
  std::size_t bytes() const { return fields.bytes() + stress.bytes(); }
  explicit operator bool() const { return static_cast<bool>(fields); }
};

/// Harmonic means, weighted by the solid fractions at centres and of four centres on edges; along surfaces what
/// arithmetic means have more, but for cells beside sides of the box that are no planes of symmetry. Centres with one
/// layer of ghosts, edges of owned cells on both sides; two ghosts of phi.
PetscErrorCode compute_viscosity(const Box &box, const Fluid &fluid, const BoxSides &sides,
                                 const std::vector<Phase> &phases, LocalViscosity *viscosity);

}  // namespace eulastic
