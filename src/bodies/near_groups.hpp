// Groups of bodies that are near each other, directly or through others: one rank knows all of a group and decides.
#pragma once

#include "base/petsc.hpp"
#include "bodies/body_owners.hpp"
#include "bodies/contact.hpp"
#include "bodies/near_bodies.hpp"

namespace eulastic {

class NearGroups {
public:
  /// Collective, once. `labels`: the bodies that this rank sees, ascending.
  PetscErrorCode connect(MPI_Comm comm, const std::vector<int> &labels);
  /// Collective. `pairs`: those that this rank has found, of bodies that it sees; then all of the groups that it
  /// decides on, each once, ascending. A body with 0 in place of another one is in the group of that body. The rank of
  /// a group is the owner of its highest label. Sent are the labels of groups, 8 B a body that is seen, until no rank
  /// changes one, and 12 B a pair.
  PetscErrorCode gather(std::vector<NearBodies> *pairs) const;
  /// Collective. `moves`: of bodies of groups that this rank decides on; then of all that it sees, by label. 12 B a
  /// body to its owner and 16 B from there to all who see it.
  PetscErrorCode spread(std::vector<BodyMove> *moves) const;

private:
  int owner(int label) const { return BodyRange::owner(label - 1, bodies_, ranks_); }

  MPI_Comm comm_ = MPI_COMM_NULL;
  int bodies_ = 0, ranks_ = 1;
  BodyOwners owners_;
};

}  // namespace eulastic
