// Runs a case from a validated Config to its last output file.
#pragma once

#include "base/petsc.hpp"
#include "options/parse_options.hpp"

namespace eulastic {

enum ExitCode { exit_fine = 0, exit_failed = 1, exit_usage = 2, exit_wrong_numbers = 3 };

/// Runs the case. `refusal`: one line when it could not start (nothing written) or had to stop; `code`: the exit code.
PetscErrorCode run(const ParseResult &parsed, int *code, std::string *refusal);

}  // namespace eulastic
