// What the owners of bodies know of them, on every rank.
#pragma once

#include "base/rank_zero.hpp"
#include "bodies/body_owners.hpp"
#include "scene/config.hpp"

#include <gtest/gtest.h>

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

/// A scene that any rank can build alone. Collective.
inline Config with_all_places(Config config) {
  for (Places &places : config.places) {
    if (places.everywhere) continue;
    std::vector<BodyPlace> all, owned(places.known.begin(), places.known.end());
    EXPECT_EQ(all_bodies(run_communicator(), places.count, places.count, owned, &all), 0);
    places = Places(all);
  }
  return config;
}

}  // namespace eulastic::test
