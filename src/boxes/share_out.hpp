// Which rank is to have which body, so that all ranks have about as much to do.
#pragma once

#include "base/petsc.hpp"
#include "field/material.hpp"

#include <vector>

namespace eulastic {

/// Work of a step in a cell of the grid, whatever it holds: the unit of all loads.
inline constexpr double flow_work = 1;
/// What a phase of this material adds in a cell of the rows that it occupies on the grid, or of the box of a body. From
/// times of steps of the fast method with and without bodies (docs/scaling.md, "Work of ranks"); rigid bodies are not
/// transported. Whole numbers, so that sums of them have no rounding.
double phase_work(const Material &material, bool in_box);

/// A body of this rank.
struct BodyShare {
  int number;   ///< no other body of any rank has it
  int home;     ///< the rank in whose cells it lies
  double cost;  ///< in units of `load`
};

/// All ranks are filled up to one level, as bowls with water, by the bodies in the order of their homes. `loads`: what
/// every rank has to do besides. `costs`: of consecutive bodies in that order, `before`: the sum over those that come
/// before them, `total`: over all bodies. Returns the rank that is to have each of them.
std::vector<int> fill_ranks(const std::vector<double> &loads, double before, double total,
                            const std::vector<double> &costs);

/// `load`: what this rank has to do besides. `ranks`: who is to have each of `bodies`, whoever has it now, by
/// fill_ranks(), in one home in the order of numbers: bodies stay at home or go to ranks near by in the order of ranks.
/// Collective.
PetscErrorCode share_out(MPI_Comm comm, double load, const std::vector<BodyShare> &bodies, std::vector<int> *ranks);

/// The level up to which a total fills bowls of these heights.
double water_level(std::vector<double> heights, double total);

}  // namespace eulastic
