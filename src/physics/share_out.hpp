// Which rank is to have which body, so that all ranks have about as much to do.
#pragma once

#include "base/petsc.hpp"

#include <vector>

namespace eulastic {

/// A body of this rank.
struct BodyShare {
  int number;   ///< no other body of any rank has it
  int home;     ///< the rank in whose cells it lies
  double cost;  ///< in units of `load`
};

/// `load`: what this rank has to do besides. `ranks`: who is to have each of `bodies`, whoever has it now. All ranks
/// are filled up to one level, as bowls with water, by the bodies in the order of their homes: bodies stay at home or
/// go to ranks near by in the order of ranks. Collective.
PetscErrorCode share_out(MPI_Comm comm, double load, const std::vector<BodyShare> &bodies, std::vector<int> *ranks);

/// The level up to which a total fills bowls of these heights.
double water_level(std::vector<double> heights, double total);

}  // namespace eulastic
