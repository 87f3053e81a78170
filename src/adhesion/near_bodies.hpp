// Which bodies in boxes are near each other, and near surfaces on the grid: what ranks must know to exchange only the
// receptors that may bind.
#pragma once

#include "field/phase.hpp"
#include "grid/domain.hpp"

#include <functional>
#include <map>
#include <vector>

namespace eulastic {

/// A body of this rank. Cells are not wrapped around periodic sides.
struct BodyBlock {
  int number, species;
  Extent box;   ///< its cells
  Extent hull;  ///< these, and those around that its receptors may bind to or are bound to
};

struct NearBody {
  int number;
  int rank;    ///< that has it
  Extent box;  ///< its cells
};

struct Surroundings {
  std::vector<NearBody> bodies;  ///< by their numbers
  bool surface = false;          ///< near a surface on the grid
};

/// Finds what is near every body of this rank: other bodies of species that join(one, other), whose box its hull meets,
/// or that have the box of this one in theirs; and whether any rank has_surface(species, hull) among its own cells.
/// Ranks that own cells of a hull hear of the body. Collective.
PetscErrorCode find_surroundings(const Domain &domain, const std::vector<BodyBlock> &bodies,
                                 const std::function<bool(int, int)> &join,
                                 const std::function<bool(int, const Extent &)> &has_surface,
                                 std::map<int, Surroundings> *found);

}  // namespace eulastic
