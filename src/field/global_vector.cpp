#include "field/global_vector.hpp"

#include <algorithm>

namespace eulastic {
namespace {

// Lists the rows of this rank in the order of a global Vec of a DMDA, in local indices.
PetscErrorCode rows_of(const Domain &domain, Vec vector, std::vector<Segment> *rows) {
  DM dm;
  PetscInt first[3], count[3];
  PetscFunctionBeginUser;
  PetscCall(VecGetDM(vector, &dm));
  PetscCall(DMDAGetCorners(dm, &first[0], &first[1], &first[2], &count[0], &count[1], &count[2]));
  Int3 begin, end;
  for (int d = 0; d < 3; ++d) {
    begin[d] = static_cast<int>(first[d]) - domain.layout().begin[d];
    end[d] = begin[d] + static_cast<int>(count[d]);
  }
  for (int k = begin[2]; k < end[2]; ++k)
    for (int j = begin[1]; j < end[1]; ++j) rows->push_back({begin[0], end[0], j, k});
  PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode to_global(const Domain &domain, ConstView field, Vec vector) {
  std::vector<Segment> rows;
  double *values;
  PetscFunctionBeginUser;
  PetscCall(rows_of(domain, vector, &rows));
  PetscCall(VecGetArrayWrite(vector, &values));
  double *next = values;
  for (const Segment &s : rows) next = std::copy_n(field.row(s.j, s.k) + s.i_begin, s.size(), next);
  PetscCall(VecRestoreArrayWrite(vector, &values));
  PetscFunctionReturn(0);
}

PetscErrorCode from_global(const Domain &domain, Vec vector, View field) {
  std::vector<Segment> rows;
  const double *values;
  PetscFunctionBeginUser;
  PetscCall(rows_of(domain, vector, &rows));
  PetscCall(VecGetArrayRead(vector, &values));
  const double *next = values;
  for (const Segment &s : rows) {
    std::copy_n(next, s.size(), field.row(s.j, s.k) + s.i_begin);
    next += s.size();
  }
  PetscCall(VecRestoreArrayRead(vector, &values));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
