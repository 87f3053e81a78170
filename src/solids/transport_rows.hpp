// Transport of B through rows, (5): WENO5 and stretching at the points of active segments. Templates of
// transport_2d.cpp and transport_3d.cpp, which are compiled side by side.
#pragma once

#include "grid/blocks.hpp"
#include "kernels/upper_convected.hpp"
#include "kernels/weno5.hpp"
#include "solids/transport.hpp"

#include <algorithm>
#include <limits>
#include <type_traits>

namespace eulastic::transport {

inline constexpr double epsilon = 1e-6;  // WENO5: B is of order 1

struct TransportTerms {
  const Box *box;
  double dt;
  const Field *velocity;
  Real3 inverse;
  EvolveRule rule;
  bool second_of_heun;
  const ActiveSegments *stale;
  bool whole_rows;  ///< evolves all points of the segments, also those outside of bodies
};

// Solid fraction at the points of component (a, b): phi itself or its mean over four centres.
EULASTIC_INLINE double fraction_at(const double *phi, bool diagonal, std::ptrdiff_t a, std::ptrdiff_t b) {
  return diagonal ? *phi : kernels::average4(phi, -a, -b);
}

// Block position of component (x, y).
template <int Dim>
constexpr int position(int x, int y) {
  return x == y ? x : Dim == 2 ? 2 : 6 - x - y;
}

// One component at the points of a batch: advection, then stretching and the stage. One loop for both would need more
// registers than there are: a fifth slower.
template <int Dim, class Viscosity>
EULASTIC_INLINE void advance_component(const TransportTerms &t, const Viscosity &viscosity, const Phase &phase,
                                       const Field &B, int a, int b, kernels::Batch &batch,
                                       const double *const *carried, double *rate, Field &out) {
  const int f = position<Dim>(a, b);
  const int other = a == b ? (a + 1) % Dim : b;        // second direction
  const int third = Dim == 3 ? 3 - a - other : other;  // and the remaining one
  const ConstView phi = phase.fraction[0];
  const kernels::Directions d{phi.stride(a), phi.stride(other), phi.stride(third),
                              t.inverse[a],  t.inverse[other],  t.inverse[third]};
  const double *va = (*t.velocity)[a].origin, *vb = (*t.velocity)[other].origin, *vc = (*t.velocity)[third].origin;
  const double *solid = phi.origin;
  const double *aa = B[a].origin, *bb = B[b].origin, *now = B[f].origin, *ab = B[position<Dim>(a, other)].origin;
  const double *bc = B[position<Dim>(b, third)].origin, *ac = B[position<Dim>(a, third)].origin;
  const double threshold = a == b ? t.rule.centre : t.rule.edge, dt = t.dt;
  double *next = out[f].origin;
  if (Dim == 3) {  // the next plane
    batch.ahead[0] = now + (1 + Box::stencil_width) * phi.sz;
    batch.ahead[1] = next + phi.sz;
  }
  kernels::advection_rate<Dim>(batch, B[f], carried, t.inverse.data(), epsilon, rate);
  batch.ahead[0] = Dim == 3 && f == 0 ? solid + phi.sz : nullptr;
  batch.ahead[1] = nullptr;
  const auto stage = [=](auto second_of_heun, std::ptrdiff_t o, double total, double share, double exterior,
                         double least) EULASTIC_BODY {
    // positive_definite.hpp; minus infinity stays, so that it is noticed.
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
  // Loops of their own: the choice inside of one costs a quarter of its time.
  if (t.second_of_heun)
    loop(std::true_type());
  else
    loop(std::false_type());
}

// A location: all diagonal components live at centres (a = b), the off-diagonal one of a and b on edges.
struct Location {
  int a, b;
  bool at[3];  // staggered

  Location(int x, int y) : a(x), b(y) {
    for (int d = 0; d < 3; ++d) at[d] = a != b && (d == a || d == b);
  }
  bool centre() const { return a == b; }
  template <int Dim>
  int first() const {  // of the components
    return centre() ? 0 : position<Dim>(a, b);
  }
  template <int Dim>
  int last() const {
    return centre() ? Dim : first<Dim>() + 1;
  }
};

// All components of one location at the points of a batch.
template <int Dim, class Viscosity>
EULASTIC_INLINE void advance_batch(const TransportTerms &t, const Viscosity &viscosity, const Phase &phase,
                                   const Field &B, const Location &location, kernels::Batch &batch, Field &out) {
  alignas(64) double rate[kernels::Batch::points], velocity[Dim][kernels::Batch::points];
  const double *carried[3] = {velocity[0], velocity[1], velocity[Dim - 1]};
  for (int e = 0; e < Dim; ++e) {
    const ConstView face = (*t.velocity)[e];
    if (Dim == 3 && location.centre()) batch.ahead[0] = face.origin + 2 * face.sz;
    kernels::carry_velocity(batch, face, e, location.at, Dim, velocity[e]);
  }
  if (location.centre())
    for (int c = 0; c < Dim; ++c) advance_component<Dim>(t, viscosity, phase, B, c, c, batch, carried, rate, out);
  else
    advance_component<Dim>(t, viscosity, phase, B, location.a, location.b, batch, carried, rate, out);
}

// The components of one location on rows of plane k, but for the vectors that are `left` for later. Adds the points
// that evolve to `evolved`.
template <int Dim, class Viscosity>
EULASTIC_INLINE void advance_rows(const TransportTerms &t, const Viscosity &viscosity, const Phase &phase,
                                  const Field &B, const Location &location, int j_begin, int j_end, int k, Field &out,
                                  kernels::Batch &left, std::ptrdiff_t &evolved) {
  constexpr int reach = Box::stencil_width;
  const int a = location.a, b = location.b;
  const bool centre = location.centre();
  const bool(&at)[3] = location.at;
  const ConstView phi = phase.fraction[0];
  const int end = t.box->points_end(0, at[0]);
  const int first = location.first<Dim>(), last = location.last<Dim>();
  const std::ptrdiff_t da = phi.stride(a), db = phi.stride(b);
  const double threshold = centre ? t.rule.centre : t.rule.edge;
  const auto advance = [&](kernels::Batch &batch)
                           EULASTIC_BODY { advance_batch<Dim>(t, viscosity, phase, B, location, batch, out); };
  if (k >= t.box->points_end(2, at[2])) return;
  if (t.stale && t.stale->idle_rows(j_begin, j_end, k) && phase.tensor.evolving.idle_rows(j_begin, j_end, k)) return;
  for (int j = j_begin; j < std::min(j_end, t.box->points_end(1, at[1])); ++j) {
    int done = 0;  // so far
    const auto set_exterior = [&](int begin, int stop) {
      for (int f = first; f < last; ++f) {
        double *next = out[f].row(j, k);
        for (int i = begin; i < stop; ++i) next[i] = centre ? 1.0 : 0.0;
      }
    };
    const auto leave_to = [&](int stop) {  // from `done` on nothing evolves
      if (!t.stale) return set_exterior(done, stop);
      for (const Segment &old : t.stale->row(j, k))
        set_exterior(std::max(done, old.i_begin), std::min(stop, old.i_end));
    };
    const std::ptrdiff_t row = j * phi.sy + k * phi.sz;
    // Whether any point of a vector does: segments are those of all locations together.
    const auto evolves = [&](std::ptrdiff_t at_first, int count) EULASTIC_BODY {
      if (t.whole_rows || phi.origin[at_first] > 0.5) return true;  // all points within bodies evolve
      bool any = false;
#pragma omp simd reduction(| : any)
      for (int i = 0; i < count; ++i) any |= fraction_at(phi.origin + at_first + i, centre, da, db) >= threshold;
      return any;
    };
    for (const Segment &s : phase.tensor.evolving.row(j, k)) {
      if (Dim == 3) {  // the next plane, what is beside its vectors
        const int i = s.i_begin - reach, length = s.size() + 2 * reach + 7;  // up to its last cache line
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
      leave_to(s.i_begin);
      const int stop = std::min(s.i_end, end);
      for (int i = s.i_begin; i < stop; i = done) {
        done = std::min(i + kernels::Batch::width, stop);
        if (evolves(row + i, done - i)) {
          evolved += done - i;
          kernels::gather(left, row, i, done, advance);
        } else {
          set_exterior(i, done);
        }
      }
    }
    leave_to(end);
  }
}

struct Evolved {
  std::ptrdiff_t centres = 0, edges = 0;  // points, each of all its components
};

template <int Dim, class Viscosity>
EULASTIC_INLINE Evolved advance_tensor(const TransportTerms &t, const Viscosity &viscosity, const RowPart &part,
                                       const Phase &phase, const Field &B, Field &out) {
  constexpr int block = block_rows, count = Dim == 3 ? 4 : 2;
  const Location locations[4] = {{0, 0}, {0, 1}, {0, Dim - 1}, {1, Dim - 1}};
  kernels::Batch left[count];  // filled through all planes
  Evolved sum;
  const Int3 &n = t.box->cells();  // rows at high walls belong to the last part
  const int j_end = part.j_end == n[1] ? phase.tensor.evolving.rows_y() : part.j_end;
  const int k_end = part.k_end == n[2] ? phase.tensor.evolving.rows_z() : part.k_end;
  for (int j = part.j_begin; j < j_end; j += block)
    for (int k = part.k_begin; k < k_end; ++k)
      for (int l = 0; l < count; ++l)
        advance_rows<Dim>(t, viscosity, phase, B, locations[l], j, std::min(j + block, j_end), k, out, left[l],
                          l == 0 ? sum.centres : sum.edges);
  for (int l = 0; l < count; ++l) advance_batch<Dim>(t, viscosity, phase, B, locations[l], left[l], out);
  return sum;
}

/// Advances the tensor in the rows of `part`; returns how many points were advanced.
Evolved advance_tensor_2d(const TransportTerms &t, const RowPart &part, const Phase &phase, const Field &B, Field &out);
Evolved advance_tensor_3d(const TransportTerms &t, const RowPart &part, const Phase &phase, const Field &B, Field &out);

}  // namespace eulastic::transport
