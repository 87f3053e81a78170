// Records go to the ranks that they are for.
#pragma once

#include "base/mpi_type.hpp"

#include <vector>

namespace eulastic {

/// Collective: record n goes to ranks[n]; then `records` are those that have come here, by the rank that sent them.
/// Messages between these ranks only.
template <class T>
PetscErrorCode deliver(MPI_Comm comm, const std::vector<int> &ranks, std::vector<T> *records) {
  SfHandle sf;
  const PetscInt *arriving;
  std::vector<PetscSFNode> to;
  MpiType one;
  int size;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  if (size == 1) PetscFunctionReturn(0);
  for (const int rank : ranks) to.push_back({rank, 0});
  PetscCall(PetscSFCreate(comm, sf.put()));
  PetscCall(PetscSFSetGraph(sf.get(), 1, static_cast<PetscInt>(to.size()), nullptr, PETSC_OWN_POINTER, to.data(),
                            PETSC_COPY_VALUES));
  PetscCall(PetscSFComputeDegreeBegin(sf.get(), &arriving));
  PetscCall(PetscSFComputeDegreeEnd(sf.get(), &arriving));
  std::vector<T> arrived(static_cast<std::size_t>(arriving[0]));
  PetscCall(one.create(sizeof(T), MPI_BYTE));
  PetscCall(PetscSFGatherBegin(sf.get(), one.get(), records->data(), arrived.data()));
  PetscCall(PetscSFGatherEnd(sf.get(), one.get(), records->data(), arrived.data()));
  records->swap(arrived);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
