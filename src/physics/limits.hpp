// What the time step must respect, and the measures of the flow it depends on.
#pragma once

#include "field/phase.hpp"
#include "field/walls.hpp"
#include "physics/fluid.hpp"

namespace eulastic {

/// Largest values over the whole grid; found with one Allreduce.
struct FlowExtremes {
  Real3 speed{};               ///< max |u|, |v|, |w|
  double trace = 3;            ///< max tr B where B is evolved (B_zz = 1 in 2-D)
  double first_bad = -1;       ///< global cell index of the first non-finite velocity or B, -1 = all finite
  double max_speed() const;    ///< of the components
};

PetscErrorCode measure_extremes(const Grid &grid, const FieldBlock &velocity, const std::vector<Phase> &phases,
                                FlowExtremes *extremes);

/// Largest principal stretch squared of an incompressible deformation with tr B = trace (uniaxial in 3-D).
double stretch_squared(double trace, int dimension);

/// Upper bounds on dt; infinite where the term is absent.
struct TimeStepLimits {
  double viscous;    ///< 1/(2 nu S), S = sum 1/h^2
  double elastic;    ///< 1/(c sqrt(S))
  double combined;   ///< dt^2 c^2 S + 2 nu dt S = 1
  double advective;  ///< 1/(sum |u_i|/h_i)
  double inertial;   ///< 2 nu/U^2, where Euler's anti-diffusion eats the viscosity
  /// The automatic step of the explicit Euler scheme and the name of what sets it.
  double automatic(const char **name = nullptr) const;
  /// Name of the first stability limit that dt breaks, or null.
  const char *broken(double dt) const;
};

TimeStepLimits euler_limits(const Grid &grid, const Fluid &fluid, double shear_modulus, const FlowExtremes &extremes);
/// The same without a grid, for -check_only.
TimeStepLimits euler_limits(const Real3 &spacing, int dimension, const Fluid &fluid, double shear_modulus,
                            const FlowExtremes &extremes);

}  // namespace eulastic
