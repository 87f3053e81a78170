#include "bodies/body_runs.hpp"

#include "kernels/isa.hpp"
#include "kernels/stencils.hpp"

namespace eulastic {
namespace {

constexpr int lanes = 8;
constexpr double full_cell = 0.999;

// Sums in eight lanes like lane_sum(): a term goes to the lane of its cell's global index, so that the bits do not
// depend on the decomposition.
class Lanes {
public:
  EULASTIC_INLINE Lanes(int first, int n) : first_(first), n_(n), vectors_((first + n + lanes - 1) / lanes) {
    for (int i = 0; i < lanes * vectors_; ++i) term_[i] = 0;
  }
  template <class Term>
  EULASTIC_INLINE double sum(Term term) {
    double *own = term_ + first_;
#pragma omp simd
    for (int i = 0; i < n_; ++i) own[i] = term(i);
    double lane[lanes] = {};
    for (int v = 0; v < vectors_; ++v)
#pragma omp simd
      for (int l = 0; l < lanes; ++l) lane[l] += term_[lanes * v + l];
    return ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
  }

private:
  int first_, n_, vectors_;
  alignas(64) double term_[ExactSums::block + lanes];
};

EULASTIC_CLONES void add_up(const Box &box, const Run &run, const RunPlaces &places, const Field *velocity,
                            RunSums *sums) {
  const int n = run.size();
  const double *phi = run.of(run.phase.fraction, 0);
  const double *x = places.x;
  Lanes lane(run.first & (lanes - 1), n);
  sums->fraction = lane.sum([=](int i) EULASTIC_BODY { return phi[i]; });
  sums->first_moment = lane.sum([=](int i) EULASTIC_BODY { return phi[i] * x[i]; });
  sums->second_moment = lane.sum([=](int i) EULASTIC_BODY { return phi[i] * (x[i] * x[i]); });
  if (!velocity) return;
  for (int d = 0; d < box.dimension(); ++d) {
    const double *face = run.of(*velocity, d), *next = face + (*velocity)[d].stride(d);
    sums->momentum[d] = lane.sum([=](int i) EULASTIC_BODY { return phi[i] * (0.5 * (face[i] + next[i])); });
  }
  if (run.phase.material.is_membrane()) return;  // a membrane's B is defined on its surface only
  sums->full_cells = lane.sum([=](int i) EULASTIC_BODY { return phi[i] > full_cell ? 1.0 : 0.0; });
  if (sums->full_cells == 0) return;
  for (int f = 0; f < run.phase.tensor.field.count(); ++f) {
    const auto [a, b, at] = run.phase.tensor.components()[f];
    const double *B = run.of(run.phase.tensor.field, f);
    const std::ptrdiff_t sa = run.phase.tensor.field[f].stride(a), sb = run.phase.tensor.field[f].stride(b);
    sums->tensor[f] = a == b ? lane.sum([=](int i) EULASTIC_BODY { return phi[i] > full_cell ? B[i] : 0; })
                             : lane.sum([=](int i) EULASTIC_BODY {
                                 const double mean = kernels::average4(B + i, sa, sb);
                                 return phi[i] > full_cell ? mean : 0;
                               });
  }
}

}  // namespace

RunPlaces places_of(const Box &box, const Run &run, const Int3 &reference) {
  RunPlaces places;
  const Real3 begin = offset(box, reference, {run.begin, run.j, run.k});
  for (int i = 0; i < run.size(); ++i) places.x[i] = offset(box, 0, reference[0], run.begin + i);
  places.y = begin[1];
  places.z = begin[2];
  return places;
}

RunSums sum_positions(const Box &box, const Run &run, const RunPlaces &places) {
  RunSums sums;
  add_up(box, run, places, nullptr, &sums);
  return sums;
}

RunSums sum_all(const Box &box, const Run &run, const RunPlaces &places, const Field &velocity) {
  RunSums sums;
  add_up(box, run, places, &velocity, &sums);
  return sums;
}

}  // namespace eulastic
