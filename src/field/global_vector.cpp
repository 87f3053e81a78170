#include "field/global_vector.hpp"

#include <algorithm>

namespace eulastic {

PetscErrorCode to_global(const Domain &domain, ConstView field, Vec vector) {
  double *values;
  PetscFunctionBeginUser;
  PetscCall(VecGetArrayWrite(vector, &values));
  double *next = values;
  for (const Segment &s : domain.rows()) next = std::copy_n(field.row(s.j, s.k), s.size(), next);
  PetscCall(VecRestoreArrayWrite(vector, &values));
  PetscFunctionReturn(0);
}

PetscErrorCode from_global(const Domain &domain, Vec vector, View field) {
  const double *values;
  PetscFunctionBeginUser;
  PetscCall(VecGetArrayRead(vector, &values));
  const double *next = values;
  for (const Segment &s : domain.rows()) {
    std::copy_n(next, s.size(), field.row(s.j, s.k));
    next += s.size();
  }
  PetscCall(VecRestoreArrayRead(vector, &values));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
