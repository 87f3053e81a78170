// The normal velocity on a plane of faces that an inlet generator passes to its inflow boundary (docs/method.md,
// section 20).
#pragma once

#include "base/petsc.hpp"
#include "field/field.hpp"
#include "grid/domain.hpp"

#include <vector>

namespace eulastic {

/// Values of the normal velocity on a plane of faces.
class InletVelocity {
public:
  /// Copies `component`, normal to direction d, on the faces with the global index `index` from the ranks that own them
  /// to all ranks of their line along d, including ghosts of the other directions. Collective over `line`, the
  /// communicator of these ranks, ordered by their position along d.
  static PetscErrorCode copy(const Domain &domain, ConstView component, int d, int index, MPI_Comm line,
                             InletVelocity *fed);
  /// Copies the faces with the local index `local` of a block that contains them, without communication.
  static InletVelocity of_faces(const Box &box, ConstView component, int d, int local);
  /// Writes the values of a row of the plane to `component`. `row` lies in the plane or in another one along d.
  void set_row(const Segment &row, View component) const;
  /// Calls visit(local face, value) for every value of the plane, including ghosts.
  template <class Visit>
  void for_each(const Visit &visit) {
    for_points({begin_, end_}, [&](int i, int j, int k) { visit(Int3{i, j, k}, values_[index_of(i, j, k)]); });
  }

private:
  void resize(const Box &box, int d);
  void read(ConstView component, int local);
  std::size_t index_of(int i, int j, int k) const {
    const Int3 at{d_ == 0 ? begin_[0] : i, d_ == 1 ? begin_[1] : j, d_ == 2 ? begin_[2] : k};
    return (at[0] - begin_[0]) + std::size_t(end_[0] - begin_[0]) *
                                     ((at[1] - begin_[1]) + std::size_t(end_[1] - begin_[1]) * (at[2] - begin_[2]));
  }
  int d_ = 0;
  Int3 begin_{}, end_{};
  std::vector<double> values_;
};

}  // namespace eulastic
