// Bounds that stop a run with wrong numbers: -guard_*, and fields that are not finite.
//
// They check numbers that are measured anyway: the limits of the time step and the measures of the flow. The position
// of a violation is searched only if the run stops.
#pragma once

#include "base/petsc.hpp"
#include "field/field.hpp"
#include "grid/domain.hpp"
#include "output/measured.hpp"
#include "scene/config.hpp"
#include "solver/solver.hpp"

namespace eulastic {

/// Why a run has to stop; empty = it continues.
struct Stop {
  std::string reason;   ///< exit_reason of summary.json: nonfinite or guard
  std::string message;  ///< one line: step, time, position, violated limit, remedy
  explicit operator bool() const { return !reason.empty(); }
};

class Guards {
public:
  explicit Guards(const Config &config);

  /// Collective. Before a step of `dt`, from freshly measured extremes.
  PetscErrorCode before_step(const Solver &solver, const FlowExtremes &extremes, double dt, Stop *stop) const;
  /// Collective. Velocity and B of any state, and whether bodies near each other are separate.
  PetscErrorCode check_finite(const Solver &solver, Stop *stop) const;
  /// Collective. A measured state; that of the start passes.
  PetscErrorCode check(const Solver &solver, const Measured &measured, Stop *stop) const;

private:
  GuardControl control_;
  std::string pressure_advice_;
};

/// Centre of the cell with the largest sum |v_d|/h_d on its low faces; the first one if there are several. Collective.
PetscErrorCode place_of_speed(const Domain &domain, const Field &velocity, Real3 *place);
/// Centre of the cell with the largest |div v|; the first one if there are several. Reads one ghost layer. Collective.
PetscErrorCode place_of_divergence(const Domain &domain, const Field &velocity, Real3 *place);

}  // namespace eulastic
