// The normal velocity on a plane of faces, as a feeder hands it to its inflow side (docs/method.md, section 20).
#pragma once

#include "base/petsc.hpp"
#include "field/field.hpp"
#include "grid/domain.hpp"

#include <vector>

namespace eulastic {

class FedVelocity {
public:
  /// `component`, normal to direction d, on the faces with global index `index`, ghosts of the other directions
  /// included, of the rank that has them to all ranks of its line along d. Collective over `line`, whose ranks are the
  /// positions along d.
  static PetscErrorCode copy(const Domain &domain, ConstView component, int d, int index, MPI_Comm line,
                             FedVelocity *fed);
  /// The same from the faces with a local index of a block, which has them and does not share them.
  static FedVelocity of_faces(const Box &box, ConstView component, int d, int local);
  /// Writes the values of a row of the plane; `row` lies on it or on another one along d.
  void set_row(const Segment &row, View component) const;
  /// Every value of the plane, ghosts too: visit(local face, value).
  template <class Visit>
  void for_each(const Visit &visit) {
    for_points({begin_, end_}, [&](int i, int j, int k) { visit(Int3{i, j, k}, values_[place(i, j, k)]); });
  }

private:
  void lay_out(const Box &box, int d);
  void take(ConstView component, int local);
  std::size_t place(int i, int j, int k) const {
    const Int3 at{d_ == 0 ? begin_[0] : i, d_ == 1 ? begin_[1] : j, d_ == 2 ? begin_[2] : k};
    return (at[0] - begin_[0]) + std::size_t(end_[0] - begin_[0]) *
                                     ((at[1] - begin_[1]) + std::size_t(end_[1] - begin_[1]) * (at[2] - begin_[2]));
  }
  int d_ = 0;
  Int3 begin_{}, end_{};
  std::vector<double> values_;
};

}  // namespace eulastic
