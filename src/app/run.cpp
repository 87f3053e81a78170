#include "app/run.hpp"

#include "app/outputs.hpp"
#include "app/scene.hpp"
#include "app/time_step_control.hpp"
#include "base/events.hpp"
#include "base/progress.hpp"
#include "io/run_directory.hpp"
#include "io/text_file.hpp"

#include <cmath>

namespace eulastic {
namespace {

struct Loop {
  double wall = 0;  // seconds in the loop, output excluded
  std::string exit_reason, message;
};

bool finished(const State &state, const TimeControl &time, std::string *reason) {
  if (time.end > 0 && state.time >= time.end * (1 - 1e-12))
    *reason = "time_end";
  else if (time.steps_max > 0 && state.step >= time.steps_max)
    *reason = "steps";
  return !reason->empty();
}

void print_warning(MPI_Comm comm, const std::string &warning) {
  if (!warning.empty()) (void)PetscFPrintf(comm, stderr, "eulastic: warning: %s\n", warning.c_str());
}

PetscErrorCode time_loop(const Config &config, Solver *solver, Outputs *outputs, Progress *progress, Loop *loop) {
  PetscFunctionBeginUser;
  const State &state = solver->state();
  TimeStepControl control(config.time);
  const double begin = MPI_Wtime();
  while (!finished(state, config.time, &loop->exit_reason)) {
    const double step_begin = MPI_Wtime();
    {
      StageScope stage(Stage::step);
      double dt = 0;
      std::string warning;
      PetscCall(control.choose(solver, &dt, &loop->message, &warning));
      if (!loop->message.empty()) {
        loop->exit_reason = "nonfinite";
        break;
      }
      print_warning(solver->grid().comm(), warning);
      PetscCall(solver->step(dt));
    }
    loop->wall += MPI_Wtime() - step_begin;
    std::string ignored;
    PetscCall(outputs->write_due(finished(state, config.time, &ignored)));
    progress->update(state.time, static_cast<long>(state.step), state.dt, MPI_Wtime() - begin);
  }
  progress->finish(state.time, static_cast<long>(state.step), state.dt, MPI_Wtime() - begin);
  PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode run(const ParseResult &parsed, int *code, std::string *refusal) {
  PetscFunctionBeginUser;
  const Config &config = parsed.config;
  const double begin = MPI_Wtime();
  const MPI_Comm comm = PETSC_COMM_WORLD;
  *code = exit_usage;
  Grid grid;
  PetscCall(grid.create(comm, config.grid));
  Solver solver;
  PetscCall(build_scene(config, grid, &solver, refusal));
  if (!refusal->empty()) PetscFunctionReturn(0);
  RunDirectory directory;
  PetscCall(directory.open(comm, config.output.directory, config.output.overwrite, refusal));
  if (!refusal->empty()) PetscFunctionReturn(0);
  *code = exit_failed;
  PetscCall(write_text_file(comm, directory.file("options.txt"), options_text(parsed)));
  Outputs outputs;
  PetscCall(outputs.open(config, grid, &solver, directory.path()));
  PetscCall(outputs.write_due(false));

  Progress progress(stdout, Progress::style_of(stdout, grid.rank()),
                    {solver.state().time, config.time.end, static_cast<long>(solver.state().step),
                     config.time.steps_max > 0 ? config.time.steps_max : -1, grid.cell_count()});
  Loop loop;
  PetscCall(time_loop(config, &solver, &outputs, &progress, &loop));

  Summary summary;
  summary.exit_reason = loop.exit_reason;
  summary.wall_seconds = loop.wall;
  summary.wall_seconds_total = MPI_Wtime() - begin;
  PetscCall(outputs.write_summary(summary));
  *refusal = loop.message;
  *code = loop.exit_reason == "nonfinite" ? exit_nonfinite : exit_fine;
  PetscFunctionReturn(0);
}

}  // namespace eulastic
