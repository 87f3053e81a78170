#include "solids/surface_correction.hpp"

#include "base/events.hpp"
#include "field/law.hpp"
#include "kernels/surface.hpp"
#include "kernels/tensor.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>

namespace eulastic {
namespace {

constexpr double relaxation_per_strain = 3;      // (23), where viscosity damps short waves
constexpr double relaxation_per_passage = 0.01;  // (23), where it does not: while a wave passes a cell
constexpr double least_determinant = 0.75;       // below it, (23) is skipped

// Input of a chunk of points: fields of the phase, measures at centres, and the coefficients of (21) and (23).
struct Terms {
  std::ptrdiff_t stride[3];
  const double *B[6], *phi, *gradient[3], *rate;
  double G, stiffening;
  double mu, excess_viscosity, wave_term;  // 1/k = (mu + excess_viscosity (1 - phi))/G + wave_term/sqrt(G)
  double traction_factor;                  // dt times the factor of k in (22)
  double damped;                           // r of (23)
  double relaxation, least_relaxation;     // (23): a is relaxation times the strain rate, plus least_relaxation

  Terms(const Box &box, const SurfaceStep &step, const Phase &phase, const Field &measured) {
    const int dimension = box.dimension();
    const Layout &layout = box.layout();
    const Real3 &h = box.spacing();
    const double shortest = *std::min_element(h.begin(), h.begin() + dimension), rho = step.fluid.density;
    const double across = std::sqrt(rho * phase.material.shear_modulus) * shortest;
    stride[0] = 1;
    stride[1] = layout.sy;
    stride[2] = layout.sz;
    for (int f = 0; f < phase.tensor.field.count(); ++f) B[f] = phase.tensor.field.data() + f * layout.size;
    for (int d = 0; d < dimension; ++d) gradient[d] = measured.data() + d * layout.size;
    rate = measured.data() + dimension * layout.size;
    phi = phase.fraction.data();
    with_law(phase.material, [&](const auto &law) {
      G = law.shear_modulus();
      stiffening = law.stiffening();
    });
    mu = step.fluid.viscosity;
    excess_viscosity = phase.tensor.rule.viscosity_excess * mu;
    wave_term = 0.0625 * shortest * std::sqrt(rho);
    traction_factor = step.dt * (mu > across ? across / mu : 1);
    damped = mu < across ? mu / across : 1;
    relaxation = relaxation_per_strain * step.dt * damped;
    least_relaxation = relaxation_per_passage * step.dt * (1 - damped) * across / (rho * shortest * shortest);
  }
};

// Points that are processed in one vector loop.
struct Chunk {
  static constexpr int most = 64;
  int count = 0;
  std::ptrdiff_t at[most];
  std::uint64_t evolving[most];  // bit 4 l + n: whether neighbour n of the four at location l evolves
  double has_mean[most];         // 1 if full points are within reach, else 0
  double mean[3][most];          // mean of B over the nearest full points
  double next[3][most];          // corrected B
};

// Returns x if bit n is set, else 0, for any x. It masks the bits of x, because conditional loads are not vectorised.
EULASTIC_INLINE double value_if_bit(std::uint64_t bits, int n, double x) {
  return __builtin_bit_cast(double, __builtin_bit_cast(std::uint64_t, x) & -(bits >> n & 1));
}

// Mean over the evolving ones of four surrounding points, for a component that is not located at the point itself.
EULASTIC_INLINE double mean_of_four(const double *q, std::ptrdiff_t s, std::ptrdiff_t t, std::uint64_t evolving) {
  const double sum = (value_if_bit(evolving, 0, q[0]) + value_if_bit(evolving, 1, q[s])) +
                     (value_if_bit(evolving, 2, q[t]) + value_if_bit(evolving, 3, q[s + t]));
  const double count = (value_if_bit(evolving, 0, 1) + value_if_bit(evolving, 1, 1)) +
                       (value_if_bit(evolving, 2, 1) + value_if_bit(evolving, 3, 1));
  return sum / (count > 0 ? count : 1);
}

// Component (X, Y) at a point of location (A, B), which is a centre if A = B, else an edge of that component.
template <int Dim, int A, int B, int X, int Y>
EULASTIC_INLINE double component_at(const Terms &t, std::ptrdiff_t p, std::uint64_t evolving) {
  constexpr bool at_point[3] = {A != B && (A == 0 || B == 0), A != B && (A == 1 || B == 1),
                                A != B && (A == 2 || B == 2)};
  constexpr bool at_component[3] = {X != Y && (X == 0 || Y == 0), X != Y && (X == 1 || Y == 1),
                                    X != Y && (X == 2 || Y == 2)};
  constexpr int d = at_point[0] != at_component[0] ? 0 : 1, e = at_point[2] != at_component[2] ? 2 : 1;
  constexpr int f = kernels::position<Dim>(X, Y), location = X == Y ? 0 : f - Dim + 1;
  const double *q = t.B[f] + p;
  if constexpr (at_point[0] == at_component[0] && at_point[1] == at_component[1] && at_point[2] == at_component[2])
    return q[0];
  return mean_of_four(q, at_point[d] ? -t.stride[d] : t.stride[d], at_point[e] ? -t.stride[e] : t.stride[e],
                      evolving >> (4 * location));
}

// A value stored at centres, averaged to an edge if A != B.
template <int A, int B>
EULASTIC_INLINE double centred_at(const Terms &t, const double *q) {
  if constexpr (A == B) return q[0];
  return kernels::average4(q, -t.stride[A], -t.stride[B]);
}

// Applies (22), then (23), at all points of a chunk.
template <int Dim, int A, int B>
EULASTIC_INLINE void correct_chunk(const Terms &terms, Chunk *chunk) {
  const Terms t = terms;
  Chunk &c = *chunk;
#pragma omp simd
  for (int n = 0; n < c.count; ++n) {
    const std::ptrdiff_t p = c.at[n];
    const std::uint64_t evolving = c.evolving[n];
    kernels::SymmetricTensor T{
        component_at<Dim, A, B, 0, 0>(t, p, evolving), component_at<Dim, A, B, 1, 1>(t, p, evolving), 1, 0, 0,
        component_at<Dim, A, B, 0, 1>(t, p, evolving)};
    kernels::Direction gradient{centred_at<A, B>(t, t.gradient[0] + p), centred_at<A, B>(t, t.gradient[1] + p), 0};
    if constexpr (Dim == 3) {
      T.zz = component_at<Dim, A, B, 2, 2>(t, p, evolving);
      T.yz = component_at<Dim, A, B, 1, 2>(t, p, evolving);
      T.xz = component_at<Dim, A, B, 0, 2>(t, p, evolving);
      gradient.z = centred_at<A, B>(t, t.gradient[2] + p);
    }
    const double excess = (T.xx - 1) + (T.yy - 1) + (T.zz - 1), G = kernels::fma(t.stiffening, excess, t.G);
    const double missing = 1 - centred_at<A, B>(t, t.phi + p), mu = kernels::fma(t.excess_viscosity, missing, t.mu);
    const double limited = kernels::fma(t.wave_term, __builtin_sqrt(G > 0 ? G : 0), mu), k = G > 0 ? G / limited : 0;
    const kernels::SymmetricTensor corrected =
        kernels::relax_traction(T, kernels::unit(gradient), missing * t.traction_factor * k);
    const double keep = kernels::decay(kernels::fma(t.relaxation, centred_at<A, B>(t, t.rate + p), t.least_relaxation));
    const auto relax = [=](bool is_located, double now, double mean)
                           EULASTIC_BODY { return is_located ? kernels::fma(keep, now, (1 - keep) * mean) : now; };
    const double mean[3] = {c.mean[0][n], A == B ? c.mean[1][n] : 0, A == B && Dim == 3 ? c.mean[2][n] : 0};
    constexpr bool centre = A == B;
    const kernels::SymmetricTensor relaxed{relax(centre, corrected.xx, mean[0]),
                                           relax(centre, corrected.yy, mean[1]),
                                           relax(centre && Dim == 3, corrected.zz, mean[2]),
                                           relax(A == 1 && B == 2, corrected.yz, mean[0]),
                                           relax(A == 0 && B == 2, corrected.xz, mean[0]),
                                           relax(A == 0 && B == 1, corrected.xy, mean[0])};
    const double before = kernels::determinant(corrected), after = kernels::determinant(relaxed);
    const bool relaxes = (c.has_mean[n] != 0) & ((after >= least_determinant) | (after >= before));
    const auto chosen = [=](double yes, double no) EULASTIC_BODY { return relaxes ? yes : no; };
    if constexpr (A == B) {
      const auto positive = [](double next, double now) EULASTIC_BODY { return next > 0 ? next : now; };
      // Components are means, so the tensor need not be positive definite.
      c.next[0][n] = positive(chosen(relaxed.xx, corrected.xx), T.xx);
      c.next[1][n] = positive(chosen(relaxed.yy, corrected.yy), T.yy);
      c.next[2][n] = positive(chosen(relaxed.zz, corrected.zz), T.zz);
    } else {
      c.next[0][n] = A == 1   ? chosen(relaxed.yz, corrected.yz)
                     : B == 2 ? chosen(relaxed.xz, corrected.xz)
                              : chosen(relaxed.xy, corrected.xy);
    }
  }
}

EULASTIC_CLONES void correct_2d(const Terms &terms, int location, Chunk *chunk) {
  location == 0 ? correct_chunk<2, 0, 0>(terms, chunk) : correct_chunk<2, 0, 1>(terms, chunk);
}
EULASTIC_CLONES void correct_3d(const Terms &terms, int location, Chunk *chunk) {
  switch (location) {
    case 0:
      return correct_chunk<3, 0, 0>(terms, chunk);
    case 1:
      return correct_chunk<3, 1, 2>(terms, chunk);
    case 2:
      return correct_chunk<3, 0, 2>(terms, chunk);
    default:
      return correct_chunk<3, 0, 1>(terms, chunk);
  }
}

template <int Fields>
struct Sum {
  double value[Fields] = {};
  int count = 0;
  EULASTIC_INLINE void add(const Sum &other) {
    for (int f = 0; f < Fields; ++f) value[f] += other.value[f];
    count += other.count;
  }
};

// Means of some fields over the nearest full points, extrapolated to a point at the surface.
template <int Fields>
struct FullPoints {
  const unsigned char *kind;
  const double *field[Fields];
  std::ptrdiff_t stride[3];
  double slope;  // by which slopes are multiplied
  static constexpr auto full = SurfaceCorrection::full;

