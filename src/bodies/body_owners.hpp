// Ownership of per-body sums: every rank owns a range of all bodies and receives contributions from the ranks that hold
// cells of them. Memory and messages of a rank are proportional to the bodies it holds and owns.
#pragma once

#include "base/body_range.hpp"
#include "base/petsc.hpp"

#include <algorithm>
#include <vector>

namespace eulastic {

class BodyOwners {
public:
  /// Sets up the communication for `bodies` bodies; `here`: those with cells on this rank, ascending. Call once.
  /// Collective.
  PetscErrorCode connect(MPI_Comm comm, int bodies, std::vector<int> here);

  const BodyRange &owned() const { return owned_; }
  const std::vector<int> &here() const { return here_; }
  /// Returns the position of a body in here(), or -1.
  int slot(int body) const {
    const auto found = std::lower_bound(here_.begin(), here_.end(), body);
    return found != here_.end() && *found == body ? static_cast<int>(found - here_.begin()) : -1;
  }

  /// Reduces `width` values of every body in here() into those of its owner; `op`: MPI_SUM, or MPI_MAX with width 1.
  /// Collective.
  PetscErrorCode reduce(int width, MPI_Op op, const std::vector<double> &here, std::vector<double> *owned) const;
  /// Broadcasts `width` values of the owned bodies to all ranks that have them in here(). Collective.
  PetscErrorCode bring(int width, const std::vector<double> &owned, std::vector<double> *here) const;

private:
  BodyRange owned_;
  std::vector<int> here_;
  SfHandle sf_;
};

/// Gathers the first `limit` of `bodies` values from their owners to rank 0, in the order of the bodies and at most
/// BodyRange::piece at a time. Collective.
template <class T>
PetscErrorCode gather_bodies(MPI_Comm comm, int bodies, int limit, const std::vector<T> &owned, std::vector<T> *all) {
  int rank, ranks;
  MpiType one;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  PetscCall(one.create(sizeof(T), MPI_BYTE));
  const int first = BodyRange::of(bodies, rank, ranks).begin, count = std::min(limit, bodies);
  if (rank == 0) all->resize(static_cast<std::size_t>(count));
  for (int begin = 0; begin < count; begin += BodyRange::piece) {
    const int end = std::min(begin + BodyRange::piece, count);
    std::vector<int> counts, begins;
    for (int r = 0; r < ranks; ++r) {
      const BodyRange share = BodyRange::of(bodies, r, ranks).within(begin, end);
      counts.push_back(share.size());
      begins.push_back(share.begin);
    }
    PetscCallMPI(MPI_Gatherv(owned.data() + (begins[rank] - first), counts[rank], one.get(), all->data(), counts.data(),
                             begins.data(), one.get(), 0, comm));
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
