#include "physics/surface_correction.hpp"

#include "base/events.hpp"
#include "field/law.hpp"
#include "grid/row_scratch.hpp"
#include "grid/threads.hpp"
#include "kernels/surface.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace eulastic {
namespace {

constexpr unsigned char full = 0, surface = 1, outside = 2;
constexpr EvolveRule evolves = evolve_above_half, is_full = evolve_where_full;
constexpr double forgetting = 3;           // per unit of strain, where viscosity damps short waves
constexpr double least_determinant = 0.75;  // F does not go below

// What the points of a row are; phi at their centres or low edges.
EULASTIC_CLONES void flag_edges(int n, const double *phi, std::ptrdiff_t a, std::ptrdiff_t b, unsigned char *row) {
#pragma omp simd
  for (int i = 0; i < n; ++i) {
    const double share = kernels::average4(phi + i, -a, -b);
    row[i] = share >= is_full.edge ? full : share >= evolves.edge ? surface : outside;
  }
}

// Full are centres with full edges around alone.
template <int Dim>
EULASTIC_INLINE void flag_centre_row(int n, const double *phi, const std::ptrdiff_t *stride, unsigned char *row) {
#pragma omp simd
  for (int i = 0; i < n; ++i) {
    const double *q = phi + i;
    double least = q[0];
#pragma GCC unroll 3
    for (int a = 0; a < Dim; ++a)
#pragma GCC unroll 3
      for (int b = a + 1; b < Dim; ++b) {
        const std::ptrdiff_t x = stride[a], y = stride[b];
        const auto edge = [&](std::ptrdiff_t s, std::ptrdiff_t t) EULASTIC_BODY {
          const double share = kernels::average4(q, s, t);
          least = share < least ? share : least;
        };
        edge(x, y);
        edge(-x, y);
        edge(x, -y);
        edge(-x, -y);
      }
    row[i] = q[0] >= is_full.centre && least >= is_full.edge ? full : q[0] >= evolves.centre ? surface : outside;
  }
}

EULASTIC_CLONES void flag_centres_2d(int n, const double *phi, const std::ptrdiff_t *stride, unsigned char *row) {
  flag_centre_row<2>(n, phi, stride, row);
}
EULASTIC_CLONES void flag_centres_3d(int n, const double *phi, const std::ptrdiff_t *stride, unsigned char *row) {
  flag_centre_row<3>(n, phi, stride, row);
}

// A field whose diagonal components live at centres and the others on edges, at one point of a location: the mean of
// the four values around it where they live elsewhere; of those that `counts` alone.
template <int Dim, class Value, class Counts>
EULASTIC_INLINE kernels::Tensor<Dim> at_point(const Staggering &at, const std::ptrdiff_t *stride, const Value &value,
                                              const Counts &counts) {
  kernels::Tensor<Dim> t;
  for (int a = 0; a < Dim; ++a)
    for (int b = a; b < Dim; ++b) {
      std::ptrdiff_t step[2] = {0, 0};
      int steps = 0;
      for (int d = 0; d < Dim; ++d)
        if (at[d] != (a != b && (d == a || d == b))) step[steps++] = at[d] ? -stride[d] : stride[d];
      double sum = 0;
      if (steps == 0) {
        sum = value(a, b, 0);
      } else {
        int count = 0;
        const auto one = [&](std::ptrdiff_t o) EULASTIC_BODY {
          if (!counts(a, b, o)) return 0.0;
          ++count;
          return value(a, b, o);
        };
        const double low = one(0) + one(step[0]);
        sum = low + (one(step[1]) + one(step[0] + step[1]));
        sum = count > 0 ? sum / count : 0;
      }
      t[a][b] = t[b][a] = sum;
    }
  return t;
}

// What full points say of `fields` further out: the mean over the nearest ones, in steps from face to face; false if
// none is within reach. Each is extended along its steps by a line, of the smaller one of the two slopes behind it,
// none if they differ in sign or lie beyond the ghosts.
template <int Dim, int Fields>
bool extend_full(const unsigned char *mask, const double *const *fields, const std::ptrdiff_t *stride, double *mean) {
  struct Sum {
    double value[Fields] = {};
    int count = 0;
    void add(const Sum &other) {
      for (int f = 0; f < Fields; ++f) value[f] += other.value[f];
      count += other.count;
    }
  };
  const auto slope = [](const double *q, std::ptrdiff_t in) {
    const double near = q[0] - q[in], far = q[in] - q[2 * in];
    return near * far > 0 ? (std::fabs(near) < std::fabs(far) ? near : far) : 0.0;
  };
  // `away` steps of these strides from here.
  const auto point = [&](const Int3 &away, const std::array<std::ptrdiff_t, 3> &step) {
    Sum one;
    const std::ptrdiff_t o = away[0] * step[0] + away[1] * step[1] + away[2] * step[2];
    if (mask[o] != full) return one;
    one.count = 1;
    for (int f = 0; f < Fields; ++f) one.value[f] = fields[f][o];
    for (int d = 0; d < Dim; ++d) {
      if (away[d] == 0 || away[d] + 2 > SurfaceCorrection::ghosts) continue;
      if (mask[o + step[d]] != full || mask[o + 2 * step[d]] != full) continue;
      for (int f = 0; f < Fields; ++f) one.value[f] += away[d] * slope(fields[f] + o, step[d]);
    }
    return one;
  };
  // Both sides of a direction first: a mirrored scene gives the mirrored bits.
  const auto sides = [&](const Int3 &away) {
    Sum all;
    for (int z = 0; z <= (away[2] > 0); ++z) {
      Sum plane;
      for (int y = 0; y <= (away[1] > 0); ++y) {
        Sum row;
        for (int x = 0; x <= (away[0] > 0); ++x)
          row.add(point(away, {x ? -stride[0] : stride[0], y ? -stride[1] : stride[1], z ? -stride[2] : stride[2]}));
        plane.add(row);
      }
      all.add(plane);
    }
    return all;
  };
  for (int steps = 1; steps <= SurfaceCorrection::reach; ++steps) {
    Sum sum;
    for (int z = 0; z <= (Dim == 3 ? steps : 0); ++z)
      for (int y = 0; y <= steps - z; ++y) sum.add(sides({steps - z - y, y, z}));
    if (sum.count == 0) continue;
    for (int f = 0; f < Fields; ++f) mean[f] = sum.value[f] / sum.count;
    return true;
  }
  return false;
}

}  // namespace