  // Adds `Away` times the minmod slope behind full point o; none if the slope would need points beyond the ghosts.
  template <int Away>
  EULASTIC_INLINE void add_line(std::ptrdiff_t o, std::ptrdiff_t in, Sum<Fields> &one) const {
    if constexpr (Away > 0 && Away + 2 <= SurfaceCorrection::ghosts) {
      if (kind[o + in] != full || kind[o + 2 * in] != full) return;
      for (int f = 0; f < Fields; ++f) {
        const double *q = field[f] + o;
        one.value[f] += Away * slope * kernels::minmod(q[0] - q[in], q[in] - q[2 * in]);
      }
    }
  }
  // The full point that is (X, Y, Z) of these strides away, extrapolated linearly along each direction back to the
  // origin.
  template <int X, int Y, int Z>
  EULASTIC_INLINE Sum<Fields> point(std::ptrdiff_t x, std::ptrdiff_t y, std::ptrdiff_t z) const {
    Sum<Fields> one;
    const std::ptrdiff_t o = X * x + Y * y + Z * z;
    if (kind[o] != full) return one;
    one.count = 1;
    for (int f = 0; f < Fields; ++f) one.value[f] = field[f][o];
    add_line<X>(o, x, one);
    add_line<Y>(o, y, one);
    add_line<Z>(o, z, one);
    return one;
  }
  // Adds pairs of opposite points first, so that a mirrored scene gives mirrored bits.
  template <int X, int Y, int Z>
  EULASTIC_INLINE void add_sides(Sum<Fields> &sum) const {
    const std::ptrdiff_t x = stride[0], y = stride[1], z = stride[2];
    Sum<Fields> all;
    for (int c = 0; c <= (Z > 0); ++c) {
      Sum<Fields> plane;
      for (int b = 0; b <= (Y > 0); ++b) {
        Sum<Fields> row = point<X, Y, Z>(x, b ? -y : y, c ? -z : z);
        if constexpr (X > 0) row.add(point<X, Y, Z>(-x, b ? -y : y, c ? -z : z));
        plane.add(row);
      }
      all.add(plane);
    }
    sum.add(all);
  }
  // Adds all points that are `Steps` steps from face to face away.
  template <int Dim, int Steps, int Y = 0, int Z = 0>
  EULASTIC_INLINE void add_shell(Sum<Fields> &sum) const {
    add_sides<Steps - Y - Z, Y, Z>(sum);
    if constexpr (Y + Z < Steps)
      add_shell<Dim, Steps, Y + 1, Z>(sum);
    else if constexpr (Dim == 3 && Z < Steps)
      add_shell<Dim, Steps, 0, Z + 1>(sum);
  }
  // Computes the mean over the nearest full points, counted in steps from face to face; false if none is within reach.
  template <int Dim, int Steps = 1>
  bool mean(double (*out)[Chunk::most], int slot) const {
    Sum<Fields> sum;
    add_shell<Dim, Steps>(sum);
    if constexpr (Steps < SurfaceCorrection::reach)
      if (sum.count == 0) return mean<Dim, Steps + 1>(out, slot);
    for (int f = 0; f < Fields; ++f) out[f][slot] = sum.count > 0 ? sum.value[f] / sum.count : 0;
    return sum.count > 0;
  }
};

}  // namespace

template <int Dim>
void SurfaceCorrection::correct(const Box &box, const SurfaceStep &step, const Phase &phase, const Field &measured,
                                Piece piece, Location *location) const {
  const Terms terms(box, step, phase, measured);
  const bool centre = !location->on_edge();
  const int own = static_cast<int>(location - locations_.data()), components = centre ? Dim : 1;
  const int first = centre ? 0 : Dim + own - 1;
  std::ptrdiff_t around[4][4] = {};  // offsets of the four surrounding points of each location
  for (std::size_t l = 0; l < locations_.size(); ++l) {
    int n = 1;
    for (int d = 0; d < Dim; ++d) {
      if (location->at[d] == locations_[l].at[d]) continue;
      around[l][n++] = location->at[d] ? -terms.stride[d] : terms.stride[d];
    }
    around[l][3] = around[l][1] + around[l][2];
  }
  FullPoints<Dim> centres{nullptr, {}, {terms.stride[0], terms.stride[1], terms.stride[2]}, terms.damped};
  FullPoints<1> edges{nullptr, {}, {terms.stride[0], terms.stride[1], terms.stride[2]}, terms.damped};
  Chunk chunk;
  std::size_t done = piece.begin;
  const auto work = [&] {
    const int count = chunk.count;
    for (; chunk.count % 8 != 0; ++chunk.count) {  // whole vectors
      chunk.at[chunk.count] = chunk.at[0];
      chunk.evolving[chunk.count] = 0;
    }
    (Dim == 2 ? correct_2d : correct_3d)(terms, own, &chunk);
    for (int n = 0; n < count; ++n)
      for (int f = 0; f < components; ++f) location->next[components * (done + n) + f] = chunk.next[f][n];
    done += std::exchange(chunk.count, 0);
  };
  for (std::size_t n = piece.begin; n < piece.end; ++n) {
    const std::ptrdiff_t p = location->points[n];
    std::uint64_t evolving = 0;
    for (std::size_t l = 0; l < locations_.size(); ++l)
      for (int m = 0; m < 4; ++m)
        evolving |= std::uint64_t(locations_[l].kind[p + around[l][m]] != outside) << (4 * l + m);
    chunk.at[chunk.count] = p;
    chunk.evolving[chunk.count] = evolving;
    const auto compute_mean = [&](auto &inside) {
      inside.kind = location->kind.data() + p;
      for (int f = 0; f < components; ++f) inside.field[f] = terms.B[first + f] + p;
      return inside.template mean<Dim>(chunk.mean, chunk.count);
    };
    chunk.has_mean[chunk.count] = centre ? compute_mean(centres) : compute_mean(edges);
    if (++chunk.count == Chunk::most) work();
  }
  work();
}

PetscErrorCode SurfaceCorrection::apply(const Box &box, const SurfaceStep &step, const Field &velocity, Phase &phase,
                                        Field &work) {
  PetscFunctionBeginUser;
  if (!phase.material.elastic()) PetscFunctionReturn(0);
  EventScope scope(Event::left_cauchy_green);
  const int dimension = box.dimension(), team = row_parts(box);
  if (locations_.empty())
    for (const TensorComponent &c : tensor_locations(dimension)) locations_.push_back({c, {}, {}, {}});
  in_parallel(team, static_cast<int>(locations_.size()) - 1,
              [&](int l) { find_points(box, step.sides, phase, &locations_[l + 1]); });
  find_points(box, step.sides, phase, &locations_[0]);  // depends on the edges
  band_.build_band(box, phase.fraction[0], phase.rows, 1);
  measure_centres(box, velocity, phase.fraction[0], work);
  in_parallel(team, team, [&](int part) {
    for (Location &location : locations_) {
      const Piece piece(location.points.size(), part, team);
      (this->*(dimension == 2 ? &SurfaceCorrection::correct<2> : &SurfaceCorrection::correct<3>))(
          box, step, phase, work, piece, &location);
    }
  });
  const std::ptrdiff_t size = box.layout().size;
  int first = 0;
  for (const Location &location : locations_) {
    const int fields = location.on_edge() ? 1 : dimension;
    const double *next = location.next.data();
    double *B = phase.tensor.field.data() + first * size;
    for (const PetscInt p : location.points)
      for (int f = 0; f < fields; ++f) B[f * size + p] = *next++;
    first += fields;
    scope.flops(double(location.points.size()) *
                (dimension == 2 ? kernels::surface_flops_2d : kernels::surface_flops_3d));
  }
  scope.flops(band_.points() * (dimension == 2 ? kernels::gradient_flops_2d : kernels::gradient_flops_3d));
  PetscFunctionReturn(0);
}

// Classification of points (full, surface, outside) and measures at the centres around them.

namespace {

constexpr EvolveRule evolves = evolve_above_half, is_full = evolve_where_full;

// The kind of a point from whether it is full and whether it evolves.
EULASTIC_INLINE unsigned char kind_of(bool is_full_point, bool evolving) {
  return is_full_point ? SurfaceCorrection::full : evolving ? SurfaceCorrection::surface : SurfaceCorrection::outside;
}

EULASTIC_CLONES void flag_edges(int n, const double *phi, std::ptrdiff_t a, std::ptrdiff_t b, unsigned char *row) {
#pragma omp simd
  for (int i = 0; i < n; ++i) {
    const double share = kernels::average4(phi + i, -a, -b);
    row[i] = kind_of(share >= is_full.edge, share >= evolves.edge);
  }
}

// Kinds of the edges of one component around a row of centres, and the strides of the two directions in which they are
// staggered. A centre is full only if all edges around it are.
struct Edges {
  const unsigned char *row;
  std::ptrdiff_t a, b;
};
EULASTIC_CLONES void flag_centres(int n, const double *phi, const Edges *edges, int locations, unsigned char *row) {
#pragma omp simd
  for (int i = 0; i < n; ++i) row[i] = kind_of(phi[i] >= is_full.centre, phi[i] >= evolves.centre);
  for (int l = 0; l < locations; ++l) {
    const unsigned char *e = edges[l].row;
    const std::ptrdiff_t a = edges[l].a, b = edges[l].b;
#pragma omp simd
    for (int i = 0; i < n; ++i) {
      static_assert(SurfaceCorrection::full == 0);
      const bool all_full = !(e[i] | e[i + a] | e[i + b] | e[i + a + b]);
      if (row[i] == SurfaceCorrection::full && !all_full) row[i] = SurfaceCorrection::surface;
    }
  }
}

template <int Dim>
EULASTIC_INLINE void measure_segment(const Segment &s, ConstView phi, const double *const *velocity,
                                     const double *inverse, double *const *out) {
  const std::ptrdiff_t stride[3] = {1, phi.sy, phi.sz}, row = s.j * phi.sy + s.k * phi.sz;
  for (int d = 0; d < Dim; ++d) {
    double *slope = out[d] + row;
#pragma omp simd
    for (int i = s.i_begin; i < s.i_end; ++i)
      slope[i] = kernels::fraction_slope<Dim>(phi.origin + row + i, d, stride, inverse);
  }
  double *rate = out[Dim] + row;
#pragma omp simd
  for (int i = s.i_begin; i < s.i_end; ++i) rate[i] = kernels::strain_rate<Dim>(velocity, row + i, stride, inverse);
}

EULASTIC_CLONES void measure_2d(const Segment &s, ConstView phi, const double *const *velocity, const double *inverse,
                                double *const *out) {
  measure_segment<2>(s, phi, velocity, inverse, out);
}
EULASTIC_CLONES void measure_3d(const Segment &s, ConstView phi, const double *const *velocity, const double *inverse,
                                double *const *out) {
  measure_segment<3>(s, phi, velocity, inverse, out);
}

}  // namespace

void SurfaceCorrection::find_points(const Box &box, const BoundaryConditions &sides, const Phase &phase,
                                    Location *location) const {
  const Layout &layout = box.layout();
  const ConstView phi = phase.fraction[0];
  const std::ptrdiff_t stride[3] = {1, layout.sy, layout.sz};
  const Staggering &at = location->at;
  const bool centre = !location->on_edge();
  location->kind.assign(layout.size, outside);
  location->points.clear();
  Box::Range range[3];
  for (int d = 0; d < 3; ++d) {
    range[d] = box.points_with_ghosts(d, at[d], ghosts);
    if (at[d] && range[d].end == layout.cells[d] + ghosts) ++range[d].end;  // edges around the last ghost centres
    if (!box.is_wall(d)) continue;
    if (sides[d][0].kind == BoundaryKind::symmetry) range[d].begin = -ghosts;
    if (sides[d][1].kind == BoundaryKind::symmetry) range[d].end = box.points_end(d, at[d]) + ghosts;
  }
  const int last = box.points_end(0, at[0]);
  for (int k = range[2].begin; k < range[2].end; ++k)
    for (int j = range[1].begin; j < range[1].end; ++j) {
      const OccupiedRows::Span span = phase.rows.span(j, k);
      const int begin = std::max(span.begin, range[0].begin), end = std::min(span.end, range[0].end);
      if (begin >= end) continue;
      const std::ptrdiff_t first = layout.offset(begin, j, k);
      unsigned char *row = location->kind.data() + first;
      if (centre) {
        Edges edges[3];
        int count = 0;
        for (const Location &other : locations_)
          if (other.on_edge()) edges[count++] = {other.kind.data() + first, stride[other.a], stride[other.b]};
        flag_centres(end - begin, phi.row(j, k) + begin, edges, count, row);
      } else {
        flag_edges(end - begin, phi.row(j, k) + begin, stride[location->a], stride[location->b], row);
      }
      if (j < 0 || j >= box.points_end(1, at[1]) || k < 0 || k >= box.points_end(2, at[2])) continue;
      for (int i = std::max(begin, 0); i < std::min(end, last); ++i) {
        const void *next = std::memchr(row + i - begin, surface, std::min(end, last) - i);
        if (!next) break;
        i = begin + static_cast<int>(static_cast<const unsigned char *>(next) - row);
        location->points.push_back(static_cast<PetscInt>(layout.offset(i, j, k)));
      }
    }
  location->next.resize(location->points.size() * (centre ? box.dimension() : 1));
}

void SurfaceCorrection::measure_centres(const Box &box, const Field &velocity, ConstView phi, Field &measured) const {
  const int dimension = box.dimension();
  const double *v[3] = {};
  double *out[4] = {}, inverse[3];
  for (int d = 0; d < 3; ++d) inverse[d] = 1 / box.spacing()[d];
  for (int d = 0; d < dimension; ++d) v[d] = velocity[d].origin;
  for (int f = 0; f <= dimension; ++f) out[f] = measured[f].origin;
  const Int3 &n = box.cells();
  in_segment_parts(band_.all(), box, [&](const Segment *begin, const Segment *end) {
    for (const Segment *s = begin; s < end; ++s) {
      const Segment near{std::max(s->i_begin, -1), std::min(s->i_end, n[0] + 1), s->j, s->k};
      if (near.size() <= 0 || s->j < -1 || s->j > n[1] || s->k < -1 || s->k > n[2]) continue;
      (dimension == 2 ? measure_2d : measure_3d)(near, phi, v, inverse, out);
    }
  });
}

}  // namespace eulastic
