// Sends records to the ranks that need them, without knowing who receives from whom, or to all ranks.
#pragma once

#include "base/petsc.hpp"

#include <numeric>
#include <vector>

namespace eulastic {

/// Sends record n to ranks[n], and replaces `records` by those that arrived, ordered by the sending rank. Collective;
/// messages pass between the ranks concerned only.
template <class T>
PetscErrorCode send_to_ranks(MPI_Comm comm, const std::vector<int> &ranks, std::vector<T> *records) {
  SfHandle sf;
  const PetscInt *arriving;
  std::vector<PetscSFNode> targets;
  MpiType record_type;
  int size;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  if (size == 1) PetscFunctionReturn(0);
  for (const int rank : ranks) targets.push_back({rank, 0});
  PetscCall(PetscSFCreate(comm, sf.put()));
  PetscCall(PetscSFSetGraph(sf.get(), 1, static_cast<PetscInt>(targets.size()), nullptr, PETSC_OWN_POINTER,
                            targets.data(), PETSC_COPY_VALUES));
  PetscCall(PetscSFComputeDegreeBegin(sf.get(), &arriving));
  PetscCall(PetscSFComputeDegreeEnd(sf.get(), &arriving));
  std::vector<T> arrived(static_cast<std::size_t>(arriving[0]));
  PetscCall(record_type.create(sizeof(T), MPI_BYTE));
  PetscCall(PetscSFGatherBegin(sf.get(), record_type.get(), records->data(), arrived.data()));
  PetscCall(PetscSFGatherEnd(sf.get(), record_type.get(), records->data(), arrived.data()));
  records->swap(arrived);
  PetscFunctionReturn(0);
}

/// Collective: `records` of all ranks one after the other, on every rank. T: plain numbers or structs of them.
template <class T>
PetscErrorCode gather_all(MPI_Comm comm, std::vector<T> *records) {
  int ranks, count = static_cast<int>(records->size());
  MpiType one;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  PetscCall(one.create(sizeof(T), MPI_BYTE));
  std::vector<int> counts(ranks), begins(ranks + 1, 0);
  PetscCallMPI(MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, comm));
  std::partial_sum(counts.begin(), counts.end(), begins.begin() + 1);
  std::vector<T> all(begins.back());
  PetscCallMPI(
      MPI_Allgatherv(records->data(), count, one.get(), all.data(), counts.data(), begins.data(), one.get(), comm));
  records->swap(all);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
