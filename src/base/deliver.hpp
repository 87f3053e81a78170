// Sends records to the ranks that need them, without knowing who receives from whom.
#pragma once

#include "base/mpi_type.hpp"

#include <vector>

namespace eulastic {

/// Sends record n to ranks[n], and replaces `records` by those that arrived, ordered by the sending rank. Collective;
/// messages pass between the ranks concerned only.
template <class T>
PetscErrorCode deliver(MPI_Comm comm, const std::vector<int> &ranks, std::vector<T> *records) {
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

}  // namespace eulastic
