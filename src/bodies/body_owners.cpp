#include "bodies/body_owners.hpp"

namespace eulastic {
namespace {

// MPI type of `width` values of a body. For one value it is the built-in type, for which alone PetscSF computes maxima.
class Unit {
public:
  explicit Unit(int width) {
    if (width == 1) return;
    (void)MPI_Type_contiguous(width, MPIU_REAL, &type_);
    (void)MPI_Type_commit(&type_);
  }
  Unit(const Unit &) = delete;
  Unit &operator=(const Unit &) = delete;
  ~Unit() {
    if (type_ != MPIU_REAL) (void)MPI_Type_free(&type_);
  }
  MPI_Datatype type() const { return type_; }

private:
  MPI_Datatype type_ = MPIU_REAL;
};

}  // namespace

BodyOwners::~BodyOwners() { (void)PetscSFDestroy(&sf_); }

PetscErrorCode BodyOwners::connect(MPI_Comm comm, int bodies, std::vector<int> here) {
  int rank, ranks;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  owned_ = BodyRange::of(bodies, rank, ranks);
  here_ = std::move(here);
  while (std::size_t{1} << (64 - shift_) < 2 * here_.size()) --shift_;
  slots_.assign(std::size_t{1} << (64 - shift_), -1);
  std::vector<PetscSFNode> owners;
  for (std::size_t slot = 0; slot < here_.size(); ++slot) {
    const int owner = BodyRange::owner(here_[slot], bodies, ranks);
    owners.push_back({owner, here_[slot] - BodyRange::of(bodies, owner, ranks).begin});
    std::size_t n = first_slot(here_[slot]);
    while (slots_[n] >= 0) n = (n + 1) & (slots_.size() - 1);
    slots_[n] = static_cast<int>(slot);
  }
  PetscCall(PetscSFCreate(comm, &sf_));
  PetscCall(PetscSFSetGraph(sf_, owned_.size(), static_cast<PetscInt>(owners.size()), nullptr, PETSC_OWN_POINTER,
                            owners.data(), PETSC_COPY_VALUES));
  PetscCall(PetscSFSetUp(sf_));
  PetscFunctionReturn(0);
}

PetscErrorCode BodyOwners::reduce(int width, MPI_Op op, const std::vector<double> &here,
                                  std::vector<double> *owned) const {
  PetscFunctionBeginUser;
  const Unit unit(width);
  PetscCall(PetscSFReduceBegin(sf_, unit.type(), here.data(), owned->data(), op));
  PetscCall(PetscSFReduceEnd(sf_, unit.type(), here.data(), owned->data(), op));
  PetscFunctionReturn(0);
}

PetscErrorCode BodyOwners::bring(int width, const std::vector<double> &owned, std::vector<double> *here) const {
  PetscFunctionBeginUser;
  const Unit unit(width);
  PetscCall(PetscSFBcastBegin(sf_, unit.type(), owned.data(), here->data(), MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(sf_, unit.type(), owned.data(), here->data(), MPI_REPLACE));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
