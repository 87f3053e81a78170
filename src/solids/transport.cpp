#include "solids/transport.hpp"

#include "base/events.hpp"
#include "grid/blocks.hpp"
#include "grid/occupied_rows.hpp"
#include "kernels/tensor.hpp"
#include "kernels/upper_convected.hpp"
#include "kernels/weno5.hpp"

#include <algorithm>
#include <limits>
#include <type_traits>

namespace eulastic {
namespace {

constexpr double epsilon = 1e-6;  // WENO5: B is of order 1

struct TransportTerms {
  const Box *box;
  double dt;
  const Field *velocity;
  Real3 inverse;
  EvolveRule rule;
  bool second_of_heun;
  const ActiveSegments *stale;
  bool whole_rows;  ///< every point of the segments is advanced, also outside bodies; for tests
};

// Solid fraction at the points of component (a, b): phi itself, or its mean over four centres.
EULASTIC_INLINE double fraction_at(const double *phi, bool diagonal, std::ptrdiff_t a, std::ptrdiff_t b) {
  return diagonal ? *phi : kernels::average4(phi, -a, -b);
}

// Advances one component at the points of a batch: advection, then stretching and the stage. These are two loops
// because a single one would exceed the number of registers.
template <int Dim, class Viscosity>
EULASTIC_INLINE void advance_component(const TransportTerms &t, const Viscosity &viscosity, const Phase &phase,
                                       const Field &B, int a, int b, kernels::Batch &batch,
                                       const double *const *carried, double *rate, Field &out) {
  const int f = kernels::position<Dim>(a, b);
  const int other = a == b ? (a + 1) % Dim : b;        // second direction
  const int third = Dim == 3 ? 3 - a - other : other;  // the remaining one
  const ConstView phi = phase.fraction[0];
  const kernels::Directions d{phi.stride(a), phi.stride(other), phi.stride(third),
                              t.inverse[a],  t.inverse[other],  t.inverse[third]};
  const double *va = (*t.velocity)[a].origin, *vb = (*t.velocity)[other].origin, *vc = (*t.velocity)[third].origin;
  const double *solid = phi.origin;
  const double *aa = B[a].origin, *bb = B[b].origin, *now = B[f].origin,
               *ab = B[kernels::position<Dim>(a, other)].origin;
  const double *bc = B[kernels::position<Dim>(b, third)].origin, *ac = B[kernels::position<Dim>(a, third)].origin;
  const double threshold = a == b ? t.rule.centre : t.rule.edge, dt = t.dt;
  double *next = out[f].origin;
  if (Dim == 3) {  // prefetch the next plane
    batch.ahead[0] = now + (1 + Box::stencil_width) * phi.sz;
    batch.ahead[1] = next + phi.sz;
  }
  kernels::advection_rate<Dim>(batch, B[f], carried, t.inverse.data(), epsilon, rate);
  batch.ahead[0] = Dim == 3 && f == 0 ? solid + phi.sz : nullptr;
  batch.ahead[1] = nullptr;
  const auto stage = [=](auto second_of_heun, std::ptrdiff_t o, double total, double share, double exterior,
                         double least) EULASTIC_BODY {
    // Keeps B positive (positive_definite.hpp), but keeps minus infinity visible.
    constexpr double lowest = -std::numeric_limits<double>::max();
    double moved = kernels::fma(dt, total, now[o]);
    if constexpr (second_of_heun()) moved = 0.5 * (next[o] + moved);
    next[o] = share < threshold ? exterior : moved < least && moved >= lowest ? least : moved;
  };
  const auto shear = [=](std::ptrdiff_t o)
                         EULASTIC_BODY { return viscosity.template shear<Dim>(va + o, vb + o, vc + o, solid + o); };
  const auto loop = [&](auto second_of_heun) EULASTIC_BODY {
    if (a == b)
      kernels::for_points(batch, phi, [=](std::ptrdiff_t o, int i) EULASTIC_BODY {
        const double half = kernels::half_diagonal_stretch<Dim>(aa + o, ab + o, ac + o, shear(o), d);
        stage(second_of_heun, o, kernels::fma(2, half, rate[i]), solid[o], 1, 0);
      });
    else
      kernels::for_points(batch, phi, [=](std::ptrdiff_t o, int i) EULASTIC_BODY {
        const double rise = kernels::shear_stretch<Dim>(aa + o, bb + o, ab + o, bc + o, ac + o, shear(o), d);
        stage(second_of_heun, o, rate[i] + rise, kernels::average4(solid + o, -d.a, -d.b), 0,
              -std::numeric_limits<double>::max());
      });
  };
  // The choice is outside the loops; inside one it would cost a quarter of its time.
  if (t.second_of_heun)
    loop(std::true_type());
  else
    loop(std::false_type());
}

// Advances all components of one location at the points of a batch.
template <int Dim, class Viscosity>
EULASTIC_INLINE void advance_batch(const TransportTerms &t, const Viscosity &viscosity, const Phase &phase,
                                   const Field &B, const TensorComponent &location, kernels::Batch &batch, Field &out) {
  alignas(64) double rate[kernels::Batch::points], velocity[Dim][kernels::Batch::points];
  const double *carried[3] = {velocity[0], velocity[1], velocity[Dim - 1]};
  for (int e = 0; e < Dim; ++e) {
    const ConstView face = (*t.velocity)[e];
    if (Dim == 3 && !location.on_edge()) batch.ahead[0] = face.origin + 2 * face.sz;
    kernels::average_velocity(batch, face, e, location.at.data(), Dim, velocity[e]);
  }
  if (location.on_edge())
    advance_component<Dim>(t, viscosity, phase, B, location.a, location.b, batch, carried, rate, out);
  else
    for (int c = 0; c < Dim; ++c) advance_component<Dim>(t, viscosity, phase, B, c, c, batch, carried, rate, out);
}

// Advances the components of one location on rows of plane k; points that do not fill a batch remain in `pending`. Adds
// the number of evolving points to `evolved`.
template <int Dim, class Viscosity>
EULASTIC_INLINE void advance_rows(const TransportTerms &t, const Viscosity &viscosity, const Phase &phase,
                                  const Field &B, const TensorComponent &location, int j_begin, int j_end, int k,
                                  Field &out, kernels::Batch &pending, std::ptrdiff_t &evolved) {
  constexpr int reach = Box::stencil_width;
  const auto [a, b, at] = location;
  const bool centre = !location.on_edge();
  const ConstView phi = phase.fraction[0];
  const int end = t.box->points_end(0, at[0]);
  const int first = centre ? 0 : kernels::position<Dim>(a, b), last = centre ? Dim : first + 1;  // components
  const std::ptrdiff_t da = phi.stride(a), db = phi.stride(b);
  const double threshold = centre ? t.rule.centre : t.rule.edge;
  const auto advance = [&](kernels::Batch &batch)
                           EULASTIC_BODY { advance_batch<Dim>(t, viscosity, phase, B, location, batch, out); };
  if (k >= t.box->points_end(2, at[2])) return;
  if (t.stale && t.stale->idle_rows(j_begin, j_end, k) && phase.tensor.evolving.idle_rows(j_begin, j_end, k)) return;
  for (int j = j_begin; j < std::min(j_end, t.box->points_end(1, at[1])); ++j) {
    int done = 0;  // points before this one are complete
    const auto set_exterior = [&](int begin, int stop) {
      for (int f = first; f < last; ++f) {
        double *next = out[f].row(j, k);
        for (int i = begin; i < stop; ++i) next[i] = centre ? 1.0 : 0.0;
      }
    };
    const auto skip_to = [&](int stop) {  // no point from `done` to `stop` evolves
      if (!t.stale) return set_exterior(done, stop);
      for (const Segment &old : t.stale->row(j, k))
        set_exterior(std::max(done, old.i_begin), std::min(stop, old.i_end));
    };
    const std::ptrdiff_t row = j * phi.sy + k * phi.sz;
    // Whether any point of a vector evolves; segments cover all locations together.
    const auto evolves = [&](std::ptrdiff_t at_first, int count) EULASTIC_BODY {
      if (t.whole_rows || phi.origin[at_first] > 0.5) return true;  // all points within bodies evolve
      bool any = false;
#pragma omp simd reduction(| : any)
      for (int i = 0; i < count; ++i) any |= fraction_at(phi.origin + at_first + i, centre, da, db) >= threshold;
      return any;
    };
    for (const Segment &s : phase.tensor.evolving.row(j, k)) {
      if (Dim == 3) {  // prefetch the parts of the next plane beside the vectors
        const int i = s.i_begin - reach, length = s.size() + 2 * reach + 7;  // up to the last cache line
        const auto prefetch_ends = [&](ConstView q, int plane) {
          prefetch(q.row(j, plane) + i, 1);
          prefetch(q.row(j, plane) + s.i_end, 1);
        };
        for (int f = first; f < last; ++f) prefetch_ends(B[f], k + 1 + reach);
        if (centre) {
          prefetch_ends(phi, k + 1);
          for (int d = 0; d < Dim; ++d) prefetch_ends((*t.velocity)[d], k + 2);
        }
        for (const int side : {-1, 1})
          for (int n = 1; phase.tensor.evolving.idle(j + side, k) && n <= reach; ++n)
            for (int f = first; f < last; ++f) prefetch(B[f].row(j + n * side, k + 1 + reach) + i, length);
      }
      skip_to(s.i_begin);
      const int stop = std::min(s.i_end, end);
      for (int i = s.i_begin; i < stop; i = done) {
        done = std::min(i + kernels::Batch::width, stop);
        if (evolves(row + i, done - i)) {
          evolved += done - i;
          kernels::gather(pending, row, i, done, advance);
        } else {
          set_exterior(i, done);
        }
      }
    }
    skip_to(end);
  }
}

struct Evolved {
  std::ptrdiff_t centres = 0, edges = 0;  // points that evolve, each with all its components
};

template <int Dim, class Viscosity>
EULASTIC_INLINE Evolved advance_tensor(const TransportTerms &t, const Viscosity &viscosity, const RowPart &part,
                                       const Phase &phase, const Field &B, Field &out) {
  constexpr int block = block_rows, count = Dim == 3 ? 4 : 2;
  const std::vector<TensorComponent> locations = tensor_locations(Dim);
  kernels::Batch pending[count];  // filled across all planes
  Evolved sum;
  const Int3 &n = t.box->cells();  // rows at high boundaries belong to the last part
  const int j_end = part.j_end == n[1] ? phase.tensor.evolving.rows_y() : part.j_end;
  const int k_end = part.k_end == n[2] ? phase.tensor.evolving.rows_z() : part.k_end;
  for (int j = part.j_begin; j < j_end; j += block)
    for (int k = part.k_begin; k < k_end; ++k)
      for (int l = 0; l < count; ++l)
        advance_rows<Dim>(t, viscosity, phase, B, locations[l], j, std::min(j + block, j_end), k, out, pending[l],
                          l == 0 ? sum.centres : sum.edges);
  for (int l = 0; l < count; ++l) advance_batch<Dim>(t, viscosity, phase, B, locations[l], pending[l], out);
  return sum;
}

// One function for each viscosity, because the compiler keeps too little in registers if both are in one.
EULASTIC_CLONES Evolved with_same_viscosity_2d(const TransportTerms &t, const RowPart &part, const Phase &phase,
                                               const Field &B, Field &out) {
  return advance_tensor<2>(t, kernels::SameViscosity{}, part, phase, B, out);
}
EULASTIC_CLONES Evolved with_own_viscosity_2d(const TransportTerms &t, const RowPart &part, const Phase &phase,
                                              const Field &B, Field &out) {
  return advance_tensor<2>(t, kernels::SolidViscosity{phase.tensor.rule.viscosity_excess}, part, phase, B, out);
}
EULASTIC_CLONES Evolved with_same_viscosity_3d(const TransportTerms &t, const RowPart &part, const Phase &phase,
                                               const Field &B, Field &out) {
  return advance_tensor<3>(t, kernels::SameViscosity{}, part, phase, B, out);
}
EULASTIC_CLONES Evolved with_own_viscosity_3d(const TransportTerms &t, const RowPart &part, const Phase &phase,
                                              const Field &B, Field &out) {
  return advance_tensor<3>(t, kernels::SolidViscosity{phase.tensor.rule.viscosity_excess}, part, phase, B, out);
}

}  // namespace

PetscErrorCode transport_tensor(const Box &box, const TensorStage &stage, const Field &velocity, const Phase &phase,
                                const Field &tensor, Field &next) {
  PetscFunctionBeginUser;
  EventScope scope(Event::left_cauchy_green);
  const Real3 &h = box.spacing();
  const TransportTerms terms{
      &box,        stage.dt,       &velocity, {1 / h[0], 1 / h[1], 1 / h[2]}, phase.tensor.rule, stage.second_of_heun,
      stage.stale, skips_nothing()};
  const bool flat = box.dimension() == 2, own = phase.tensor.rule.viscosity_excess != 0;
  const auto advance = flat  ? own ? with_own_viscosity_2d : with_same_viscosity_2d
                       : own ? with_own_viscosity_3d
                             : with_same_viscosity_3d;
  const int parts = row_parts(box);
  std::vector<Evolved> found(parts);
  in_parallel(parts, parts,
              [&](int part) { found[part] = advance(terms, row_part(box, part, parts), phase, tensor, next); });
  Evolved points;
  for (const Evolved &part : found) points = {points.centres + part.centres, points.edges + part.edges};
  const double advection = box.dimension() * (kernels::weno5_flops + 5) + 2;
  const double diagonal = flat ? kernels::stretch_diagonal_flops_2d : kernels::stretch_diagonal_flops_3d;
  const double shear = flat ? kernels::stretch_shear_flops_2d : kernels::stretch_shear_flops_3d;
  scope.flops(double(points.centres) * box.dimension() * (advection + diagonal) +
              double(points.edges) * (advection + shear));
  PetscFunctionReturn(0);
}

PetscErrorCode reset_exterior(const Box &box, const OccupiedRows &before, Phase &phase) {
  PetscFunctionBeginUser;
  const ConstView phi = phase.fraction[0];
  const EvolveRule &rule = phase.tensor.rule;
  for (int f = 0; f < phase.tensor.field.count(); ++f) {
    const TensorComponent &c = phase.tensor.components()[f];
    const auto [a, b, at] = c;
    const View B = phase.tensor.field[f];
    for (int k = 0; k < box.points_end(2, at[2]); ++k)
      for (int j = 0; j < box.points_end(1, at[1]); ++j) {
        if (before.idle(j, k) && phase.rows.idle(j, k)) continue;
        for (int i = 0; i < box.points_end(0, at[0]); ++i)
          if (fraction_at(phi.row(j, k) + i, a == b, phi.stride(a), phi.stride(b)) < (a == b ? rule.centre : rule.edge))
            if (B(i, j, k) != c.rest()) B(i, j, k) = c.rest();  // do not touch unused memory (Field::on_demand)
      }
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
