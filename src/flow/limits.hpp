// Limits of the time step (docs/method.md, section 8) and the extremes of the flow on which they depend.
#pragma once

#include "base/petsc.hpp"
#include "field/boundaries.hpp"
#include "field/phase.hpp"
#include "flow/viscosity.hpp"
#include "grid/domain.hpp"

namespace eulastic {

/// Largest values over the whole grid, computed with one Allreduce.
struct FlowExtremes {
  Real3 speed{};                 ///< max |u|, |v|, |w|
  double stiffness = 0;          ///< largest_stiffness() of all phases, from their largest tr B
  std::vector<double> trace;     ///< largest tr B of each phase at evolving points
  double first_non_finite = -1;  ///< global index of the first cell with a non-finite velocity or B; -1: none
  double max_speed() const;      ///< largest speed of all components
};

/// Computes the extremes of the flow. `bodies`: bodies in boxes of this rank, which count with the phases of their
/// species. Collective.
PetscErrorCode measure_extremes(const Domain &domain, const Field &velocity, const std::vector<Phase> &phases,
                                FlowExtremes *extremes, const std::vector<BodyInBox> &bodies = {});

/// Returns the largest squared principal stretch of an incompressible deformation with tr B = trace (uniaxial in 3-D).
double stretch_squared(double trace, int dimension);
/// Returns the largest principal value of the inverse of B for this trace (equibiaxial in 3-D).
double inverse_stretch_squared(double trace, int dimension);

/// Returns the bound (20) of rho c^2 of the shear waves in a body with tr B <= trace, a pressure.
double largest_stiffness(const Material &material, double trace, int dimension);

/// The time integration, which determines the limits that apply.
struct StepScheme {
  bool staggered = false;  ///< second order (Adams-Bashforth, Heun), otherwise Euler
  bool rkl = false;        ///< super time stepping: no viscous limit, and the Kelvin-Voigt limit for stiff solids
};

/// Upper bounds on dt; infinite where the term is absent.
struct TimeStepLimits {
  StepScheme scheme;
  double viscous;            ///< 1/(2 nu S), S = sum 1/h^2, with the largest nu: limit of a single explicit step
  double elastic;            ///< 1/(c sqrt(S))
  double combined;           ///< dt^2 c^2 S + 2 nu dt S = 1
  double kelvin_voigt;       ///< 2 mu/stiffness
  double advective;          ///< sum (|u_i| + |f_i| dt) dt/h_i = 0.25 (Euler) or 0.3 (staggered); includes wall speeds
  double inertial;           ///< 2 nu/U^2, where the anti-diffusion of Euler cancels the viscosity
  double capillary;          ///< sqrt(rho h^3/(2 pi sigma)), the shortest capillary wave
  double capillary_viscous;  ///< h mu/sigma, where viscosity suppresses capillary waves
  double bending;            ///< sqrt(8 rho/(E_b k^5)), k = pi/(2 h), the shortest bending wave
  double bending_viscous;    ///< 8 mu/(E_b k^3), where viscosity suppresses bending waves
  double bonds = HUGE_VAL;   ///< smallest FlowPart::largest_step() of all parts
  double forcing;            ///< shortest period of walls, boundaries and body force
  /// Returns the automatic step, and in *name the limit that determines it.
  double automatic(const char **name = nullptr) const;
  /// Returns the name of the first stability limit that dt exceeds, or null.
  const char *exceeded_limit(double dt) const;
};

/// Computes the limits. `contrast` and `extremes` must be those of the same bodies.
TimeStepLimits time_step_limits(const Real3 &spacing, int dimension, const Fluid &fluid,
                                const ViscosityContrast &contrast, const BoundaryConditions &sides,
                                const FlowExtremes &extremes, const StepScheme &scheme);
inline TimeStepLimits time_step_limits(const Box &box, const Fluid &fluid, const ViscosityContrast &contrast,
                                       const BoundaryConditions &sides, const FlowExtremes &extremes,
                                       const StepScheme &scheme) {
  return time_step_limits(box.spacing(), box.dimension(), fluid, contrast, sides, extremes, scheme);
}

}  // namespace eulastic
