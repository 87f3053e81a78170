#include "field/fed_velocity.hpp"

#include "field/reflection.hpp"
#include "grid/domain.hpp"

namespace eulastic {

PetscErrorCode FedVelocity::copy(const Domain &domain, ConstView component, int d, int index, MPI_Comm line,
                                 FedVelocity *fed) {
  const Plane plane(domain.layout(), d);
  const int owner = domain.split().position_along(d, index), local = index - domain.layout().begin[d];
  int position;
  PetscFunctionBeginUser;
  fed->d_ = d;
  fed->begin_ = plane.begin;
  fed->end_ = plane.end;
  std::size_t count = 1;
  for (int e = 0; e < 3; ++e) count *= std::size_t(plane.end[e] - plane.begin[e]);
  fed->values_.resize(count);
  PetscCallMPI(MPI_Comm_rank(line, &position));
  if (position == owner)
    fed->for_each([&](Int3 at, double &value) {
      at[d] = local;
      value = component(at[0], at[1], at[2]);
    });
  PetscCallMPI(MPI_Bcast(fed->values_.data(), static_cast<int>(count), MPI_DOUBLE, owner, line));
  PetscFunctionReturn(0);
}

void FedVelocity::set_row(const Segment &row, View component) const {
  for (int i = row.i_begin; i < row.i_end; ++i) component(i, row.j, row.k) = values_[place(i, row.j, row.k)];
}

}  // namespace eulastic
