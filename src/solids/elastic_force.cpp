#include "solids/elastic_force.hpp"

#include "base/events.hpp"
#include "field/law.hpp"
#include "grid/blocks.hpp"

#include <algorithm>

namespace eulastic {
namespace {

// Faces of components a_begin <= a < a_end in rows of plane k.
struct Rows {
  int i_begin, i_end, j_begin, j_end, k, a_begin, a_end;
};

// Prefetches data two planes ahead that the batches do not: the cache lines beside the vectors of a segment, and phi.
void prefetch_beside(const Phase &phase, const Segment &s) {
  const ConstView phi = phase.fraction[0];
  const Field &B = phase.tensor.field;
  const int i = s.i_begin - 1, length = s.size() + 2 + 7, k = s.k + 2;
  prefetch(phi.row(s.j, k) + i, length);
  for (int f = 0; f < B.count(); ++f)
    for (const int end : {i, s.i_end}) prefetch(B[f].row(s.j, k) + end, 1);
  for (const int j : {s.j - 1, s.j + 1}) {
    if (!phase.tensor.stressed.idle(j, s.k)) continue;
    prefetch(phi.row(j, k) + i, length);
    for (int f = 0; f < B.count(); ++f) prefetch(B[f].row(j, k) + i, length);
  }
}

template <int Dim, bool WithSlope, class Law, class Viscosity>
EULASTIC_INLINE void add_force(const Box &box, const Phase &phase, const Law &law, const Viscosity &viscosity,
                               const Rows &rows, Field &force, const WeightedTarget &slope) {
  const ConstView phi = phase.fraction[0];
  const Real3 &h = box.spacing();
  const double inverse[3] = {1 / h[0], 1 / h[1], 1 / h[2]};
  const std::ptrdiff_t stride[3] = {phi.stride(0), phi.stride(1), phi.stride(2)};
  const double *B[6] = {};
  for (int f = 0; f < phase.tensor.field.count(); ++f) B[f] = phase.tensor.field[f].origin;
  const auto add = [&](kernels::Batch &batch) EULASTIC_BODY {
    for (int a = rows.a_begin; a < rows.a_end; ++a) {
      if (Dim == 3) {  // prefetch two planes ahead
        batch.ahead[0] = B[a] + 2 * phi.sz;
        batch.ahead[1] = B[kernels::position<Dim>(a, (a + 1) % Dim)] + 2 * phi.sz;
      }
      double *sum = force[a].origin, *change = WithSlope ? (*slope.field)[a].origin : nullptr;
      const double factor = slope.factor;
      kernels::elastic_force<Dim>(batch, phi, B, stride, inverse, a, law, viscosity,
                                  [=](std::ptrdiff_t o, double f) EULASTIC_BODY {
                                    sum[o] += f;
                                    if (WithSlope) change[o] = kernels::fma(factor, f, change[o]);
                                  });
    }
  };
  kernels::Batch batch;
  for (int j = rows.j_begin; j < rows.j_end; ++j)
    for (const Segment &s : phase.tensor.stressed.row(j, rows.k)) {
      if (Dim == 3) prefetch_beside(phase, s);
      kernels::gather(batch, j * phi.sy + rows.k * phi.sz, std::max(s.i_begin, rows.i_begin),
                      std::min(s.i_end, rows.i_end), add);
    }
  add(batch);
}

template <int Dim>
EULASTIC_INLINE void add_force_of_law(const Box &box, const Phase &phase, double scale, const Rows &rows, Field &force,
                                      const WeightedTarget &slope) {
  with_law(phase.material, [&](const auto &law) EULASTIC_BODY {
    with_viscosity(phase.tensor.rule, [&](const auto &viscosity) EULASTIC_BODY {
      if (slope.field)
        add_force<Dim, true>(box, phase, law.scaled(scale), viscosity, rows, force, slope);
      else
        add_force<Dim, false>(box, phase, law.scaled(scale), viscosity, rows, force, slope);
    });
  });
}

EULASTIC_CLONES void add_force_2d(const Box &box, const Phase &phase, double scale, const Rows &rows, Field &force,
                                  const WeightedTarget &slope) {
  add_force_of_law<2>(box, phase, scale, rows, force, slope);
}
EULASTIC_CLONES void add_force_3d(const Box &box, const Phase &phase, double scale, const Rows &rows, Field &force,
                                  const WeightedTarget &slope) {
  add_force_of_law<3>(box, phase, scale, rows, force, slope);
}

void add_on_rows(const Box &box, const Phase &phase, double scale, const Rows &rows, Field &force,
                 const WeightedTarget &slope) {
  if (phase.material.elastic() && !phase.tensor.stressed.idle_rows(rows.j_begin, rows.j_end, rows.k))
    (box.dimension() == 2 ? add_force_2d : add_force_3d)(box, phase, scale, rows, force, slope);
}
void add_on_rows(const Box &box, const std::vector<Phase> &phases, double scale, const Rows &rows, Field &force,
                 const WeightedTarget &slope) {
  for (const Phase &phase : phases) add_on_rows(box, phase, scale, rows, force, slope);
}

}  // namespace

void add_elastic_force(const Box &box, const std::vector<Phase> &phases, double scale, int j_begin, int j_end, int k,
                       Field &force, const WeightedTarget &slope) {
  add_on_rows(box, phases, scale, {0, box.cells()[0], j_begin, j_end, k, 0, box.dimension()}, force, slope);
}

void add_elastic_force(const Box &box, const std::vector<Phase> &phases, double scale, const Segment &faces, int a,
                       Field &force, const WeightedTarget &slope) {
  add_on_rows(box, phases, scale, {faces.i_begin, faces.i_end, faces.j, faces.j + 1, faces.k, a, a + 1}, force, slope);
}

PetscErrorCode compute_elastic_force(const Box &box, double scale, const std::vector<Phase> &phases, Field &force) {
  PetscFunctionBeginUser;
  EventScope scope(Event::momentum);
  const int dim = box.dimension(), n = box.cells()[0];
  in_row_parts(box, [&](const RowPart &part) {
    for_rows_in_blocks(
        part,
        [&](int j, int k) {
          for (int a = 0; a < dim; ++a) {
            if (dim == 3) prefetch(force[a].row(j, k + 1), n);
            std::fill_n(force[a].row(j, k), n, 0.0);
          }
        },
        [&](int begin, int end, int k) { add_elastic_force(box, phases, scale, begin, end, k, force); });
  });
  for (int a = 0; a < dim; ++a)
    for (const Segment &faces : box.open_high_faces(a)) {
      std::fill_n(force[a].row(faces.j, faces.k) + faces.i_begin, faces.size(), 0.0);
      add_elastic_force(box, phases, scale, faces, a, force);
    }
  scope.flops(elastic_flops(dim, phases));
  PetscFunctionReturn(0);
}

void compute_elastic_force(const Box &box, double scale, const Phase &phase, Field &force) {
  EventScope scope(Event::momentum);
  const int dim = box.dimension();
  for (int a = 0; a < dim; ++a)
    for (const Segment &s : phase.tensor.stressed.all()) std::fill_n(force[a].row(s.j, s.k) + s.i_begin, s.size(), 0.0);
  for (int k = 0; k < box.cells()[2]; ++k)
    add_on_rows(box, phase, scale, {0, box.cells()[0], 0, box.cells()[1], k, 0, dim}, force, {});
  for (int a = 0; a < dim; ++a)
    for (const Segment &faces : box.open_high_faces(a))
      add_on_rows(box, phase, scale, {faces.i_begin, faces.i_end, faces.j, faces.j + 1, faces.k, a, a + 1}, force, {});
  scope.flops(elastic_flops(dim, phase));
}

double elastic_flops(int dimension, const std::vector<Phase> &phases) {
  double sum = 0;
  for (const Phase &phase : phases) sum += elastic_flops(dimension, phase);
  return sum;
}

double elastic_flops(int dimension, const Phase &phase) {
  return dimension * phase.tensor.stressed.points() *
         with_law(phase.material, [&](const auto &law) { return law.flops(dimension); });
}

}  // namespace eulastic
