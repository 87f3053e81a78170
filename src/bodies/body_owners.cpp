#include "bodies/body_owners.hpp"

namespace eulastic {

PetscErrorCode BodyOwners::connect(MPI_Comm comm, int bodies, std::vector<int> here) {
  int rank, ranks;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  owned_ = BodyRange::of(bodies, rank, ranks);
  here_ = std::move(here);
  std::vector<PetscSFNode> owners;
  for (const int body : here_) {
    const int owner = BodyRange::owner(body, bodies, ranks);
    owners.push_back({owner, body - BodyRange::of(bodies, owner, ranks).begin});
  }
  PetscCall(PetscSFCreate(comm, sf_.put()));
  PetscCall(PetscSFSetGraph(sf_.get(), owned_.size(), static_cast<PetscInt>(owners.size()), nullptr, PETSC_OWN_POINTER,
                            owners.data(), PETSC_COPY_VALUES));
  PetscCall(PetscSFSetUp(sf_.get()));
  PetscFunctionReturn(0);
}

PetscErrorCode BodyOwners::reduce(int width, MPI_Op op, const std::vector<double> &here,
                                  std::vector<double> *owned) const {
  PetscFunctionBeginUser;
  MpiType block;  // PetscSF computes maxima of the built-in type only
  if (width > 1) PetscCall(block.create(width, MPIU_REAL));
  const MPI_Datatype unit = block ? block.get() : MPIU_REAL;
  PetscCall(PetscSFReduceBegin(sf_.get(), unit, here.data(), owned->data(), op));
  PetscCall(PetscSFReduceEnd(sf_.get(), unit, here.data(), owned->data(), op));
  PetscFunctionReturn(0);
}

PetscErrorCode BodyOwners::bring(int width, const std::vector<double> &owned, std::vector<double> *here) const {
  PetscFunctionBeginUser;
  MpiType unit;
  PetscCall(unit.create(width, MPIU_REAL));
  PetscCall(PetscSFBcastBegin(sf_.get(), unit.get(), owned.data(), here->data(), MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(sf_.get(), unit.get(), owned.data(), here->data(), MPI_REPLACE));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
