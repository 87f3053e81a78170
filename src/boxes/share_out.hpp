// Assigns bodies to ranks so that their work is balanced.
#pragma once

#include "base/petsc.hpp"
#include "field/material.hpp"

#include <vector>

namespace eulastic {

/// Work of a step in a cell of the grid without bodies: the unit of all loads.
inline constexpr double flow_work = 1;
/// Additional work of a phase of this material in a cell of the rows that it occupies on the grid, or of the box of a
/// body. From times of steps of the fast method with and without bodies (docs/scaling.md, "Work of ranks"); rigid
/// bodies are not transported. Whole numbers, so that sums of them have no rounding.
double phase_work(const Material &material, bool in_box);

/// A body of this rank.
struct BodyShare {
  int number;   ///< no other body of any rank has it
  int home;     ///< the rank in whose cells it lies
  double cost;  ///< in units of `load`
};

/// Fills all ranks up to one level of work with the bodies in the order of their homes. `loads`: other work of every
/// rank. `costs`: of consecutive bodies in that order, `before`: the sum over those that come before them, `total`:
/// over all bodies. Returns the rank of each of them.
std::vector<int> fill_ranks(const std::vector<double> &loads, double before, double total,
                            const std::vector<double> &costs);

/// `load`: other work of this rank. `ranks`: the new rank of each of `bodies`, by fill_ranks(), within one home in the
/// order of numbers: bodies stay at home or go to ranks near by in the order of ranks. Collective.
PetscErrorCode share_out(MPI_Comm comm, double load, const std::vector<BodyShare> &bodies, std::vector<int> *ranks);

/// The common level at which ranks with these loads have taken a given total.
double water_level(std::vector<double> heights, double total);

}  // namespace eulastic
