// Detection of bodies in boxes that are near each other or near surfaces on the grid, so that ranks exchange only the
// receptors that may bind.
#pragma once

#include "field/phase.hpp"
#include "grid/domain.hpp"

#include <functional>
#include <map>
#include <vector>

namespace eulastic {

/// A body of this rank, with unwrapped ranges of cells.
struct BodyBlock {
  int number, species;
  Extent box;   ///< its cells
  Extent hull;  ///< its cells and the cells around them within reach of its receptors
};

struct NearBody {
  int number;
  int rank;    ///< the rank that has it
  Extent box;  ///< its cells
};

struct Surroundings {
  std::vector<NearBody> bodies;  ///< sorted by number
  bool surface = false;          ///< whether a surface on the grid is near
};

/// Finds, for every body of this rank, the other bodies whose box intersects its hull, or whose hull intersects its
/// box, if join(species, other species); and whether has_surface(species, hull) on any rank that owns cells of the
/// hull. Each body is sent to the ranks that own cells of its hull. Collective.
PetscErrorCode find_surroundings(const Domain &domain, const std::vector<BodyBlock> &bodies,
                                 const std::function<bool(int, int)> &join,
                                 const std::function<bool(int, const Extent &)> &has_surface,
                                 std::map<int, Surroundings> *found);

}  // namespace eulastic
