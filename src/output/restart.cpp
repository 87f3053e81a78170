#include "output/restart.hpp"

#include "base/one_line.hpp"
#include "base/rank_zero.hpp"
#include "io/fail_together.hpp"
#include "io/option_values.hpp"
#include "options/option_table.hpp"
#include "options/renamed_options.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

namespace eulastic {
namespace {

namespace fs = std::filesystem;

// Words that options accept for 0 (Rows::zero_is).
bool is_zero(const std::string &text) { return text == "0" || text == "auto" || text == "off" || text == "unlimited"; }

struct Value {
  std::string text, content;  ///< the value, and of a file what it contains if that is known
  bool differs(const Value &other) const {
    const bool known = !content.empty() && !other.content.empty();
    return known ? content != other.content : text != other.text && !(is_zero(text) && is_zero(other.text));
  }
};

std::map<std::string, Value> values_of(const std::string &options) {
  std::map<std::string, Value> values;
  std::istringstream lines(options);
  std::string name;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t space = line.find(' ');
    if (line.rfind(content_mark, 0) == 0 && !name.empty()) values[name].content = line.substr(content_mark.size());
    if (line[0] != '-' || space == std::string::npos) continue;
    name = line.substr(1, space - 1);
    if (const std::string now = present_name(name); !now.empty()) name = now;
    values[name].text = line.substr(space + 1);
  }
  return values;
}

std::string shown(const Value &value) {
  if (value.text.empty()) return "not given";
  return value.text + (value.content.empty() ? "" : " with the content " + value.content);
}

// Rank 0's answer counts: others may see the directory a moment later.
std::vector<std::string> list_everywhere(const std::string &directory) {
  std::istringstream lines(on_rank_0([&] { return join(list_checkpoints(directory), "\n"); }));
  std::vector<std::string> paths;
  for (std::string line; std::getline(lines, line);) paths.push_back(line);
  return paths;
}

// `refusal`: the file is whole but this run must not go on from it.
PetscErrorCode load(const ParseResult &parsed, const std::string &path, Solver *solver, RunPosition *position,
                    std::string *refusal) {
  CheckpointFile file;
  std::string options;
  PetscFunctionBeginUser;
  PetscCall(file.open(solver->domain().comm(), path));
  PetscCall(file.read_options(&options));
  *refusal = changed_option(options, parsed);
  if (!refusal->empty()) PetscFunctionReturn(0);
  PetscCall(load_state(&file, path, solver, position));
  if (values_of(options)["time_step"].differs(values_of(options_text(parsed))["time_step"]))
    position->dt = 0;  // it is chosen anew at once
  if (file.version() != EULASTIC_VERSION)
    (void)PetscFPrintf(
        solver->domain().comm(), stderr, "eulastic: warning: %s\n",
        one_line(path + " was written by version " + file.version() + ": the results may differ in the last bits")
            .c_str());
  PetscFunctionReturn(0);
}

// A run that is beyond its end already.
std::string beyond_end(const State &state, const TimeControl &time) {
  if (time.end > 0 && state.time > time.end * (1 + 1e-12))
    return print("-time_end: the checkpoint is at t = %.9g already; accepted: a later end", state.time);
  if (time.steps_max > 0 && state.step > time.steps_max)
    return print("-time_steps_max: the checkpoint is at step %lld already; accepted: more steps",
                 static_cast<long long>(state.step));
  return {};
}

}  // namespace

bool restarts_in_place(const Config &config) {
  const fs::path source = config.checkpoint.restart;
  return on_rank_0([&] {
    std::error_code error;
    const fs::path directory = fs::is_directory(source, error) ? source : fs::absolute(source, error).parent_path();
    return fs::equivalent(directory, config.output.directory, error);
  });
}

PetscErrorCode time_thrown_away(MPI_Comm comm, const std::string &directory, double time, double *thrown_away) {
  int rank;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (rank == 0) {
    std::ifstream rows(directory + "/series.csv");
    double last = time;
    for (std::string row; std::getline(rows, row);) last = std::strtod(row.c_str(), nullptr);
    *thrown_away = std::max(0.0, last - time);
  }
  PetscCallMPI(MPI_Bcast(thrown_away, 1, MPI_DOUBLE, 0, comm));
  PetscFunctionReturn(0);
}

std::string shorter_end(const Config &config, double held) {
  if (config.time.end >= held * (1 - 1e-12)) return {};
  return print("-time_end: %.9g is before t = %.9g, which the run in ", config.time.end, held) +
         config.output.directory +
         " has reached; accepted: a later end, another -output_dir, or -output_overwrite to discard what comes after";
}

std::string changed_option(const std::string &before, const ParseResult &now) {
  auto then = values_of(before), here = values_of(options_text(now));
  Config config = now.config;
  for (const Option &option : option_table(config)) {
    if (option.applies && !option.applies()) continue;  // earlier versions had some of them in options.txt
    const Value &a = then[option.name], &b = here[option.name];
    if (!option.may_change && a.differs(b))
      return "-" + option.name + ": cannot change at a restart; in the checkpoint: " + shown(a) + ", now: " + shown(b);
  }
  return {};
}

PetscErrorCode restart(const ParseResult &parsed, Solver *solver, RunPosition *position, std::string *path,
                       std::string *refusal) {
  const MPI_Comm comm = solver->domain().comm();
  const fs::path source = parsed.config.checkpoint.restart;
  std::error_code error;
  const bool is_directory = on_rank_0([&] { return fs::is_directory(source, error); });
  PetscFunctionBeginUser;
  const std::vector<std::string> all =
      list_everywhere(is_directory ? source : fs::absolute(source, error).parent_path());
  const std::vector<std::string> candidates = is_directory ? all : std::vector<std::string>{source};
  if (candidates.empty())
    *refusal = "-restart: there is no checkpoint in " + source.string() +
               "; accepted: a checkpoint, or a directory with checkpoints";
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    std::string damage;
    *path = candidates[c];
    PetscCall(catch_together([&] { return load(parsed, *path, solver, position, refusal); }, &damage));
    if (damage.empty()) {
      if (refusal->empty()) *refusal = beyond_end(solver->state(), parsed.config.time);
      PetscFunctionReturn(0);
    }
    std::string older;
    for (const std::string &other : all)
      if (older.empty() && (checkpoint_step(*path) < 0 || checkpoint_step(other) < checkpoint_step(*path)) &&
          !on_rank_0([&] { return fs::equivalent(other, *path, error); }))
        older = other;
    *refusal = "-restart: " + damage + (older.empty() ? "; there is no older one" : "; the next older one is " + older);
    if (!is_directory || older.empty()) PetscFunctionReturn(0);
    (void)PetscFPrintf(comm, stderr, "eulastic: warning: %s\n", one_line(*refusal).c_str());
    refusal->clear();
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