void SurfaceCorrection::find_points(const Grid &grid, const BoxSides &sides, const Phase &phase,
                                    Location *location) const {
  const Layout &layout = grid.layout();
  const ConstView phi = phase.fraction[0];
  const std::ptrdiff_t stride[3] = {1, layout.sy, layout.sz};
  const Staggering &at = location->at;
  std::vector<unsigned char> &mask = location->mask;
  mask.assign(layout.size, outside);
  location->points.clear();
  Grid::Range box[3];
  for (int d = 0; d < 3; ++d) {
    box[d] = grid.points_near(d, at[d], ghosts);
    if (!grid.is_wall(d)) continue;
    if (sides[d][0].kind == SideKind::symmetry) box[d].begin = -ghosts;
    if (sides[d][1].kind == SideKind::symmetry) box[d].end = grid.points_end(d, at[d]) + ghosts;
  }
  const int row_end = grid.points_end(0, at[0]);
  for (int k = box[2].begin; k < box[2].end; ++k)
    for (int j = box[1].begin; j < box[1].end; ++j) {
      const OccupiedRows::Span span = phase.rows.span(j, k);
      const int begin = std::max(span.begin, box[0].begin), end = std::min(span.end, box[0].end);
      if (begin >= end) continue;
      unsigned char *row = mask.data() + layout.offset(0, j, k);
      const double *q = phi.row(j, k) + begin;
      if (location->a != location->b)
        flag_edges(end - begin, q, phi.stride(location->a), phi.stride(location->b), row + begin);
      else
        (grid.dimension() == 2 ? flag_centres_2d : flag_centres_3d)(end - begin, q, stride, row + begin);
      if (j < 0 || j >= grid.points_end(1, at[1]) || k < 0 || k >= grid.points_end(2, at[2])) continue;
      const int last = std::min(end, row_end);
      for (int i = std::max(begin, 0); i < last; ++i) {
        const void *next = std::memchr(row + i, surface, last - i);
        if (!next) break;
        i = static_cast<int>(static_cast<const unsigned char *>(next) - row);
        location->points.push_back(static_cast<PetscInt>(layout.offset(i, j, k)));
      }
    }
}

