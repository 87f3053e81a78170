// ACM swept until the divergence is small: minimal residual over a multigrid direction and what it remembers.
//
// With q = dt increment, <(D - lap q)^2> is minimised first over the last increments of the previous time steps
// (Fischer, CMAME 163, 1998), then in every sweep over V(D), a V-cycle, and the previous direction (conjugate
// residuals). Without multigrid D itself takes the place of V(D), as in (11). Scalars only.
#pragma once

#include "base/petsc.hpp"
#include "field/work_space.hpp"
#include "grid/domain.hpp"
#include "pressure/increment_memory.hpp"
#include "pressure/multigrid.hpp"
#include "pressure/pressure_solver.hpp"
#include "pressure/sweep_passes.hpp"

namespace eulastic {

struct AcmSweepOptions {
  int sweeps_max = 20;    ///< at least 1; the projection on what is remembered comes before and is none
  int memory = 2;         ///< increments of previous time steps, 0 ... 4
  bool multigrid = true;  ///< else the direction is the divergence itself
};

class AcmSweepSolver final : public PressureSolver {
public:
  static constexpr int work_fields = 4;  ///< of the work space, during a solve
  /// Collective; `grid`, `exchange` and `work` must outlive the solver.
  PetscErrorCode create(const Domain &domain, GhostExchange &exchange, const AcmSweepOptions &options, WorkSpace &work);

  /// The increment has zero mean where no side is open. It is NaN where D is not finite anywhere.
  PetscErrorCode solve(double dt, const Field &divergence, Field &pressure, Field &increment) override;
  void set_target(double rms) override { target_ = rms; }
  long sweeps() const override { return sweeps_; }
  /// The last increments, the newest first, or null. Whoever asks may write its owned cells.
  Field *memory() override { return memory_.saved(); }
  void clear_memory() override { memory_.clear(); }
  /// rms of D that the last solve left, by its own account.
  double residual_rms() const { return residual_rms_; }
  std::size_t bytes() const override;

private:
  struct SolveState;
  /// One sweep over directions_.
  PetscErrorCode sweep(bool last, SolveState &state);

  const Domain *domain_ = nullptr;
  GhostExchange *exchange_ = nullptr;
  AcmSweepOptions options_;
  std::unique_ptr<Multigrid> multigrid_;
  WorkSpace *work_ = nullptr;
  Field residual_, before_, direction_;  ///< of the work space, during a solve
  Field own_scratch_;                    ///< without memory
  IncrementMemory memory_;
  std::vector<ConstView> directions_;  ///< of this sweep, but for d
  RowSums sums_;                       ///< of this sweep or, once it is done, of the next
  double target_ = 0, residual_rms_ = 0;
  long sweeps_ = 0;
};

}  // namespace eulastic
