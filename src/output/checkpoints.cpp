#include "output/checkpoints.hpp"

#include "base/events.hpp"
#include "output/signals.hpp"

#include <algorithm>
#include <filesystem>

namespace eulastic {
namespace {

namespace fs = std::filesystem;

enum Wish : int { wish_checkpoint = 1, wish_wall_limit = 2, wish_signal = 4 };

}  // namespace

void Checkpoints::start(const ParseResult &parsed, const std::string &directory, Solver *solver, Outputs *outputs,
                        Guards *guards, bool goes_on) {
  control_ = parsed.config.checkpoint;
  directory_ = directory;
  options_ = options_text(parsed);
  solver_ = solver;
  outputs_ = outputs;
  guards_ = guards;
  due_ = {control_.interval, solver->state().time};
  begin_ = last_wall_ = MPI_Wtime();
  goes_on_ = goes_on;
  if (goes_on) last_step_ = solver->state().step;
}

void Checkpoints::accept(const std::string &directory) {
  directory_ = directory;
  if (!goes_on_ || solver_->domain().rank() > 0) return;
  std::error_code error;
  for (const std::string &path : list_checkpoints(directory_))  // newest first: what is left always fits the series
    if (checkpoint_step(path) > last_step_) fs::remove(path, error);
}

int Checkpoints::wishes() const {
  const double now = MPI_Wtime();
  int wishes = signal_caught() ? wish_signal : 0;
  if (solver_->domain().rank() > 0) return wishes;
  if (control_.keep > 0 && control_.wall_minutes > 0 && now - last_wall_ >= 60 * control_.wall_minutes)
    wishes |= wish_checkpoint;
  if (control_.stop_after_minutes > 0 && now - begin_ >= 60 * control_.stop_after_minutes) wishes |= wish_wall_limit;
  return wishes;
}

PetscErrorCode Checkpoints::after_step(const RunPosition &position, std::string *exit_reason, Stop *stop) {
  PetscFunctionBeginUser;
  int wish = wishes();
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &wish, 1, MPI_INT, MPI_BOR, solver_->domain().comm()));
  if (wish & wish_wall_limit) *exit_reason = "wall_limit";
  if (wish & wish_signal) *exit_reason = "signal";
  if (wish == 0 && !due_.at(solver_->state().time)) PetscFunctionReturn(0);
  PetscCall(write(position, stop));
  PetscFunctionReturn(0);
}

PetscErrorCode Checkpoints::before_end(const RunPosition &position, Stop *stop) {
  PetscFunctionBeginUser;
  if (control_.keep > 0) PetscCall(write(position, stop));
  PetscFunctionReturn(0);
}

PetscErrorCode Checkpoints::write(RunPosition position, Stop *stop) {
  PetscFunctionBeginUser;
  const State &state = solver_->state();
  if (state.step == last_step_) PetscFunctionReturn(0);
  StageScope stage(Stage::output);
  // The last good one must not give way to one that is good for nothing.
  PetscCall(guards_->check_finite(*solver_, stop));
  if (*stop) PetscFunctionReturn(0);
  PetscCall(outputs_->measure());
  PetscCall(guards_->check(*solver_, outputs_->measured(), stop));
  if (*stop) PetscFunctionReturn(0);
  PetscCall(outputs_->sync(&position.outputs));
  PetscCallMPI(MPI_Bcast(&position.wall_seconds, 1, MPI_DOUBLE, 0, solver_->domain().comm()));
  PetscCallMPI(MPI_Bcast(&position.wall_seconds_total, 1, MPI_DOUBLE, 0, solver_->domain().comm()));
  PetscCall(save_state(solver_, position, options_, directory_ + "/" + checkpoint_name(static_cast<long>(state.step))));
  last_step_ = state.step;
  due_.last_time = state.time;
  last_wall_ = MPI_Wtime();
  PetscCall(remove_old());
  PetscFunctionReturn(0);
}

std::string Checkpoints::newest() const { return last_step_ < 0 ? "" : checkpoint_name(static_cast<long>(last_step_)); }

PetscErrorCode Checkpoints::remove_old() {
  PetscFunctionBeginUser;
  if (solver_->domain().rank() > 0) PetscFunctionReturn(0);
  const std::vector<std::string> paths = list_checkpoints(directory_);
  std::error_code error;  // one that stays does no harm
  for (std::size_t n = std::max(control_.keep, 1L); n < paths.size(); ++n) fs::remove(paths[n], error);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
