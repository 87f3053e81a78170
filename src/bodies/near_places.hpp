// Which bodies lie near the cells of which ranks.
#pragma once

#include "base/petsc.hpp"
#include "bodies/placement.hpp"
#include "bodies/shapes.hpp"
#include "grid/domain.hpp"

namespace eulastic {

/// Returns whether a body is within one cell of the cells of a rank.
bool is_near(const Domain &domain, int rank, const Surface &surface, const BodyPlace &place);
/// Returns all ranks for which is_near() holds.
std::vector<int> ranks_near(const Domain &domain, const Surface &surface, const BodyPlace &place);
/// Sends the bodies of a species to the ranks of `comm` that they are near; `here` gets those of this rank, in order.
/// `domain` need not be allocated: it may be planned only. Collective.
PetscErrorCode send_to_near_ranks(MPI_Comm comm, const Domain &domain, const SpeciesSpec &spec, const Places &places,
                                  Places *here);

}  // namespace eulastic