template <int Dim, class Law>
void SurfaceCorrection::correct(const Grid &grid, const SurfaceStep &step, const Law &law, const FieldBlock &velocity,
                                const Phase &phase, const Location &location, Piece piece, FieldBlock &next) const {
  const Layout &layout = grid.layout();
  const Real3 &h = grid.spacing();
  const double inverse[3] = {1 / h[0], 1 / h[1], 1 / h[2]};
  const std::ptrdiff_t stride[3] = {1, layout.sy, Dim == 3 ? layout.sz : 0};
  const Staggering &at = location.at;
  const bool centre = location.a == location.b;
  const double shortest = *std::min_element(h.begin(), h.begin() + Dim), rho = step.fluid.density;
  const double mu = step.fluid.viscosity, wave = std::sqrt(rho * phase.material.shear_modulus) * shortest;
  const double fading = forgetting * step.dt * (mu < wave ? mu / wave : mu > 0 ? 1 : 0);
  const double kinked = mu > wave ? wave / mu : 1;  // the share of K
  const double *phi = phase.fraction.data(), *B[6] = {}, *v[3] = {};
  const unsigned char *mask[6] = {};
  double *out[6] = {};
  for (int f = 0; f < next.count(); ++f) {
    B[f] = phase.tensor.data() + f * layout.size;
    out[f] = next.data() + f * layout.size;
    mask[f] = locations_[f < Dim ? 0 : f - Dim + 1].mask.data();
  }
  for (int d = 0; d < Dim; ++d) v[d] = velocity.data() + d * layout.size;
  const int first = centre ? 0 : kernels::position<Dim>(location.a, location.b), count = centre ? Dim : 1;
  for (std::size_t n = piece.begin; n < piece.end; ++n) {
    const std::ptrdiff_t p = location.points[n];
    const auto tensor = at_point<Dim>(
        at, stride,
        [&](int a, int b, std::ptrdiff_t o) EULASTIC_BODY { return B[kernels::position<Dim>(a, b)][p + o]; },
        [&](int a, int b, std::ptrdiff_t o)
            EULASTIC_BODY { return mask[kernels::position<Dim>(a, b)][p + o] != outside; });
    double excess = -Dim;
    for (int a = 0; a < Dim; ++a) excess += tensor[a][a];
    const double share = centre ? phi[p] : kernels::average4(phi + p, -stride[location.a], -stride[location.b]);
    const double G = law.traction_modulus(excess);
    const double k = G > 0 ? G / (mu + 0.25 * shortest * std::sqrt(rho * G)) : 0;
    const kernels::Vector<Dim> normal = kernels::surface_normal<Dim>(phi + p, at.data(), stride, inverse);
    kernels::Tensor<Dim> moved = kernels::relax_traction<Dim>(tensor, normal, (1 - share) * kinked * k * step.dt);
    // F
    double mean[Dim];
    const double *full_fields[Dim];
    for (int f = 0; f < count; ++f) full_fields[f] = B[first + f] + p;
    if (fading > 0 && (centre ? extend_full<Dim, Dim>(mask[first] + p, full_fields, stride, mean)
                              : extend_full<Dim, 1>(mask[first] + p, full_fields, stride, mean))) {
      const auto rate = at_point<Dim>(
          at, stride,
          [&](int a, int b, std::ptrdiff_t o) EULASTIC_BODY {
            const double *va = v[a] + p + o, *vb = v[b] + p + o;
            if (a == b) return inverse[a] * (va[stride[a]] - va[0]);
            return 0.5 * (inverse[b] * (va[0] - va[-stride[b]]) + inverse[a] * (vb[0] - vb[-stride[a]]));
          },
          [](int, int, std::ptrdiff_t) EULASTIC_BODY { return true; });
      const double strain = fading * __builtin_sqrt(kernels::double_contraction<Dim>(rate));
      const double keep = kernels::exp(strain < 700 ? -strain : -700);
      kernels::Tensor<Dim> faded = moved;
      for (int f = 0; f < count; ++f) {
        const int a = centre ? f : location.a, b = centre ? f : location.b;
        faded[a][b] = faded[b][a] = kernels::fma(keep, moved[a][b], (1 - keep) * mean[f]);
      }
      const double before = kernels::determinant<Dim>(moved), after = kernels::determinant<Dim>(faded);
      if (!(after < least_determinant && after < before)) moved = faded;
    }
    for (int f = 0; f < count; ++f) {
      const double value = moved[centre ? f : location.a][centre ? f : location.b];
      out[first + f][p] = centre && value <= 0 ? B[first + f][p] : value;  // means need not be positive definite
    }
  }
}

PetscErrorCode SurfaceCorrection::apply(const Grid &grid, const SurfaceStep &step, const FieldBlock &velocity,
                                        Phase &phase, FieldBlock &work) {
  PetscFunctionBeginUser;
  if (!phase.material.elastic()) PetscFunctionReturn(0);
  VerbScope scope(Verb::left_cauchy_green);
  const int dimension = grid.dimension(), team = row_parts(grid);
  if (locations_.empty()) {
    locations_.emplace_back();
    for (const TensorComponent &c : tensor_components(dimension))
      if (c.a != c.b) {
        locations_.emplace_back();
        Location &edges = locations_.back();
        edges.a = c.a;
        edges.b = c.b;
        edges.at = c.staggering();
      }
  }
  in_parallel(team, static_cast<int>(locations_.size()),
              [&](int l) { find_points(grid, step.sides, phase, &locations_[l]); });
  in_parallel(team, team, [&](int part) {
    for (const Location &location : locations_)
      with_law(phase.material, [&](const auto &law) {
        const Piece piece(location.points.size(), part, team);
        if (dimension == 2)
          correct<2>(grid, step, law, velocity, phase, location, piece, work);
        else
          correct<3>(grid, step, law, velocity, phase, location, piece, work);
      });
  });
  const std::ptrdiff_t size = grid.layout().size;
  int first = 0;
  for (const Location &location : locations_) {
    const int fields = location.a == location.b ? dimension : 1;
    for (int f = first; f < first + fields; ++f) {
      double *B = phase.tensor.data() + f * size;
      const double *next = work.data() + f * size;
      for (const PetscInt p : location.points) B[p] = next[p];
    }
    first += fields;
    scope.flops(double(location.points.size()) *
                (dimension == 2 ? kernels::surface_flops_2d : kernels::surface_flops_3d));
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
