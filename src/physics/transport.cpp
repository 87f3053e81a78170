#include "physics/transport.hpp"

#include "base/events.hpp"
#include "kernels/upper_convected.hpp"
#include "kernels/weno5.hpp"
#include "physics/row_scratch.hpp"

#include <algorithm>
#include <limits>

namespace eulastic {
namespace {

constexpr double epsilon = 1e-6;  // WENO5: phi and B are of order 1

struct TransportTerms {
  const Grid *grid;
  double dt;
  const FieldBlock *velocity;
  Real3 inverse;
  EvolveRule rule{};
  bool second_of_heun = false;
  const ActiveSegments *stale = nullptr;
};

template <int Dim>
EULASTIC_INLINE void advect_rows(const TransportTerms &t, const FieldBlock &phi, FieldBlock &out, RowScratch &scratch) {
  const Int3 n = t.grid->owned();
  double *rate = scratch.row(0);
  double *carried[3] = {scratch.row(1), scratch.row(2), scratch.row(3)};
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j) {
      const Segment row{0, n[0], j, k};
  const int other = a == b ? (a + 1) % Dim : b;        // second direction
  const int third = Dim == 3 ? 3 - a - other : other;  // and the remaining one
  const kernels::Directions d{phi.stride(a), phi.stride(other), phi.stride(third),
                              t.inverse[a],  t.inverse[other],  t.inverse[third]};
  kernels::advection_rate<Dim>(s, B[f], carried, t.inverse.data(), epsilon, rate);
      const double *now = phi[0].row(j, k);
      double *next = out[0].row(j, k);
#pragma omp simd
      for (int i = 0; i < n[0]; ++i) next[i] = kernels::fma(t.dt, rate[i], now[i]);
    }
}

EULASTIC_CLONES void advect_2d(const TransportTerms &t, const FieldBlock &phi, FieldBlock &out, RowScratch &s) {
  advect_rows<2>(t, phi, out, s);
}
EULASTIC_CLONES void advect_3d(const TransportTerms &t, const FieldBlock &phi, FieldBlock &out, RowScratch &s) {
  advect_rows<3>(t, phi, out, s);
}

// Solid fraction at the points of component (a, b): phi itself or its mean over four centres.
EULASTIC_INLINE double fraction_at(const double *phi, bool diagonal, std::ptrdiff_t a, std::ptrdiff_t b) {
  return diagonal ? *phi : kernels::average4(phi, -a, -b);
}

// Block position of component (x, y).
template <int Dim>
constexpr int position(int x, int y) {
  return x == y ? x : Dim == 2 ? 2 : 6 - x - y;
}

// One component on one segment: rate, then the stage.
template <int Dim>
EULASTIC_INLINE void tensor_segment(const TransportTerms &t, const Phase &phase, const FieldBlock &B, int a, int b,
                                    const Segment &s, double *const *carried, FieldBlock &out, double *rate) {
  const FieldBlock &v = *t.velocity;
  const ConstView phi = phase.fraction[0];
  const int f = position<Dim>(a, b);
<<<<<<< HEAD
  const int other = a == b ? (a + 1) % Dim : b;        // second direction
  const int third = Dim == 3 ? 3 - a - other : other;  // and the remaining one
  const kernels::Directions d{phi.stride(a), phi.stride(other), phi.stride(third),
                              t.inverse[a],  t.inverse[other],  t.inverse[third]};
  for (int i = s.i_begin; i < s.i_end; ++i) rate[i] = 0;
  kernels::subtract_advection<Dim>(s, B[f], carried, t.inverse.data(), epsilon, rate);
=======
  const int other = a == b ? (a + 1) % Dim : b;                        // second direction
  const int third = Dim == 3 ? 3 - a - other : other;                  // and the remaining one
  const kernels::Directions d{phi.stride(a), phi.stride(other),  phi.stride(third),
                              t.inverse[a],  t.inverse[other], t.inverse[third]};
  kernels::advection_rate<Dim>(s, B[f], carried, t.inverse.data(), epsilon, rate);
>>>>>>> a26b9a2 (WENO5 in 56 flops, segments in whole vectors, huge pages, B outside bodies written only where it is stale, velocity corrected in place; effect on results: round-off)
  if (a == b)
    kernels::add_diagonal_stretch<Dim>(s, B[f], B[position<Dim>(a, other)], B[position<Dim>(a, third)], v[a], d, rate);
  else
    kernels::add_shear_stretch<Dim>(s, B[a], B[b], B[f], B[position<Dim>(b, third)], B[position<Dim>(a, third)], v[a],
                                    v[b], d, rate);
  const double exterior = a == b ? 1.0 : 0.0, threshold = a == b ? t.rule.centre : t.rule.edge;
  // positive_definite.hpp; minus infinity stays, so that it is noticed.
  constexpr double lowest = -std::numeric_limits<double>::max();
  const double least = a == b ? 0 : lowest;
  const double *now = B[f].row(s.j, s.k), *solid = phi.row(s.j, s.k);
  double *next = out[f].row(s.j, s.k);
  if (t.second_of_heun) {
#pragma omp simd
    for (int i = s.i_begin; i < s.i_end; ++i) {
      const double moved = 0.5 * (next[i] + kernels::fma(t.dt, rate[i], now[i]));
      next[i] = fraction_at(solid + i, a == b, d.a, d.b) < threshold ? exterior
                : moved < least && moved >= lowest                   ? least
                                                                     : moved;
    }
  } else {
#pragma omp simd
    for (int i = s.i_begin; i < s.i_end; ++i) {
      const double moved = kernels::fma(t.dt, rate[i], now[i]);
      next[i] = fraction_at(solid + i, a == b, d.a, d.b) < threshold ? exterior
                : moved < least && moved >= lowest                   ? least
                                                                     : moved;
    }
  }
}

// The components that live at one location (all diagonal ones, or one off-diagonal) on row (j, k).
template <int Dim>
EULASTIC_INLINE void tensor_row(const TransportTerms &t, const Phase &phase, const FieldBlock &B, int a, int b, int j,
                                int k, FieldBlock &out, RowScratch &scratch) {
  const bool centre = a == b;
  const bool at[3] = {!centre && (a == 0 || b == 0), !centre && (a == 1 || b == 1), !centre && (a == 2 || b == 2)};
  if (j >= t.grid->points_end(1, at[1]) || k >= t.grid->points_end(2, at[2])) return;
  const int end = t.grid->points_end(0, at[0]);
  const int first = centre ? 0 : position<Dim>(a, b), last = centre ? Dim : first + 1;
  double *carried[3] = {scratch.row(1), scratch.row(2), scratch.row(3)};
  int done = 0;
  const auto set_exterior = [&](int begin, int stop) {
    for (int f = first; f < last; ++f) {
      double *next = out[f].row(j, k);
      for (int i = begin; i < stop; ++i) next[i] = centre ? 1.0 : 0.0;
    }
  };
  const auto leave_to = [&](int stop) {  // from `done` on nothing evolves
    if (!t.stale) return set_exterior(done, stop);
    for (const Segment &old : t.stale->row(j, k)) set_exterior(std::max(done, old.i_begin), std::min(stop, old.i_end));
  };
  for (const Segment &segment : phase.solid.row(j, k)) {
    const Segment s{segment.i_begin, segment.i_end < end ? segment.i_end : end, j, k};
    if (s.i_begin >= s.i_end) continue;
    leave_to(s.i_begin);
    for (int e = 0; e < Dim; ++e) kernels::carry_velocity(s, (*t.velocity)[e], e, at, Dim, carried[e]);
    if (centre)
      for (int c = 0; c < Dim; ++c) tensor_segment<Dim>(t, phase, B, c, c, s, carried, out, scratch.row(0));
    else
      tensor_segment<Dim>(t, phase, B, a, b, s, carried, out, scratch.row(0));
    done = s.i_end;
  }
  leave_to(end);
}

template <int Dim>
EULASTIC_INLINE void tensor_rows(const TransportTerms &t, const Phase &phase, const FieldBlock &B, FieldBlock &out,
                                 RowScratch &scratch) {
  for (int k = 0; k < phase.solid.rows_z(); ++k)
    for (int j = 0; j < phase.solid.rows_y(); ++j) {
      tensor_row<Dim>(t, phase, B, 0, 0, j, k, out, scratch);
      for (int a = 0; a < Dim; ++a)
        for (int b = a + 1; b < Dim; ++b) tensor_row<Dim>(t, phase, B, a, b, j, k, out, scratch);
    }
}

EULASTIC_CLONES void tensor_2d(const TransportTerms &t, const Phase &phase, const FieldBlock &B, FieldBlock &out,
                               RowScratch &s) {
  tensor_rows<2>(t, phase, B, out, s);
}
EULASTIC_CLONES void tensor_3d(const TransportTerms &t, const Phase &phase, const FieldBlock &B, FieldBlock &out,
                               RowScratch &s) {
  tensor_rows<3>(t, phase, B, out, s);
}

TransportTerms make_terms(const Grid &grid, double dt, const FieldBlock &velocity) {
  return {&grid, dt, &velocity, {1 / grid.spacing()[0], 1 / grid.spacing()[1], 1 / grid.spacing()[2]}, {}, false};
}

}  // namespace

