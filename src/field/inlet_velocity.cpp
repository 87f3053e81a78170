#include "field/inlet_velocity.hpp"

#include "field/reflection.hpp"

namespace eulastic {

PetscErrorCode InletVelocity::copy(const Domain &domain, ConstView component, int d, int index, MPI_Comm line,
                                   InletVelocity *fed) {
  const int owner = domain.split().position_along(d, index), local = index - domain.layout().begin[d];
  int position;
  PetscFunctionBeginUser;
  fed->resize(domain, d);
  PetscCallMPI(MPI_Comm_rank(line, &position));
  if (position == owner) fed->read(component, local);
  PetscCallMPI(MPI_Bcast(fed->values_.data(), static_cast<int>(fed->values_.size()), MPI_DOUBLE, owner, line));
  PetscFunctionReturn(0);
}

InletVelocity InletVelocity::of_faces(const Box &box, ConstView component, int d, int local) {
  InletVelocity fed;
  fed.resize(box, d);
  fed.read(component, local);
  return fed;
}

void InletVelocity::resize(const Box &box, int d) {
  const Plane plane(box.layout(), d);
  d_ = d;
  begin_ = plane.begin;
  end_ = plane.end;
  std::size_t count = 1;
  for (int e = 0; e < 3; ++e) count *= std::size_t(plane.end[e] - plane.begin[e]);
  values_.resize(count);
}

void InletVelocity::read(ConstView component, int local) {
  for_each([&](Int3 at, double &value) {
    at[d_] = local;
    value = component(at[0], at[1], at[2]);
  });
}

void InletVelocity::set_row(const Segment &row, View component) const {
  for (int i = row.i_begin; i < row.i_end; ++i) component(i, row.j, row.k) = values_[index_of(i, row.j, row.k)];
}

}  // namespace eulastic
