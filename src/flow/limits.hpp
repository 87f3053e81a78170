// What the time step must respect, and the measures of the flow it depends on.
#pragma once

#include "base/petsc.hpp"
#include "field/phase.hpp"
#include "field/sides.hpp"
#include "flow/viscosity.hpp"
#include "grid/domain.hpp"

namespace eulastic {

/// Largest values over the whole grid; found with one Allreduce.
struct FlowExtremes {
  Real3 speed{};         ///< max |u|, |v|, |w|
  double stiffness = 0;  ///< largest_stiffness() over the phases, from the largest tr B of each where it is evolved
  std::vector<double> trace;  ///< largest tr B of each phase, where it is evolved
  double first_bad = -1;      ///< global cell index of the first non-finite velocity or B, -1 = all finite
  double max_speed() const;   ///< of the components
};

/// `bodies`: those of this rank that lie in boxes; they count with the phases of their species. Collective.
PetscErrorCode measure_extremes(const Domain &domain, const Field &velocity, const std::vector<Phase> &phases,
                                FlowExtremes *extremes, const std::vector<BodyInBox> &bodies = {});

/// Largest principal stretch squared of an incompressible deformation with tr B = trace (uniaxial in 3-D).
double stretch_squared(double trace, int dimension);
/// Largest principal value of the inverse of B for that trace (equibiaxial in 3-D).
double inverse_stretch_squared(double trace, int dimension);

/// Bound of rho c^2 of the shear waves in a body with tr B <= trace: the largest tangent stiffness, pressure units.
double largest_stiffness(const Material &material, double trace, int dimension);

/// Which limits hold.
struct StepScheme {
  bool staggered = false;  ///< second order (Adams-Bashforth, Heun), else Euler
  bool rkl = false;        ///< super time stepping: no viscous limit, and stiff solids follow the fluid
};

/// Upper bounds on dt; infinite where the term is absent.
struct TimeStepLimits {
  StepScheme scheme;
  double viscous;            ///< 1/(2 nu S), S = sum 1/h^2, nu the largest; what a plain explicit step bears
  double elastic;            ///< 1/(c sqrt(S))
  double combined;           ///< dt^2 c^2 S + 2 nu dt S = 1
  double kelvin_voigt;       ///< 2 mu/stiffness
  double advective;          ///< sum (|u_i| + |f_i| dt) dt/h_i = share, the share of the scheme included; walls count
  double inertial;           ///< 2 nu/U^2, where Euler's anti-diffusion eats the viscosity
  double capillary;          ///< sqrt(rho h^3/(2 pi sigma)), the shortest capillary wave
  double capillary_viscous;  ///< h mu/sigma, of surfaces that follow their tension as viscosity lets them
  double bending;            ///< sqrt(8 rho/(E_b k^5)), k = pi/(2 h): the shortest bending wave that is felt
  double bending_viscous;    ///< 8 mu/(E_b k^3), of membranes that follow their bending as viscosity lets them
  double bonds = HUGE_VAL;   ///< FlowPart::largest_step() of all parts
  double forcing;            ///< the shortest period of walls, sides and body force
  /// The automatic step and the name of what sets it.
  double automatic(const char **name = nullptr) const;
  /// Name of the first stability limit that dt breaks, or null.
  const char *broken(double dt) const;
};

/// `contrast`: of the bodies that `extremes` are of.
TimeStepLimits time_step_limits(const Real3 &spacing, int dimension, const Fluid &fluid,
                                const ViscosityContrast &contrast, const BoxSides &sides, const FlowExtremes &extremes,
                                const StepScheme &scheme);
inline TimeStepLimits time_step_limits(const Box &box, const Fluid &fluid, const ViscosityContrast &contrast,
                                       const BoxSides &sides, const FlowExtremes &extremes, const StepScheme &scheme) {
  return time_step_limits(box.spacing(), box.dimension(), fluid, contrast, sides, extremes, scheme);
}

}  // namespace eulastic