PetscErrorCode advect_fraction(const Grid &grid, double dt, const FieldBlock &velocity, const FieldBlock &fraction,
                               FieldBlock &next) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::solid_fraction);
  RowScratch scratch(grid, 4);
  const TransportTerms terms = make_terms(grid, dt, velocity);
  if (grid.dimension() == 2)
    advect_2d(terms, fraction, next, scratch);
  else
    advect_3d(terms, fraction, next, scratch);
  scope.flops(grid.owned_count() * (grid.dimension() * (kernels::weno5_flops + 5) + 2));
  PetscFunctionReturn(0);
}

PetscErrorCode find_solid(const Grid &grid, const EvolveRule &rule, Phase &phase) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::solid_fraction);
  phase.solid.build(grid, phase.fraction[0], rule.centre, 1, 0);
  phase.stressed.build(grid, phase.fraction[0], rule.stressed, 2, 2);  // one more: also where it was a step ago
  PetscFunctionReturn(0);
}

PetscErrorCode transport_tensor(const Grid &grid, const TensorStage &stage, const FieldBlock &velocity,
                                const Phase &phase, const FieldBlock &tensor, FieldBlock &next) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::left_cauchy_green);
  RowScratch scratch(grid, 4);
  TransportTerms terms = make_terms(grid, stage.dt, velocity);
  terms.rule = stage.rule;
  terms.second_of_heun = stage.second_of_heun;
  terms.stale = stage.stale;
  if (grid.dimension() == 2) {
    tensor_2d(terms, phase, tensor, next, scratch);
    scope.flops(phase.solid.points() * (3 * (2 * (kernels::weno5_flops + 5) + 2) +
                                        2 * kernels::stretch_diagonal_flops_2d + kernels::stretch_shear_flops_2d));
  } else {
    tensor_3d(terms, phase, tensor, next, scratch);
    scope.flops(phase.solid.points() * (6 * (3 * (kernels::weno5_flops + 5) + 2) +
                                        3 * kernels::stretch_diagonal_flops_3d + 3 * kernels::stretch_shear_flops_3d));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode reset_exterior(const Grid &grid, const EvolveRule &rule, Phase &phase) {
  PetscFunctionBeginUser;
  const ConstView phi = phase.fraction[0];
  const auto &components = tensor_components(grid.dimension());
  for (int f = 0; f < phase.tensor.count(); ++f) {
    const auto [a, b] = components[f];
    const Staggering at = components[f].staggering();
    const View B = phase.tensor[f];
    for (int k = 0; k < grid.points_end(2, at[2]); ++k)
      for (int j = 0; j < grid.points_end(1, at[1]); ++j)
        for (int i = 0; i < grid.points_end(0, at[0]); ++i)
          if (fraction_at(phi.row(j, k) + i, a == b, phi.stride(a), phi.stride(b)) < (a == b ? rule.centre : rule.edge))
            B(i, j, k) = a == b ? 1.0 : 0.0;
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
