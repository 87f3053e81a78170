// SurfaceCorrection: which points are full, which lie at the surface, and what is measured at the centres around.
#include "grid/box.hpp"
#include "kernels/surface.hpp"
#include "physics/surface_correction.hpp"

#include <algorithm>
#include <cstring>

namespace eulastic {
namespace {

constexpr EvolveRule evolves = evolve_above_half, is_full = evolve_where_full;

// phi at their centres or low edges.
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

// Full are centres with full edges around alone; `edges` are the kinds of those, and the strides of the two directions
// they are staggered in.
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

void SurfaceCorrection::find_points(const Box &box, const BoxSides &sides, const Phase &phase,
                                    Location *location) const {
  const Layout &layout = box.layout();
  const ConstView phi = phase.fraction[0];
  const std::ptrdiff_t stride[3] = {1, layout.sy, layout.sz};
  const Staggering &at = location->at;
  const bool centre = location->a == location->b;
  location->kind.assign(layout.size, outside);
  location->points.clear();
  Box::Range range[3];
  for (int d = 0; d < 3; ++d) {
    range[d] = box.points_near(d, at[d], ghosts);
    if (at[d] && range[d].end == layout.cells[d] + ghosts) ++range[d].end;  // around the last centres
    if (!box.is_wall(d)) continue;
    if (sides[d][0].kind == SideKind::symmetry) range[d].begin = -ghosts;
    if (sides[d][1].kind == SideKind::symmetry) range[d].end = box.points_end(d, at[d]) + ghosts;
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
          if (other.a != other.b) edges[count++] = {other.kind.data() + first, stride[other.a], stride[other.b]};
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
  in_parts_of(band_.all(), box, [&](const Segment *begin, const Segment *end) {
    for (const Segment *s = begin; s < end; ++s) {
      const Segment near{std::max(s->i_begin, -1), std::min(s->i_end, n[0] + 1), s->j, s->k};
      if (near.size() <= 0 || s->j < -1 || s->j > n[1] || s->k < -1 || s->k > n[2]) continue;
      (dimension == 2 ? measure_2d : measure_3d)(near, phi, v, inverse, out);
    }
  });
}

}  // namespace eulastic
