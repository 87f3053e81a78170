// An MPI datatype that is freed by its destructor.
#pragma once

#include "base/petsc.hpp"

namespace eulastic {

/// The datatype of `count` contiguous values of another datatype.
class MpiType {
public:
  MpiType() = default;
  MpiType(const MpiType &) = delete;
  MpiType &operator=(const MpiType &) = delete;
  ~MpiType() {
    if (type_ != MPI_DATATYPE_NULL) (void)MPI_Type_free(&type_);
  }
  /// May be called once.
  PetscErrorCode create(std::size_t count, MPI_Datatype of) {
    PetscFunctionBeginUser;
    PetscCallMPI(MPI_Type_contiguous(static_cast<int>(count), of, &type_));
    PetscCallMPI(MPI_Type_commit(&type_));
    PetscFunctionReturn(0);
  }
  MPI_Datatype get() const { return type_; }
  explicit operator bool() const { return type_ != MPI_DATATYPE_NULL; }

private:
  MPI_Datatype type_ = MPI_DATATYPE_NULL;
};

}  // namespace eulastic
