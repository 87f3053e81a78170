// Variable viscosity, where a species has another viscosity than the fluid; docs/method.md, section 16.
#pragma once

#include "base/petsc.hpp"
#include "field/boundaries.hpp"
#include "field/material.hpp"
#include "field/phase.hpp"
#include "flow/local_viscosity.hpp"
#include "grid/active_segments.hpp"

#include <limits>

namespace eulastic {

/// Range of the viscosities of fluid and bodies, and parameters of surfaces that limit the time step.
struct ViscosityContrast {
  double fluid, least, most;  ///< dynamic viscosities of the fluid, and the extremes of all
  double kelvin_voigt = std::numeric_limits<double>::infinity();  ///< least 2 mu/(rho c^2) of all cells with solid
  double surface_tension = 0;                                     ///< largest of all species
  double capillary_speed = 0;  ///< largest sigma over the mean viscosity on both sides of a surface
  double bending_modulus = 0;  ///< largest of all species
  double bending_rate = 0;     ///< largest E_b over the mean viscosity on both sides of a surface

  explicit ViscosityContrast(const Fluid &f) : fluid(f.viscosity), least(f.viscosity), most(f.viscosity) {}
  /// Adds a body with the largest rho c^2 in it.
  void add(const Material &material, double stiffness);
  bool exists() const { return least < most; }
  /// Whether all viscosities are within this factor of that of the fluid.
  bool within(double factor) const { return most <= factor * fluid && fluid <= factor * least; }
  /// Whether the pressure may be extrapolated to the next step. Beyond the factor it would oscillate for a hundred
  /// steps and more (docs/method.md, section 16).
  bool allows_pressure_extrapolation() const { return exists() && within(20); }
};

/// The variable viscosity for given phases.
struct LocalViscosity {
  Field fields;             ///< see flow/local_viscosity.hpp
  ActiveSegments cut;       ///< cells around surfaces, including one ghost layer
  ActiveSegments stressed;  ///< cells of `cut` with an excess along the surface, and further cells
  ActiveSegments beside;    ///< points whose faces feel the stress of these cells
  Field stress;             ///< symmetric, at centres; work space, 0 outside `stressed`

  /// Components of both fields.
  static int components(int dimension) {
    return viscosity_fields(dimension) + static_cast<int>(tensor_components(dimension).size());
  }
  LocalViscosity() = default;
  explicit LocalViscosity(const Box &box);
  std::size_t bytes() const { return fields.bytes() + stress.bytes(); }
  explicit operator bool() const { return static_cast<bool>(fields); }
};

/// Computes harmonic means, weighted by the solid fractions at centres and over four centres on edges, and the excess
/// of arithmetic means along surfaces, which is 0 in cells beside boundaries other than planes of symmetry. Sets
/// centres in one ghost layer and all edges of owned cells. phi needs two ghosts.
PetscErrorCode compute_viscosity(const Box &box, const Fluid &fluid, const BoundaryConditions &sides,
                                 const std::vector<Phase> &phases, LocalViscosity *viscosity);

}  // namespace eulastic
