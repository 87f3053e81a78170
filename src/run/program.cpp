#include "run/program.hpp"

#include "base/events.hpp"
#include "base/message_keeper.hpp"
#include "base/one_line.hpp"
#include "base/rank_zero.hpp"
#include "grid/domain.hpp"
#include "run/run.hpp"
#include "scene/check_only.hpp"
#include "scene/rank_work.hpp"
#include "scene/scene_warnings.hpp"

#include <cstdio>

namespace eulastic {
namespace {

void print_error(const std::string &message) {
  int rank = 0;
  MPI_Comm_rank(run_communicator(), &rank);
  if (rank == 0) std::fprintf(stderr, "eulastic: error: %s\n", one_line(message).c_str());
}

// Prints the answer of -help, -check_only or -print_options, or fills `refusal`.
PetscErrorCode print_answer(const ParseResult &parsed, int ranks, std::string *refusal) {
  PetscFunctionBeginUser;
  std::string text = parsed.message, work, overlap, near_wall;
  if (text.empty() && parsed.config.print_options) text = options_text(parsed);
  if (text.empty()) {
    PetscCall(describe_work(run_communicator(), parsed.config, ranks, &work));
    text = check_report(parsed.config, ranks) + work;
    PetscCall(find_overlap(run_communicator(), parsed.config, &overlap, refusal));
    if (!refusal->empty()) PetscFunctionReturn(0);
    PetscCall(find_membranes_near_walls(run_communicator(), parsed.config, &near_wall));
    for (const std::string &warning : {overlap, near_wall})
      if (!warning.empty()) text += "warning: " + warning + "\n";
    for (const std::string &warning : parsed.warnings) text += "warning: " + one_line(warning) + "\n";
    for (const std::string &warning : scene_warnings(parsed.config)) text += "warning: " + warning + "\n";
  }
  PetscCall(PetscPrintf(run_communicator(), "%s", text.c_str()));
  PetscFunctionReturn(0);
}

}  // namespace

int act(ParseResult &parsed) {
  int ranks = 1, code = exit_usage;
  std::string refusal;
  MPI_Comm_size(run_communicator(), &ranks);
  if (parsed.config.check_only && parsed.config.ranks > 0) ranks = parsed.config.ranks;
  if (parsed.error.empty() && parsed.config.check_only && parsed.config.balance && ranks > 1)
    parsed.error =
        "-load_balance: -check_only on more than one rank assumes equal parts, whereas the cuts of a run follow from "
        "its fields; accepted: -load_balance false with -check_only";
  if (parsed.error.empty())
    parsed.error = parsed.message.empty() ? Domain::refusal_reason(parsed.config.grid, ranks) : "";
  if (!parsed.error.empty()) {
    print_error(parsed.error);
    return exit_usage;
  }
  if (!parsed.message.empty() || parsed.config.check_only || parsed.config.print_options) {
    if (print_answer(parsed, ranks, &refusal)) return exit_failed;
    if (!refusal.empty()) print_error(refusal);
    return parsed.alone || !refusal.empty() ? exit_usage : exit_fine;
  }
  const MessageKeeper kept;
  (void)register_events();
  const PetscErrorCode failed = run(parsed, &code, &refusal);
  // All ranks know of errors of files (io/fail_together.hpp), linear systems and options.
  if (failed == PETSC_ERR_FILE_UNEXPECTED || failed == PETSC_ERR_NOT_CONVERGED || failed == PETSC_ERR_USER_INPUT) {
    print_error(kept.text());
    return failed == PETSC_ERR_USER_INPUT ? exit_usage : exit_failed;
  }
  if (failed) {
    // A rank that fails alone must not leave the others waiting in a collective call.
    std::fprintf(stderr, "eulastic: error: %s\n",
                 kept.text().empty() ? "internal error" : one_line(kept.text()).c_str());
    std::fflush(stderr);
    MPI_Abort(PETSC_COMM_WORLD, exit_failed);
  }
  if (!refusal.empty()) print_error(refusal);
  return code;
}

}  // namespace eulastic
