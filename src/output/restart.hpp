// -restart: finds a valid checkpoint and continues from it.
#pragma once

#include "base/petsc.hpp"
#include "options/parse_options.hpp"
#include "output/saved_state.hpp"

namespace eulastic {

/// Collective. Reads `config.checkpoint.restart` into the solver, whose scene has been built: the file itself, or of a
/// directory the newest checkpoint that is whole; those passed over get a line each on stderr. `refusal`: one line if
/// there is none, or if an option that must not change has changed. `path`: what was read.
PetscErrorCode restart(const ParseResult &parsed, Solver *solver, RunPosition *position, std::string *path,
                       std::string *refusal);

/// Local. Whether the run continues in the directory it began in.
bool restarts_in_place(const Config &config);

/// Collective. `thrown_away`: simulated time after `time` that series.csv in `directory` covers; 0 if it ends before.
PetscErrorCode time_thrown_away(MPI_Comm comm, const std::string &directory, double time, double *thrown_away);
/// Nothing, or one line if a run in place would end before `held`, the time of the last row in its directory.
std::string shorter_end(const Config &config, double held);

/// The first option, among those that must not change at a restart, whose value differs between two options_text();
/// empty if there is none, else one line.
std::string changed_option(const std::string &before, const ParseResult &now);

}  // namespace eulastic
