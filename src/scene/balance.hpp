// -load_balance: where ranks begin so that they have about as much to do, rather than as many cells.
#pragma once

#include "base/petsc.hpp"
#include "solver/solver.hpp"

#include <vector>

namespace eulastic {

/// Collective. Estimates what a step costs in every row of cells of a solver that is ready for one, and cuts y and z
/// where its sums over planes are equal, then where the heaviest boxes are; x stays as it is. `spec`: of the solver's
/// grid, gets `starts` unless the even split is about as good. `line`: what has been done.
PetscErrorCode balance_ranks(const Solver &solver, GridSpec *spec, std::string *line);

/// First unit of each of `parts` ranks along a direction, and the number of units at the end. `cost`: of every unit of
/// that direction, >= 0, at least `parts` times `least`, which is how many each rank has or more. The largest sum over
/// a rank is the least that there is, but for what `least` takes; within that the cuts are where sums are most equal.
std::vector<int> equal_cuts(const std::vector<double> &cost, int parts, int least);

}  // namespace eulastic
