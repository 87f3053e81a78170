#include "solids/exterior.hpp"

#include "base/events.hpp"
#include "grid/row_scratch.hpp"
#include "grid/threads.hpp"
#include "kernels/stencils.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace eulastic {
namespace {

constexpr unsigned char outside = 255;

// The owned points of a field and `layers` of points around them.
struct PointBlock {
  Int3 begin{}, end{};
  PointBlock(const Box &box, const Staggering &at, int layers) {
    for (int d = 0; d < 3; ++d) {
      const Box::Range near = box.points_with_ghosts(d, at[d], layers);
      begin[d] = near.begin;
      end[d] = near.end;
    }
  }
  bool contains(const Int3 &p) const {
    return p[0] >= begin[0] && p[0] < end[0] && p[1] >= begin[1] && p[1] < end[1] && p[2] >= begin[2] && p[2] < end[2];
  }
};

// Whether the layer number decreases for two points beyond the neighbour mask[step], i.e. the line leads into the body.
bool leads_in(const unsigned char *mask, std::ptrdiff_t step) {
  const auto inwards = [](unsigned char layer, unsigned char next) { return next == 0 || next < layer; };
  return inwards(mask[step], mask[2 * step]) && inwards(mask[2 * step], mask[3 * step]);
}

// Flags the first `n` points of a row: 0 where B evolves, `outside` elsewhere. `phi` is at their centres, or at the
// centres above their edges.
template <bool Edge>
EULASTIC_INLINE void flag_points(int n, const double *phi, const std::ptrdiff_t *step, double threshold,
                                 unsigned char *row) {
  const std::ptrdiff_t a = -step[0], b = -step[1];
#pragma omp simd
  for (int i = 0; i < n; ++i) row[i] = (Edge ? kernels::average4(phi + i, a, b) : phi[i]) >= threshold ? 0 : outside;
}

EULASTIC_CLONES void flag_row(int n, const double *phi, const std::ptrdiff_t *step, double threshold,
                              unsigned char *row) {
  if (step[0] != 0)
    flag_points<true>(n, phi, step, threshold, row);
  else
    flag_points<false>(n, phi, step, threshold, row);
}

// found = 1 at the points outside with a face neighbour in a layer below L, 0 elsewhere. Works on whole vectors.
EULASTIC_CLONES void find_layer(int n, const unsigned char *row, std::ptrdiff_t sy, std::ptrdiff_t sz, unsigned char L,
                                unsigned char *found) {
  const auto least = [](unsigned char a, unsigned char b) EULASTIC_BODY { return a < b ? a : b; };
#pragma omp simd
  for (int i = 0; i < n; ++i) {
    const unsigned char near =
        least(least(least(row[i - 1], row[i + 1]), least(row[i - sy], row[i + sy])), least(row[i - sz], row[i + sz]));
    found[i] = row[i] == outside && near < L;
  }
}

// Index of the first found point at or after i, or n.
int next_found(const unsigned char *found, int i, int n) {
  const void *at = std::memchr(found + i, 1, n - i);
  return at ? static_cast<int>(static_cast<const unsigned char *>(at) - found) : n;
}

// Whether all edges around the centre phi[0] evolve.
bool is_surrounded(const double *phi, const std::ptrdiff_t *stride, int dimension, double least) {
  for (int a = 0; a < dimension; ++a)
    for (int b = a + 1; b < dimension; ++b)
      for (const std::ptrdiff_t x : {-stride[a], stride[a]})
        for (const std::ptrdiff_t y : {-stride[b], stride[b]})
          if (!(kernels::average4(phi, x, y) >= least)) return false;
  return true;
}

// The part of a row within `extent` that is close to a body. Owned rows without strained points have none.
OccupiedRows::Span near_part(const Phase &phase, const PointBlock &extent, int j, int k) {
  const ActiveSegments &strained = phase.tensor.strained;
  if (j >= 0 && k >= 0 && j < strained.rows_y() && k < strained.rows_z()) {
    const ActiveSegments::Range range = strained.row(j, k);
    if (range.first == range.last) return {0, 0};
  }
  const OccupiedRows::Span span = phase.rows.span(j, k);
  return {std::max(span.begin, extent.begin[0]), std::min(span.end, extent.end[0])};
}

// Sets `mask` to 0 at the points of staggering `at` that evolve.
void flag_evolving(const Box &box, const Phase &phase, const Staggering &at, const std::ptrdiff_t *stride,
                   const PointBlock &all, unsigned char *mask) {
  const ConstView fraction = phase.fraction[0];
  const EvolveRule &rule = phase.tensor.rule;
  std::ptrdiff_t step[2] = {0, 0};
  int steps = 0;
  for (int d = 0; d < 3; ++d)
    if (at[d]) step[steps++] = fraction.stride(d);
  for (int k = all.begin[2]; k < all.end[2]; ++k)
    for (int j = all.begin[1]; j < all.end[1]; ++j) {
      const auto [begin, end] = near_part(phase, all, j, k);
      if (begin >= end) continue;
      const double *phi = fraction.row(j, k) + begin;
      unsigned char *row = mask + box.layout().offset(begin, j, k);
      flag_row(end - begin, phi, step, steps ? rule.edge : rule.centre, row);
      if (rule.linear && steps == 0)
        for (int i = 0; i < end - begin; ++i)
          if (row[i] == 0 && !is_surrounded(phi + i, stride, box.dimension(), rule.edge)) row[i] = outside;
    }
}

double kinematic_viscosity(const Fluid &fluid, const Material &material) {
  return viscosity_of(material, fluid) / fluid.density;
}

}  // namespace

