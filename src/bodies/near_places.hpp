// Which bodies come near which ranks.
#pragma once

#include "base/petsc.hpp"
#include "bodies/placement.hpp"
#include "bodies/shapes.hpp"
#include "grid/domain.hpp"

namespace eulastic {

/// Whether a body may have a part of the cells of a rank: it is no more than a cell away.
bool is_near(const Domain &domain, int rank, const Surface &surface, const BodyPlace &place);
/// All ranks that it comes near.
std::vector<int> ranks_near(const Domain &domain, const Surface &surface, const BodyPlace &place);
/// Collective: of all bodies of a species those that come near this rank of `comm`. `grid` may be a planned one.
PetscErrorCode bring_near(MPI_Comm comm, const Domain &domain, const SpeciesSpec &spec, const Places &places,
                          Places *here);

}  // namespace eulastic
