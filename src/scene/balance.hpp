// -load_balance: where ranks begin so that they have about as much to do, rather than as many cells.
#pragma once

#include "base/petsc.hpp"
#include "solver/solver.hpp"

namespace eulastic {

/// Collective. Estimates what a step costs in every row of cells of a solver that is ready for one, and cuts y and z
/// where its sums over planes are equal, then where the heaviest boxes are; x stays as it is. `spec`: of the solver's
/// grid, gets `starts` unless the even split is about as good. `line`: what has been done.
PetscErrorCode balance_ranks(const Solver &solver, GridSpec *spec, std::string *line);

}  // namespace eulastic
