#include "bodies/near_groups.hpp"

#include "base/deliver.hpp"

#include <algorithm>

namespace eulastic {

PetscErrorCode NearGroups::connect(MPI_Comm comm, const std::vector<int> &labels) {
  PetscFunctionBeginUser;
  comm_ = comm;
  bodies_ = labels.empty() ? 0 : labels.back();
  PetscCallMPI(MPI_Comm_size(comm, &ranks_));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &bodies_, 1, MPI_INT, MPI_MAX, comm));
  std::vector<int> here;
  for (const int label : labels) here.push_back(label - 1);
  PetscCall(owners_.connect(comm, bodies_, std::move(here)));
  PetscFunctionReturn(0);
}

PetscErrorCode NearGroups::gather(std::vector<NearBodies> *pairs) const {
  PetscFunctionBeginUser;
  const auto slot = [this](int label) { return static_cast<std::size_t>(owners_.slot(label - 1)); };
  // The highest label that each body is known to be connected with.
  std::vector<double> group, merged(owners_.here().size()), owned(static_cast<std::size_t>(owners_.owned().size()), 0);
  for (const int body : owners_.here()) group.push_back(body + 1);
  for (int changed = 1; changed > 0;) {
    for (bool again = true; again;) {
      again = false;
      for (auto pair = pairs->rbegin(); pair != pairs->rend(); ++pair) {
        if (pair->other == 0) continue;
        double &a = group[slot(pair->body)], &b = group[slot(pair->other)];
        again = again || a != b;
        a = b = std::max(a, b);
      }
    }
    PetscCall(owners_.reduce(1, MPI_MAX, group, &owned));
    PetscCall(owners_.bring(1, owned, &merged));
    changed = merged != group;
    group.swap(merged);
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &changed, 1, MPI_INT, MPI_MAX, comm_));
  }
  std::vector<int> ranks;
  for (const NearBodies &pair : *pairs) ranks.push_back(owner(static_cast<int>(group[slot(pair.body)])));
  PetscCall(deliver(comm_, ranks, pairs));
  std::sort(pairs->begin(), pairs->end());
  pairs->erase(std::unique(pairs->begin(), pairs->end()), pairs->end());
  PetscFunctionReturn(0);
}

PetscErrorCode NearGroups::spread(std::vector<BodyMove> *moves) const {
  PetscFunctionBeginUser;
  const BodyRange &own = owners_.owned();
  std::vector<int> ranks;
  std::vector<double> owned(2 * static_cast<std::size_t>(own.size()), -1), here(2 * owners_.here().size());
  for (const BodyMove &move : *moves) ranks.push_back(owner(move.label));
  PetscCall(deliver(comm_, ranks, moves));
  for (const BodyMove &move : *moves) {
    const auto at = 2 * static_cast<std::size_t>(move.label - 1 - own.begin);
    owned[at] = move.from;
    owned[at + 1] = move.to;
  }
  PetscCall(owners_.bring(2, owned, &here));
  moves->clear();
  for (std::size_t n = 0; n < owners_.here().size(); ++n)
    if (here[2 * n] >= 0)
      moves->push_back({owners_.here()[n] + 1, static_cast<int>(here[2 * n]), static_cast<int>(here[2 * n + 1])});
  PetscFunctionReturn(0);
}

}  // namespace eulastic
