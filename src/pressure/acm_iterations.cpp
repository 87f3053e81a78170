#include "pressure/acm_iterations.hpp"

#include "base/events.hpp"
#include "field/open_boundaries.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {

PetscErrorCode AcmIterativeSolver::create(const Domain &domain, GhostExchange &exchange,
                                          const AcmIterativeOptions &options, WorkSpace &work) {
  PetscFunctionBeginUser;
  PetscCheck(options.sweeps_max >= 1 && options.memory >= 0 && options.memory <= LeastSquaresSums::most, domain.comm(),
             PETSC_ERR_ARG_OUTOFRANGE, "sweeps %d, memory %d", options.sweeps_max, options.memory);
  domain_ = &domain;
  exchange_ = &exchange;
  options_ = options;
  if (options.multigrid) {
    multigrid_ = std::make_unique<Multigrid>();
    PetscCall(multigrid_->create(domain));
  }
  work_ = &work;
  PetscCall(work.reserve(work_fields));
  memory_ = IncrementMemory(domain, options.memory);
  if (options.memory == 0 && options.multigrid) own_scratch_ = Field(domain, 1);
  PetscFunctionReturn(0);
}

std::size_t AcmIterativeSolver::bytes() const {
  return memory_.bytes() + own_scratch_.bytes() + (multigrid_ ? multigrid_->bytes() : 0);
}

/// State of a solve.
struct AcmIterativeSolver::SolveState {
  double dt;
  Field &increment;
  ConstView residual, before{};  // D and its value before the last iteration
  bool with_previous = false;    // whether a previous direction exists
  // `first`: the increment has not been set; `pending`: the last direction has not been added to it.
  bool first = true, pending = false;
  bool done = false;
};

PetscErrorCode AcmIterativeSolver::solve(double dt, const Field &divergence, Field &, Field &increment) {
  PetscFunctionBeginUser;
  EventScope scope(Event::acm);
  WorkSpace::Lease lease;
  PetscCall(work_->lease("pressure sweeps", work_fields, &lease));
  residual_ = lease.part(0, 1);
  before_ = lease.part(1, 1);
  direction_ = lease.part(2, 1);
  SolveState state{dt, increment, memory_ ? divergence[0] : residual_[0]};
  if (memory_) {
    PetscCall(memory_.update_ghosts(*domain_, *exchange_));
    directions_.clear();
    for (int n = 0; n < memory_.count(); ++n) directions_.push_back(memory_.increment(n)[0]);
    memory_.advance();
    sums_.start(*domain_, memory_.count());
    PetscCall(iterate(false, state));
  } else {
    for (const Segment &s : domain_->rows())
      std::copy_n(divergence[0].row(s.j, s.k), s.size(), residual_[0].row(s.j, s.k));
    PetscCall(exchange_->update_ghosts(residual_, Multigrid::halo));
    fill_ghosts_of_increment(*domain_, residual_[0], 1);
    if (!multigrid_) sums_.start(*domain_, 1);
  }
  Field correction = lease.part(3, 1), scratch;  // multigrid may swap the two
  if (multigrid_) scratch = memory_ ? memory_.increment(0) : own_scratch_.part(0, 1);
  for (int s = 1; s <= options_.sweeps_max && !state.done; ++s) {
    if (multigrid_) {
      const IterationTask next{domain_, nullptr, 1, state.with_previous, state.residual, state.before};
      sums_.start(*domain_, next.directions());
      for (Field *field : {&residual_, &correction, &scratch})
        clear_open_ghosts(*domain_, (*field)[0], Multigrid::halo);
      PetscCall(multigrid_->apply(residual_, correction, scratch,
                                  [&](ConstView q, int thread, int j_begin, int j_end, int k) {
                                    IterationTask rows = next;
                                    rows.q = &q;
                                    sums_.add_inner(rows, thread, j_begin, j_end, k);
                                  }));
      fill_ghosts_of_increment(*domain_, correction[0], 1);
      scope.flops(multigrid_->flops());
    }
    directions_.assign(1, multigrid_ ? correction[0] : residual_[0]);
    PetscCall(iterate(s == options_.sweeps_max, state));
    ++sweeps_;
  }
  if (memory_) memory_.increment(0).copy_from(increment);
  PetscFunctionReturn(0);
}

PetscErrorCode AcmIterativeSolver::iterate(bool last, SolveState &state) {
  PetscFunctionBeginUser;
  const IterationTask task{
      domain_,        directions_.data(), static_cast<int>(directions_.size()), state.with_previous,
      state.residual, state.before};
  LeastSquaresSolution minimum;
  double mean = 0;
  PetscCall(sums_.find_minimum(task, &minimum, &mean));
  residual_rms_ = std::sqrt(minimum.square / domain_->domain_cell_count());
  state.done = last || !(residual_rms_ > target_);  // NaN ends the solve, too
  const int n = task.directions();
  const double laplacians = task.stencils * (4 * domain_->dimension() + 1) + task.with_previous;
  const double products = 2 + n + 0.5 * n * (n + 1);
  PetscCall(PetscLogFlops(domain_->cell_count() * (laplacians + 2 * products + 2 * n + 2)));
  const bool pending = state.pending;
  const Increment how = !pending && !state.done ? Increment::later
                        : state.first           ? (pending ? Increment::set_two : Increment::set)
                                                : (pending ? Increment::add_two : Increment::add);
  state.pending = how == Increment::later;
  if (!state.pending) state.first = false;
  UpdateTask step{task,
                  minimum.coefficient,
                  minimum.coefficient[0] * mean,
                  1 / state.dt,
                  how,
                  state.done,
                  before_[0],
                  direction_[0],
                  state.increment[0],
                  {}};
  const ConstView D = step.new_residual;
  const IterationTask next{domain_, &D, 1, true, D, task.residual};
  if (!multigrid_ && !state.done) {
    sums_.start(*domain_, next.directions());
    if (domain_->wraps_x())
      step.after = [&](int thread, int j_begin, int j_end, int k) { sums_.add_inner(next, thread, j_begin, j_end, k); };
  }
  update_fields(step);
  if (state.done) PetscFunctionReturn(0);
  PetscCall(PetscLogFlops(domain_->cell_count() * (laplacians + 2 * n)));
  residual_.swap(before_);
  state.before = task.residual;
  state.residual = D;
  state.with_previous = true;
  PetscCall(exchange_->update_ghosts(residual_, Multigrid::halo));
  fill_ghosts_of_increment(*domain_, residual_[0], 1);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
