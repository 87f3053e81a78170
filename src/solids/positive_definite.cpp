#include "solids/positive_definite.hpp"

#include "base/events.hpp"
#include "grid/threads.hpp"
#include "kernels/stencils.hpp"

#include <algorithm>
#include <limits>

namespace eulastic {
namespace {

struct Edges {
  ConstView phi, aa, bb;
  View ab;
  std::ptrdiff_t a, b;  // strides
  double threshold;
};

EULASTIC_CLONES void limit_row(const Edges &e, const Segment &s) {
  const double *phi = e.phi.row(s.j, s.k), *aa = e.aa.row(s.j, s.k), *bb = e.bb.row(s.j, s.k);
  double *ab = e.ab.row(s.j, s.k);
#pragma omp simd
  for (int i = s.i_begin; i < s.i_end; ++i) {
    const double square = kernels::average4(aa + i, -e.a, -e.b) * kernels::average4(bb + i, -e.a, -e.b);
    const double most = __builtin_sqrt(square > 0 ? square : 0.0);
    const double limited = ab[i] > most ? most : ab[i] < -most ? -most : ab[i];
    const bool finite = __builtin_fabs(ab[i]) <= std::numeric_limits<double>::max();  // keep non-finite values visible
    ab[i] = kernels::average4(phi + i, -e.a, -e.b) < e.threshold || !finite ? ab[i] : limited;
  }
}

}  // namespace

PetscErrorCode limit_shear(const Box &box, const Phase &phase, Field &tensor) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::left_cauchy_green);
  for (int f = 0; f < tensor.count(); ++f) {
    const auto [a, b, at] = phase.tensor.components()[f];
    if (a == b) continue;
    const Edges edges{phase.fraction[0],     tensor[a], tensor[b], tensor[f], tensor[f].stride(a), tensor[f].stride(b),
                      phase.tensor.rule.edge};
    in_parts_of(phase.tensor.evolving.all(), box, [&](const Segment *begin, const Segment *end) {
      for (const Segment *s = begin; s < end; ++s) {
        if (s->j >= box.points_end(1, at[1]) || s->k >= box.points_end(2, at[2])) continue;
        limit_row(edges, {s->i_begin, std::min(s->i_end, box.points_end(0, at[0])), s->j, s->k});
      }
    });
    scope.flops(phase.tensor.evolving.points() * 16);
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
