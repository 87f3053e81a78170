// Acts on a parsed command line: prints an answer, runs the case, or refuses it. PETSc must be initialised.
#pragma once

#include "options/parse_options.hpp"

namespace eulastic {

/// Prints the answer of -help, -version, -check_only or -print_options, or runs the case, on run_communicator().
/// Prints at most one line "eulastic: error: ..." to stderr. Returns the exit code (run/run.hpp). Collective; aborts
/// all ranks of the program after an error that one rank may have met alone.
int act(ParseResult &parsed);

}  // namespace eulastic
