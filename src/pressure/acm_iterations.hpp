// Artificial compressibility, iterated until the divergence is small: minimal residual over a multigrid direction and
// earlier directions.
//
// With q = dt increment, <(D - lap q)^2> is minimised first over the increments of the last time steps (Fischer, CMAME
// 163, 1998), then in each iteration over V(D), a V-cycle, and the previous direction (conjugate residuals). Without
// multigrid D itself takes the place of V(D), as in (11). Iterations work on scalars only.
#pragma once

#include "base/petsc.hpp"
#include "field/work_space.hpp"
#include "grid/domain.hpp"
#include "pressure/increment_memory.hpp"
#include "pressure/iteration_passes.hpp"
#include "pressure/multigrid.hpp"
#include "pressure/pressure_solver.hpp"

namespace eulastic {

struct AcmIterativeOptions {
  int sweeps_max = 20;    ///< number of iterations, at least 1; the projection on earlier increments does not count
  int memory = 2;         ///< number of increments of earlier time steps, 0 ... 4
  bool multigrid = true;  ///< else the direction is the divergence itself
};

class AcmIterativeSolver final : public PressureSolver {
public:
  static constexpr int work_fields = 4;  ///< components of the work space during a solve
  /// Memory beside the work space, in fields of the grid.
  static double fields(const AcmIterativeOptions &options, int dimension) {
    return options.memory + (options.multigrid ? Multigrid::fields(dimension) + (options.memory == 0) : 0);
  }
  /// Creates the solver. `domain`, `exchange` and `work` must outlive it. Collective.
  PetscErrorCode create(const Domain &domain, GhostExchange &exchange, const AcmIterativeOptions &options,
                        WorkSpace &work);

  /// Solves for the increment, which has zero mean if no boundary is open. It is NaN if D is not finite somewhere.
  PetscErrorCode solve(double dt, const Field &divergence, Field &pressure, Field &increment) override;
  void set_target(double rms) override { target_ = rms; }
  long sweeps() const override { return sweeps_; }
  /// The increments of the last steps, newest first, or null. The caller may write their owned cells.
  Field *memory() override { return memory_.saved(); }
  void clear_memory() override { memory_.clear(); }
  /// rms of D after the last solve, as computed by the iterations.
  double residual_rms() const { return residual_rms_; }
  std::size_t bytes() const override;

private:
  struct SolveState;
  /// One iteration over directions_ and the previous direction; `last`: the number of iterations is exhausted.
  PetscErrorCode iterate(bool last, SolveState &state);

  const Domain *domain_ = nullptr;
  GhostExchange *exchange_ = nullptr;
  AcmIterativeOptions options_;
  std::unique_ptr<Multigrid> multigrid_;
  WorkSpace *work_ = nullptr;
  Field residual_, before_, direction_;  ///< parts of the work space, during a solve
  Field own_scratch_;                    ///< scratch for multigrid if there is no memory
  IncrementMemory memory_;
  std::vector<ConstView> directions_;  ///< of this iteration, without the previous direction
  IterationSums sums_;                 ///< of this iteration or, once it is finished, of the next
  double target_ = 0, residual_rms_ = 0;
  long sweeps_ = 0;
};

}  // namespace eulastic
