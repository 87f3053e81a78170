// What the owners of bodies know of them, on every rank.
#pragma once

#include "bodies/body_owners.hpp"

namespace eulastic::test {

/// The first `limit` of them. Collective.
template <class T>
PetscErrorCode all_bodies(MPI_Comm comm, int bodies, int limit, const std::vector<T> &owned, std::vector<T> *all) {
  PetscFunctionBeginUser;
  PetscCall(gather_bodies(comm, bodies, limit, owned, all));
  all->resize(static_cast<std::size_t>(std::min(limit, bodies)));
  PetscCallMPI(MPI_Bcast(all->data(), static_cast<int>(all->size() * sizeof(T)), MPI_BYTE, 0, comm));
  PetscFunctionReturn(0);
}

}  // namespace eulastic::test
