// -load_balance: cuts between ranks that balance their estimated work instead of their number of cells.
#pragma once

#include "base/petsc.hpp"
#include "solver/solver.hpp"

#include <vector>

namespace eulastic {

/// Collective. Estimates the cost of a step in every row of cells, cuts y and z where the sums over planes are equal,
/// and then refines the cuts around the heaviest boxes; x is not cut anew. `spec`: the solver's grid; gets `starts`
/// unless the even split is about as good. `line`: describes the result.
PetscErrorCode balance_ranks(const Solver &solver, GridSpec *spec, std::string *line);

/// Returns the first unit of each of `parts` ranks along a direction, followed by the number of units. `cost`: of every
/// unit of that direction, >= 0, at least `parts` times `least` entries; each rank has at least `least` units. The cuts
/// minimise the largest sum over a rank; among such cuts the sums are the most equal.
std::vector<int> equal_cuts(const std::vector<double> &cost, int parts, int least);

}  // namespace eulastic