double damping_spacing(const Fluid &fluid, const Material &material) {
  return kinematic_viscosity(fluid, material) / std::sqrt(material.shear_modulus / fluid.density);
}

bool damps_short_waves(const Real3 &spacing, int dimension, const Fluid &fluid, const Material &material) {
  const double shortest = *std::min_element(spacing.begin(), spacing.begin() + dimension);
  return std::sqrt(material.shear_modulus / fluid.density) * shortest <= kinematic_viscosity(fluid, material);
}

PetscErrorCode ExteriorLayers::build(const Box &box, const Phase &phase) {
  PetscFunctionBeginUser;
  EventScope scope(Event::exterior);
  if (locations_.empty())
    for (const TensorComponent &c : tensor_locations(box.dimension())) locations_.push_back({c.at, {}});
  linear_ = phase.tensor.rule.linear;
  const int team = row_parts(box);
  masks_.resize(team > 1 ? locations_.size() : 1);
  in_parallel(team, static_cast<int>(locations_.size()),
              [&](int l) { build_location(box, phase, &masks_[team > 1 ? l : 0], &locations_[l]); });
  PetscFunctionReturn(0);
}

void ExteriorLayers::build_location(const Box &box, const Phase &phase, Mask *layer_of, Location *location) const {
  const Layout &layout = box.layout();
  const Staggering &at = location->staggering;
  layer_of->assign(layout.size + whole_vectors(1), outside);
  unsigned char *mask = layer_of->data();
  const std::ptrdiff_t stride[3] = {1, layout.sy, box.dimension() == 3 ? layout.sz : 0};
  // An edge depends on one centre further down, so four layers of edges need five layers of centres.
  const PointBlock all(box, at, layers);
  flag_evolving(box, phase, at, stride, all, mask);
  const PointBlock owned(box, at, 0);
  // The marks of a row are written one row later, so that find_layer() of the next row need not wait for these stores.
  struct Row {
    int begin, n = 0, j, k;
    unsigned char *mask;
    std::vector<unsigned char> found;
  } rows[2];
  for (Row &row : rows) row.found.resize(whole_vectors(all.end[0] - all.begin[0]));
  for (int L = 1; L <= layers; ++L) {
    std::vector<LayerPoint> &entries = location->layer[L - 1];
    entries.clear();
    const auto mark = [&](Row &row) {
      for (int i = next_found(row.found.data(), 0, row.n); i < row.n; i = next_found(row.found.data(), i + 1, row.n)) {
        unsigned char *point_mask = row.mask + i;
        *point_mask = static_cast<unsigned char>(L);
        if (linear_ && !owned.contains({row.begin + i, row.j, row.k})) continue;
        const auto counts = [=](std::ptrdiff_t step) { return point_mask[step] < L; };
        const auto has_line = [=](std::ptrdiff_t step) { return point_mask[step] < L && leads_in(point_mask, step); };
        entries.emplace_back(point_mask - mask, neighbour_bits(box.dimension(), stride, counts),
                             linear_ ? neighbour_bits(box.dimension(), stride, has_line) : 0);
      }
      row.n = 0;
    };
    const PointBlock extent(box, at, layers - L);
    int turn = 0;
    for (int k = extent.begin[2]; k < extent.end[2]; ++k)
      for (int j = extent.begin[1]; j < extent.end[1]; ++j) {
        const auto [begin, end] = near_part(phase, extent, j, k);
        if (begin >= end) continue;
        Row &row = rows[turn];
        row.begin = begin;
        row.n = end - begin;
        row.j = j;
        row.k = k;
        row.mask = mask + layout.offset(begin, j, k);
        find_layer(whole_vectors(row.n), row.mask, stride[1], stride[2], static_cast<unsigned char>(L),
                   row.found.data());
        turn = 1 - turn;
        mark(rows[turn]);  // the previous row
      }
    mark(rows[1 - turn]);
  }
}

// Extends B to piece `part` of the points of a layer. Returns the flops.
double ExteriorLayers::extend_part(const Box &box, int layer, int part, int parts, double *B) const {
  const std::ptrdiff_t stride[3] = {1, box.layout().sy, box.layout().sz}, size = box.layout().size;
  const int dimension = box.dimension();
  double flops = 0;
  for (const Location &location : locations_) {  // the diagonals, which share their points, then the off-diagonals
    const std::vector<LayerPoint> &points = location.layer[layer - 1];
    const Piece piece(points.size(), part, parts);
    const int fields = &location == &locations_[0] ? dimension : 1;
    const auto extend = fields == 1 ? extend_layer<1> : fields == 2 ? extend_layer<2> : extend_layer<3>;
    flops += extend(points, piece, dimension, stride, size, B);
    B += fields * size;
  }
  return flops;
}

PetscErrorCode ExteriorLayers::extend(const Box &box, const BoundaryConditions &sides, GhostExchange *exchange,
                                      Field &tensor) const {
  PetscFunctionBeginUser;
  EventScope scope(Event::exterior);
  const int parts = row_parts(box);
  std::vector<double> flops(parts);
  for (int L = 1; L <= layers; ++L) {
    in_parallel(parts, parts, [&](int part) { flops[part] = extend_part(box, L, part, parts, tensor.data()); });
    for (const double part_flops : flops) scope.flops(part_flops);
    clear_symmetry_planes(box, sides, tensor);  // the mean of a component and its mirror image is 0
    if (linear_ && exchange && L < layers) PetscCall(exchange->update_ghosts(tensor, 3));
  }
  PetscFunctionReturn(0);
}

double ExteriorLayers::points() const noexcept {
  double sum = 0;
  for (const Location &location : locations_)
    for (const auto &entries : location.layer) sum += double(entries.size());
  return sum;
}

}  // namespace eulastic
