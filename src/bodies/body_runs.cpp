#include "bodies/body_runs.hpp"

#include "kernels/isa.hpp"
#include "kernels/stencils.hpp"

namespace eulastic {
namespace {

constexpr double full_cell = 0.999;

template <class Term>
EULASTIC_INLINE double sum_terms(const Run &run, Term term) {
  alignas(64) double values[ExactSums::block];
#pragma omp simd
  for (int i = 0; i < run.size(); ++i) values[i] = term(i);
  return lane_sum(values, run.size(), run.first);
}

}  // namespace

EULASTIC_CLONES void sum_run(const Box &box, const Run &run, const RunPlaces &places, const Field *velocity,
                             RunSums *sums) {
  const double *phi = run.of(run.phase.fraction, 0);
  const double *x = places.x;
  sums->fraction = sum_terms(run, [=](int i) EULASTIC_BODY { return phi[i]; });
  sums->first_moment = sum_terms(run, [=](int i) EULASTIC_BODY { return phi[i] * x[i]; });
  sums->second_moment = sum_terms(run, [=](int i) EULASTIC_BODY { return phi[i] * (x[i] * x[i]); });
  if (!velocity) return;
  for (int d = 0; d < box.dimension(); ++d) {
    const double *face = run.of(*velocity, d), *next = face + (*velocity)[d].stride(d);
    sums->momentum[d] = sum_terms(run, [=](int i) EULASTIC_BODY { return phi[i] * (0.5 * (face[i] + next[i])); });
  }
  if (run.phase.material.is_membrane()) return;  // a membrane's B is defined on its surface only
  sums->full_cells = sum_terms(run, [=](int i) EULASTIC_BODY { return phi[i] > full_cell ? 1.0 : 0.0; });
  if (sums->full_cells == 0) return;
  for (int f = 0; f < run.phase.tensor.field.count(); ++f) {
    const auto [a, b, at] = run.phase.tensor.components()[f];
    const double *B = run.of(run.phase.tensor.field, f);
    const std::ptrdiff_t sa = run.phase.tensor.field[f].stride(a), sb = run.phase.tensor.field[f].stride(b);
    sums->tensor[f] = a == b ? sum_terms(run, [=](int i) EULASTIC_BODY { return phi[i] > full_cell ? B[i] : 0; })
                             : sum_terms(run, [=](int i) EULASTIC_BODY {
                                 const double mean = kernels::average4(B + i, sa, sb);
                                 return phi[i] > full_cell ? mean : 0;
                               });
  }
}

RunPlaces places_of(const Box &box, const Run &run, const Int3 &reference) {
  RunPlaces places;
  const Real3 begin = offset(box, reference, {run.begin, run.j, run.k});
  for (int i = 0; i < run.size(); ++i) places.x[i] = offset(box, 0, reference[0], run.begin + i);
  places.y = begin[1];
  places.z = begin[2];
  return places;
}

}  // namespace eulastic
