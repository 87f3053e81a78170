// Contact: bodies of one species that come near get phases ("colours") of their own. docs/method.md, section 15.
//
// Within one phase nothing tells two bodies apart once interface transport, B outside bodies or labels reach both.
// Phases never mix: their stresses add up and all move with the one velocity. So as many phases as it takes to keep
// near bodies apart keep them apart for ever.
#pragma once

#include "base/petsc.hpp"
#include "field/ghost_exchange.hpp"
#include "field/phase.hpp"
#include "grid/domain.hpp"

#include <set>

namespace eulastic {

/// Two bodies are near if a cell of one lies within so many cells of one of the other in every direction
/// (bodies/near_bodies.hpp). The next look comes before either has reached more than one cell further: until then no
/// stencil of the interface and no layer of labels sees both, and the two layers of B next to a body are its own.
inline constexpr int contact_reach = 4;
inline constexpr int most_colours = 64;  ///< of a species

/// A body that has got another phase; positions in the vector of phases.
struct BodyMove {
  int label, from, to;
};

struct Separation {
  std::vector<BodyMove> moves;  ///< by label, of bodies in this rank's box and around it
  std::set<int> changed;        ///< phases that bodies have left or come to, the same on all ranks
  std::string crowded;          ///< one line if most_colours are too few; then nothing moves
};

/// Collective. Of every two near bodies in a phase with `separate` the one with the higher label moves to the first
/// phase of its species without a body near it. If there is none, all bodies of the species get colours anew, as few
/// as colour_bodies() needs, and phases are appended if they are more than there are. If no two are near, the bodies of
/// a species' last phase move to others if all of them can; one that is empty is removed, before anything else.
/// phi, B and label of a body go as they are, edges of B with them; points of B around it and all ghosts are the
/// caller's. Needs owned labels and phi. `also`: ascending labels whose moves are wanted here, although there may be no
/// cell of theirs.
PetscErrorCode separate_bodies(const Domain &domain, GhostExchange &exchange, const std::vector<int> &also,
                               std::vector<Phase> *phases, Separation *result);

}  // namespace eulastic
