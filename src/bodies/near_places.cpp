#include "bodies/near_places.hpp"

#include "base/send_to_ranks.hpp"
#include "grid/cell_ranks.hpp"
#include "grid/domain.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

// Returns the half-width of a body along d, or its bounding radius.
double reach(const Surface &surface, const BodyPlace &place, int d) {
  const double radius = surface.bounding_radius();
  return std::isfinite(radius) ? radius : surface.support(rotation(place.orientation)[d]);
}

// Returns the positions along d, in the grid of ranks, of those that a body is near.
std::vector<int> positions_near(const Domain &domain, int d, const Surface &surface, const BodyPlace &place) {
  const int cells = domain.domain_cells()[d];
  const double h = domain.spacing()[d], centre = place.centre[d], far = reach(surface, place, d) + h;
  if (d >= domain.dimension() || 2 * far + h >= domain.domain_shape().length[d])
    return positions_over(domain, d, 0, cells);
  int first = static_cast<int>(std::floor((centre - far) / h)), last = static_cast<int>(std::floor((centre + far) / h));
  return positions_over(domain, d, first, last + 1);
}

}  // namespace

bool is_near(const Domain &domain, int rank, const Surface &surface, const BodyPlace &place) {
  const Int3 at = domain.split().position_of(rank);
  for (int d = 0; d < domain.dimension(); ++d) {
    const std::vector<int> near = positions_near(domain, d, surface, place);
    if (std::find(near.begin(), near.end(), at[d]) == near.end()) return false;
  }
  return true;
}

std::vector<int> ranks_near(const Domain &domain, const Surface &surface, const BodyPlace &place) {
  std::vector<int> ranks;
  const std::vector<int> x = positions_near(domain, 0, surface, place), y = positions_near(domain, 1, surface, place);
  for (const int k : positions_near(domain, 2, surface, place))
    for (const int j : y)
      for (const int i : x) ranks.push_back(domain.split().rank_at({i, j, k}));
  return ranks;
}

PetscErrorCode send_to_near_ranks(MPI_Comm comm, const Domain &domain, const SpeciesSpec &spec, const Places &places,
                                  Places *here) {
  int rank;
  std::vector<int> ranks;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  here->count = places.count;
  here->everywhere = false;
  here->known.clear();
  if (places.count == 0) PetscFunctionReturn(0);
  const Surface surface(spec, domain.dimension());
  for (const NumberedPlace &place : places.known) {
    const std::vector<int> near = places.everywhere ? std::vector<int>() : ranks_near(domain, surface, place);
    if (places.everywhere && is_near(domain, rank, surface, place)) here->known.push_back(place);
    here->known.insert(here->known.end(), near.size(), place);
    ranks.insert(ranks.end(), near.begin(), near.end());
  }
  if (places.everywhere) PetscFunctionReturn(0);
  PetscCall(send_to_ranks(comm, ranks, &here->known));
  std::sort(here->known.begin(), here->known.end(),
            [](const NumberedPlace &a, const NumberedPlace &b) { return a.index < b.index; });
  PetscFunctionReturn(0);
}

}  // namespace eulastic
