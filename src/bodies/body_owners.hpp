// Who adds up what of which body: every rank owns a range of all bodies and hears of them from the ranks that have
// cells of theirs. What a rank holds and sends is in proportion to its own bodies and those it owns.
#pragma once

#include "base/body_range.hpp"
#include "base/petsc.hpp"

#include <algorithm>
#include <vector>

namespace eulastic {

class BodyOwners {
public:
  BodyOwners() = default;
  BodyOwners(const BodyOwners &) = delete;
  BodyOwners &operator=(const BodyOwners &) = delete;
  ~BodyOwners();

  /// Of `bodies`; `here`: those that have something on this rank, ascending. Collective, once.
  PetscErrorCode connect(MPI_Comm comm, int bodies, std::vector<int> here);

  const BodyRange &owned() const { return owned_; }
  const std::vector<int> &here() const { return here_; }
  /// Position in here(), or -1.
  int slot(int body) const {
    if (body < 0) return -1;
    for (std::size_t n = first_look(body);; n = (n + 1) & (slots_.size() - 1))
      if (slots_[n] < 0 || here_[static_cast<std::size_t>(slots_[n])] == body) return slots_[n];
  }

  /// Combines `width` values of every body here() with those of the owned bodies, there or on another rank; `op`:
  /// MPI_SUM, or MPI_MAX of one value.
  PetscErrorCode reduce(int width, MPI_Op op, const std::vector<double> &here, std::vector<double> *owned) const;
  /// Copies `width` values of the owned bodies to all that have them here().
  PetscErrorCode bring(int width, const std::vector<double> &owned, std::vector<double> *here) const;

private:
  std::size_t first_look(int body) const { return static_cast<unsigned>(body) * 0x9e3779b97f4a7c15U >> shift_; }

  BodyRange owned_;
  std::vector<int> here_;
  std::vector<int> slots_ = {-1, -1};  ///< positions by a hash of the body, at most half of them taken; -1: nobody
  int shift_ = 63;                     ///< of 64 bits, to as many as there are slots
  PetscSF sf_ = nullptr;
};

/// The first `limit` of `bodies` values in the order of the bodies, on rank 0 alone, from those of the owners, at most
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
