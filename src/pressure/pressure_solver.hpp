// One interface for all ways to make the velocity solenoidal: (10) exactly, or (11) by artificial compressibility.
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

  /// Finds the pressure increment for lap(increment) = divergence / dt with zero normal derivative on closed sides and
  /// 0 on open ones. `divergence`: D* = rho div v* at centres, one ghost layer valid. `pressure`: p^N, one ghost layer
  /// valid; a solver may remove its mean where no side is open. `increment`: out, one ghost layer valid; unused where
  /// formula() is not null.
  virtual PetscErrorCode solve(double dt, const Field &divergence, Field &pressure, Field &increment) = 0;

  /// The last increment as a function of D* and p^N, which is stored nowhere, or null.
  virtual const kernels::AcmIncrement *formula() const { return nullptr; }
  /// rms of D that is good enough; exact solvers and the paper's single step take no notice.
  virtual void set_target(double) {}
  /// Sweeps or iterations since the start; 0 for exact solvers.
  virtual long sweeps() const { return 0; }
  /// beta of the last solve() by artificial compressibility; 0 where there is no such speed.
  virtual double sound_speed() const { return 0; }
  /// Fields that must survive a restart for the same bits, or null.
  virtual Field *memory() { return nullptr; }
  /// These become 0; until the next solve() owned cells may be written then.
  virtual void clear_memory() {}
  /// Bytes of the solver's own fields on this rank.
  virtual std::size_t bytes() const { return 0; }
};

}  // namespace eulastic
