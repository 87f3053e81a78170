#include "flow/divergence.hpp"

#include "base/events.hpp"
#include "grid/threads.hpp"
#include "kernels/momentum.hpp"

namespace eulastic {
namespace {

template <int Dim>
EULASTIC_INLINE void divergence_rows(const Box &box, const RowPart &part, double density, const Field &v, Field &out) {
  const Real3 &h = box.spacing();
  const double inverse[3] = {1 / h[0], 1 / h[1], 1 / h[2]};
  for (const Segment &s : part.rows(box))
    kernels::divergence<Dim>(s, v[0], v[1], v[Dim - 1], inverse, density, out[0].row(s.j, s.k));
}

EULASTIC_CLONES void divergence_2d(const Box &box, const RowPart &part, double density, const Field &v, Field &out) {
  divergence_rows<2>(box, part, density, v, out);
}
EULASTIC_CLONES void divergence_3d(const Box &box, const RowPart &part, double density, const Field &v, Field &out) {
  divergence_rows<3>(box, part, density, v, out);
}

}  // namespace

PetscErrorCode compute_divergence(const Box &box, double density, const Field &velocity_star, Field &divergence) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::divergence);
  in_row_parts(box, [&](const RowPart &part) {
    (box.dimension() == 2 ? divergence_2d : divergence_3d)(box, part, density, velocity_star, divergence);
  });
  scope.flops(box.cell_count() * (3 * box.dimension() - 1));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
