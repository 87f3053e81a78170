#include "run/run.hpp"

#include "base/events.hpp"
#include "base/one_line.hpp"
#include "base/progress.hpp"
#include "base/rank_zero.hpp"
#include "grid/domain.hpp"
#include "io/fail_together.hpp"
#include "io/run_directory.hpp"
#include "io/text_file.hpp"
#include "options/petsc_options.hpp"
#include "output/checkpoints.hpp"
#include "output/signals.hpp"
#include "output/time_step_control.hpp"
#include "output/verdict.hpp"
#include "run/waiting.hpp"
#include "scene/balance.hpp"
#include "scene/lumens.hpp"
#include "scene/memory.hpp"
#include "scene/red_cell.hpp"
#include "scene/scene.hpp"
#include "scene/scene_warnings.hpp"

#include <cctype>
#include <cstdio>
#include <map>

namespace eulastic {
namespace {

struct Run {
  const ParseResult &parsed;
  bool in_place;  ///< goes on where its checkpoint lies
  RunDirectory directory;
  Solver solver;
  Outputs outputs;
  Checkpoints checkpoints;
  Guards guards;
  RunPosition position;
  double begin;         ///< MPI_Wtime
  double total_before;  ///< wall seconds before a restart
  std::string exit_reason;
  Stop stop;              ///< by a guard
  std::string noted;      ///< newest checkpoint that summary.json knows of
  std::string waiting;    ///< how threads wait
  bool accepted = false;  ///< summary.json is that of this run
  bool summary_failed = false;
};

bool finished(const State &state, const TimeControl &time, std::string *reason) {
  if (time.end > 0 && state.time >= time.end * (1 - 1e-12))
    *reason = "time_end";
  else if (time.steps_max > 0 && state.step >= time.steps_max)
    *reason = "steps";
  return !reason->empty();
}

void print_warning(MPI_Comm comm, const std::string &warning) {
  if (!warning.empty()) (void)PetscFPrintf(comm, stderr, "eulastic: warning: %s\n", one_line(warning).c_str());
}

// Of the scene at the start.
PetscErrorCode print_warnings(const Config &config, const std::string &overlap, const Run &run) {
  PetscFunctionBeginUser;
  const MPI_Comm comm = run.solver.domain().comm();
  std::string unresolved, near_wall;
  print_warning(comm, overlap);
  PetscCall(find_membranes_near_walls(comm, config, &near_wall));
  print_warning(comm, near_wall);
  PetscCall(run.outputs.unresolved_bodies(&unresolved));
  print_warning(comm, unresolved);
  for (const std::string &warning : scene_warnings(config)) print_warning(comm, warning);
  PetscFunctionReturn(0);
}

// Checks a state that the guards have not checked yet.
PetscErrorCode check_state(Run *run) {
  PetscFunctionBeginUser;
  PetscCall(run->guards.check_finite(run->solver, &run->stop));
  if (run->stop) PetscFunctionReturn(0);
  PetscCall(run->outputs.measure());
  PetscCall(run->guards.check(run->solver, run->outputs.measured(), &run->stop));
  PetscFunctionReturn(0);
}

// What a row of series.csv has shown.
PetscErrorCode check_measured(Run *run) {
  PetscFunctionBeginUser;
  const Measured *row = run->outputs.new_row();
  if (row == nullptr) PetscFunctionReturn(0);
  print_warning(run->solver.domain().comm(), run->outputs.strain_warning());
  PetscCall(run->guards.check(run->solver, *row, &run->stop));
  PetscFunctionReturn(0);
}

// options.txt and the rows and files of outputs.
PetscErrorCode open_outputs(Run *run) {
  PetscFunctionBeginUser;
  ParseResult whole = run->parsed;
  if (run->in_place) whole.config.checkpoint.restart.clear();  // the run from t = 0 on
  PetscCall(write_text_file(run->solver.domain().comm(), run->directory.file("options.txt"), options_text(whole)));
  PetscCall(run->outputs.open(run->directory.path(), run->in_place));
  PetscFunctionReturn(0);
}

PetscErrorCode write_summary(const std::string &reason, Run *run) {
  PetscFunctionBeginUser;
  run->noted = run->checkpoints.newest();
  run->summary_failed = true;
  PetscCall(run->outputs.write_summary({reason, run->noted, run->position.wall_seconds,
                                        run->total_before + MPI_Wtime() - run->begin, run->parsed.inputs}));
  run->summary_failed = false;
  PetscFunctionReturn(0);
}

// A run may be killed at any moment: until it ends, summary.json describes its first step or its last checkpoint.
PetscErrorCode note(Run *run) {
  PetscFunctionBeginUser;
  if (run->accepted && run->checkpoints.newest() == run->noted) PetscFunctionReturn(0);
  PetscCall(write_summary("unfinished", run));
  run->accepted = true;
  PetscFunctionReturn(0);
}

// The run has passed its first step, so that it may replace earlier files in its directory. Whether a run continues
// must not depend on earlier files, so the guards check at the usual times only.
PetscErrorCode accept(Run *run) {
  PetscFunctionBeginUser;
  if (!run->directory.pending()) PetscFunctionReturn(0);
  PetscCall(run->guards.check_finite(run->solver, &run->stop));
  if (run->stop) PetscFunctionReturn(0);
  PetscCall(run->directory.accept(run->solver.domain().comm()));
  run->checkpoints.accept(run->directory.path());
  if (run->in_place)
    PetscCall(open_outputs(run));
  else
    run->outputs.moved_to(run->directory.path());
  PetscFunctionReturn(0);
}

// Returns what looks at a step of length dt for the row that waits, if there is one. Adds the time that it takes to
// `looked`.
Observer observer(Run *run, double dt, PetscErrorCode (Outputs::*see)(double), double *looked) {
  if (!run->outputs.row_waits()) return {};
  return [=] {
    const double begin = MPI_Wtime();
    PetscFunctionBeginUser;
    PetscCall((run->outputs.*see)(dt));
    *looked += MPI_Wtime() - begin;
    PetscFunctionReturn(0);
  };
}

PetscErrorCode time_loop(const Config &config, TimeStepControl *control, Progress *progress, Run *run) {
  PetscFunctionBeginUser;
  Solver &solver = run->solver;
  const State &state = solver.state();
  const double loop_begin = MPI_Wtime();
  while (!run->stop && run->exit_reason.empty() && !finished(state, config.time, &run->exit_reason)) {
    double step_begin = MPI_Wtime(), dt = 0;
    std::string warning;
    {
      StageScope stage(Stage::step);
      PetscCall(control->choose(&solver, run->guards, &dt, &run->stop, &warning));
    }
    if (run->stop) {
      print_warning(solver.domain().comm(), warning);
      break;
    }
    run->position.dt = control->dt();
    run->position.wall_seconds += MPI_Wtime() - step_begin;
    // A shortened step is no part of a longer run.
    if (control->ends()) PetscCall(run->checkpoints.before_end(run->position, &run->stop));
    if (run->stop) break;
    step_begin = MPI_Wtime();
    double looked = 0;
    run->outputs.prepare_step(dt);
    {
      StageScope stage(Stage::step);
      PetscCall(control->reset_unresolved(&solver, &warning));
      PetscCall(solver.step(dt, observer(run, dt, &Outputs::record_middle, &looked),
                            observer(run, dt, &Outputs::record_pressure, &looked)));
    }
    print_warning(solver.domain().comm(), warning);
    run->position.wall_seconds += MPI_Wtime() - step_begin - looked;
    run->position.wall_seconds_total = run->total_before + MPI_Wtime() - run->begin;
    PetscCall(accept(run));
    if (run->stop) break;
    PetscCall(run->outputs.write_due(false));
    PetscCall(check_measured(run));
    if (run->stop) break;
    if (!control->ends()) PetscCall(run->checkpoints.after_step(run->position, &run->exit_reason, &run->stop));
    if (run->exit_reason.empty() && !run->stop) PetscCall(note(run));
    progress->update(state.time, static_cast<long>(state.step), state.dt, MPI_Wtime() - loop_begin);
  }
  if (!run->stop) PetscCall(accept(run));  // there was no step to take
  if (run->exit_reason == "steps") PetscCall(run->checkpoints.before_end(run->position, &run->stop));
  const bool whole = run->exit_reason == "steps" || run->exit_reason == "time_end";
  if (!run->stop && whole) PetscCall(check_state(run));
  if (!run->stop && whole) PetscCall(run->outputs.write_due(true));
  if (!run->stop) PetscCall(check_measured(run));
  if (run->stop) run->exit_reason = run->stop.reason;
  if (!run->directory.pending()) PetscCall(run->outputs.write_waiting());
  progress->finish(state.time, static_cast<long>(state.step), state.dt, MPI_Wtime() - loop_begin);
  PetscFunctionReturn(0);
}

// -load_balance: if other cuts between ranks are better, the scene is built again with them.
PetscErrorCode balance(const std::string &restarted_from, Domain *domain, Run *run, std::string *line,
                       std::string *refusal) {
  PetscFunctionBeginUser;
  ParseResult parsed = run->parsed;
  Config &config = parsed.config;
  std::string too_large;
  PetscCall(balance_ranks(run->solver, &config.grid, line));
  if (config.grid.starts[0].empty()) PetscFunctionReturn(0);
  PetscCall(check_sizes(domain->comm(), config, &too_large));
  if (!too_large.empty()) {
    *line += "; the even split is kept: " + too_large;
    PetscFunctionReturn(0);
  }
  run->solver = {};
  run->position = {};
  PetscCall(domain->create(domain->comm(), config.grid));
  PetscCall(build_scene(config, *domain, &run->solver, refusal));
  if (!refusal->empty() || restarted_from.empty()) PetscFunctionReturn(0);
  std::string again;
  config.checkpoint.restart = restarted_from;
  PetscCall(restart(parsed, &run->solver, &run->position, &again, refusal));
  PetscFunctionReturn(0);
}

// One line with the version, the size and the output directory.
std::string first_word(const Config &config, int ranks) {
  const Int3 &n = config.grid.cells;
  std::string line = print("eulastic %s: %d x %d x %d cells on %d rank%s", EULASTIC_VERSION, n[0], n[1], n[2], ranks,
                           ranks > 1 ? "s" : "");
  if (config.threads > 1) line += " of " + std::to_string(config.threads) + " threads";
  return line + "; results go to " + config.output.directory;
}

// The directory and the state, new or as a checkpoint has them. `refusal`: one line if the run cannot start.
PetscErrorCode begin_run(Domain *made, Run *run, std::string *refusal) {
  PetscFunctionBeginUser;
  const ParseResult &parsed = run->parsed;
  const Config &config = parsed.config;
  const Domain &domain = *made;
  const std::string &path = config.output.directory, &source = config.checkpoint.restart;
  using Earlier = RunDirectory::Earlier;
  std::string restarted_from, balanced, overlap;
  double thrown_away = 0;
  PetscCall(build_scene(config, domain, &run->solver, refusal));
  if (refusal->empty() && source.empty()) PetscCall(find_overlap(domain.comm(), config, &overlap, refusal));
  if (refusal->empty()) PetscCall(find_unread_option(parsed.petsc, refusal));
  if (refusal->empty() && run->in_place)
    PetscCall(run->directory.open(domain.comm(), path, Earlier::continued, refusal));
  if (refusal->empty() && !source.empty())
    PetscCall(restart(parsed, &run->solver, &run->position, &restarted_from, refusal));
  if (refusal->empty() && run->in_place) {
    const double now = run->solver.state().time;
    PetscCall(time_thrown_away(domain.comm(), path, now, &thrown_away));
    if (thrown_away > 0 && !config.output.overwrite) *refusal = shorter_end(config, now + thrown_away);
  }
  if (refusal->empty() && config.balance) PetscCall(balance(restarted_from, made, run, &balanced, refusal));
  if (refusal->empty() && !run->in_place)
    PetscCall(run->directory.open(domain.comm(), path, config.output.overwrite ? Earlier::replaced : Earlier::refused,
                                  refusal));
  if (!refusal->empty()) PetscFunctionReturn(0);
  for (const std::string &warning : parsed.warnings) print_warning(domain.comm(), warning);
  PetscCall(PetscPrintf(domain.comm(), "%s\n", first_word(config, domain.ranks()).c_str()));
  for (const auto &lines : {red_cell_lines(config), side_lines(config)})
    for (const std::string &line : lines) PetscCall(PetscPrintf(domain.comm(), "%s\n", line.c_str()));
  for (const std::string &line : {balanced, run->waiting})
    if (!line.empty()) PetscCall(PetscPrintf(domain.comm(), "%s\n", line.c_str()));
  (void)std::fflush(stdout);
  run->checkpoints.start(parsed, run->directory.path(), &run->solver, &run->outputs, &run->guards, run->in_place);
  run->outputs.start(config, domain, &run->solver, run->position.outputs);
  if (!run->in_place) PetscCall(open_outputs(run));
  PetscCall(source.empty() ? run->outputs.write_due(false) : run->outputs.resume_row());
  (void)run->outputs.new_row();
  PetscCall(run->outputs.measure());
  PetscCall(run->guards.check(run->solver, run->outputs.measured(), &run->stop));
  if (source.empty()) PetscCall(print_warnings(config, overlap, *run));
  if (source.empty()) PetscFunctionReturn(0);
  PetscCall(PetscPrintf(domain.comm(), "restart from %s: t = %.9g, step %lld\n", restarted_from.c_str(),
                        run->solver.state().time, static_cast<long long>(run->solver.state().step)));
  if (thrown_away > 0)
    PetscCall(PetscPrintf(domain.comm(),
                          "output after this time, %.3g of simulated time, is discarded and computed again\n",
                          thrown_away));
  PetscFunctionReturn(0);
}

// As one word of a shell.
std::string quoted(const std::string &word) {
  bool plain = !word.empty();
  for (unsigned char c : word)
    plain = plain && (std::isalnum(c) || std::string("_-./+:,=@%").find(c) != std::string::npos);
  if (plain) return word;
  std::string text = "'";
  for (char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

// The command that continues the run, for a shell in the directory in which it was started.
std::string command_to_continue(const Run &run) {
  const std::string &directory = run.parsed.config.output.directory;
  const int ranks = run.solver.domain().ranks();
  return (ranks > 1 ? "mpiexec -n " + std::to_string(ranks) + " " : "") + quoted(run.parsed.program) + " " +
         quoted(directory + "/options.txt") + " -restart " + quoted(directory) + " -output_dir " + quoted(directory) +
         (run.exit_reason == "time_end" ? " -time_end LATER"
          : run.exit_reason == "steps"  ? " -time_steps_max MORE"
                                        : "");
}

// One line: the reason of the end, time and step, the output directory, and how to continue.
std::string last_word(const Run &run) {
  static const std::map<std::string, std::string> words{
      {"time_end", "reached -time_end"},    {"steps", "reached -time_steps_max"},
      {"signal", "stopped by a signal"},    {"wall_limit", "stopped by -stop_after_minutes"},
      {"guard", "stopped by a guard"},      {"nonfinite", "stopped because numbers are not finite"},
      {"output_failed", "could not write"},
  };
  const State &state = run.solver.state();
  const std::string &reason = run.exit_reason, checkpoint = run.checkpoints.newest();
  const std::string line = "eulastic: " + words.at(reason) +
                           print(" at t = %.9g, step %lld; results: ", state.time, static_cast<long long>(state.step)) +
                           run.parsed.config.output.directory;
  if (checkpoint.empty()) return line + "; there is no checkpoint to continue from";
  if (reason == "time_end" || reason == "steps") return line + "; to continue: " + command_to_continue(run);
  const bool wrong = reason == "guard" || reason == "nonfinite";
  return line + "; to continue from " + checkpoint + (wrong ? ", with the remedy of the error: " : ": ") +
         command_to_continue(run);
}

// The last lines of a run that was accepted.
PetscErrorCode say_last_word(const Run &run) {
  PetscFunctionBeginUser;
  const MPI_Comm comm = run.solver.domain().comm();
  for (const Verdict &verdict : run.outputs.verdicts())
    PetscCall(PetscPrintf(comm, "eulastic: %s\n", verdict_line(verdict).c_str()));
  PetscCall(PetscPrintf(comm, "%s\n", last_word(run).c_str()));
  PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode run(const ParseResult &parsed, int *code, std::string *refusal) {
  PetscFunctionBeginUser;
  const Config &config = parsed.config;
  const double begin = MPI_Wtime();
  *code = exit_usage;
  catch_signals();
  PetscCall(check_sizes(run_communicator(), config, refusal));
  if (!refusal->empty()) PetscFunctionReturn(0);
  std::string waiting, warning;
  PetscCall(start_threads(config.threads, &waiting, &warning, refusal));
  if (!refusal->empty()) PetscFunctionReturn(0);
  print_warning(run_communicator(), warning);
  Domain domain;
  PetscCall(domain.create(run_communicator(), config.grid));
  const bool in_place = !config.checkpoint.restart.empty() && restarts_in_place(config);
  Run run{parsed, in_place, {}, {}, {}, {}, Guards(config), {}, begin, 0, {}, {}, {}, waiting};
  PetscCall(begin_run(&domain, &run, refusal));
  if (!refusal->empty()) PetscFunctionReturn(0);
  const State &state = run.solver.state();
  run.total_before = run.position.wall_seconds_total;
  TimeStepControl control(config.time);
  if (!config.checkpoint.restart.empty()) control.resume(run.position.dt);
  Progress progress(stdout, Progress::style_of(stdout, domain.rank()),
                    {state.time, config.time.end, static_cast<long>(state.step),
                     config.time.steps_max > 0 ? config.time.steps_max : -1, domain.domain_cell_count()});
  PetscCall(catch_together([&] { return time_loop(config, &control, &progress, &run); }, refusal));
  if (!refusal->empty()) {
    // A full disk may have room for the few bytes that say so.
    std::string ignored;
    run.exit_reason = "output_failed";
    *code = exit_failed;
    if (run.directory.pending()) PetscFunctionReturn(0);
    if (!run.summary_failed) PetscCall(catch_together([&] { return write_summary(run.exit_reason, &run); }, &ignored));
    PetscCall(say_last_word(run));
    PetscFunctionReturn(0);
  }
  *code = exit_failed;
  *refusal = run.stop.message;
  if (run.directory.pending()) {
    *refusal += "; the earlier run in -output_dir " + config.output.directory + " is untouched";
  } else {
    PetscCall(write_summary(run.exit_reason, &run));
    PetscCall(say_last_word(run));
  }
  *code = run.stop ? exit_wrong_numbers : exit_fine;
  PetscFunctionReturn(0);
}

}  // namespace eulastic
