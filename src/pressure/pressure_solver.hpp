// Interface of the solvers that make the velocity solenoidal: by (10) to a tolerance, or by one step of (11).
#pragma once

#include "base/petsc.hpp"
#include "field/field.hpp"

namespace eulastic {

namespace kernels {
struct AcmIncrement;
}

class PressureSolver {
public:
  virtual ~PressureSolver() = default;

  /// Computes the pressure increment from lap(increment) = divergence / dt with zero normal derivative on closed
  /// boundaries and 0 on open ones. `divergence`: D* = rho div v* at centres, one valid ghost layer. `pressure`: p^N,
  /// one valid ghost layer; a solver may remove its mean if no boundary is open. `increment`: result, one valid ghost
  /// layer; unused if formula() is not null. Collective.
  virtual PetscErrorCode solve(double dt, const Field &divergence, Field &pressure, Field &increment) = 0;

  /// The last increment as a function of D* and p^N if it is not stored in a field, else null.
  virtual const kernels::AcmIncrement *formula() const { return nullptr; }
  /// Sets the rms of D that suffices. Exact solvers and the single step of the paper ignore it.
  virtual void set_target(double) {}
  /// Number of iterations since the start; 0 for exact solvers.
  virtual long sweeps() const { return 0; }
  /// Sound speed beta of the last solve() by artificial compressibility; else 0.
  virtual double sound_speed() const { return 0; }
  /// Sets it to 0 until the next solve(): the last one was none of a time step.
  virtual void forget_sound_speed() {}
  /// Fields that must be in a checkpoint for the same bits after a restart, or null.
  virtual Field *memory() { return nullptr; }
  /// Sets these fields to 0; until the next solve() their owned cells may be written.
  virtual void clear_memory() {}
  /// Bytes of the solver's own fields on this rank.
  virtual std::size_t bytes() const { return 0; }
};

}  // namespace eulastic
