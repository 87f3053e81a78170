#include "solids/exterior.hpp"

#include "base/events.hpp"
#include "grid/threads.hpp"
#include "kernels/stencils.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace eulastic {
namespace {

// A line of linear extrapolation has three points.
constexpr int line_points = 3;
// The layer whose first ghosts this rank computes itself, from layers that have been exchanged before: their lines
// reach the fourth ghost.
constexpr int unexchanged_layer = 2;

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
  bool has_row(int j, int k) const { return j >= begin[1] && j < end[1] && k >= begin[2] && k < end[2]; }
};

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
    const Slice<Segment> range = strained.row(j, k);
    if (range.first == range.last) return {0, 0};
  }
  const OccupiedRows::Span span = phase.rows.span(j, k);
  return {std::max(span.begin, extent.begin[0]), std::min(span.end, extent.end[0])};
}

// Sets the bits of the points of staggering `at` that evolve.
void flag_evolving(const Box &box, const Phase &phase, const Staggering &at, const PointBlock &all, BitRows *evolving) {
  const ConstView fraction = phase.fraction[0];
  const EvolveRule &rule = phase.tensor.rule;
  const std::ptrdiff_t stride[3] = {1, fraction.sy, fraction.sz};
  std::ptrdiff_t step[2] = {0, 0};
  int steps = 0;
  for (int d = 0; d < 3; ++d)
    if (at[d]) step[steps++] = stride[d];
  for (int k = all.begin[2]; k < all.end[2]; ++k)
    for (int j = all.begin[1]; j < all.end[1]; ++j) {
      const auto [begin, end] = near_part(phase, all, j, k);
      if (begin >= end) continue;
      const double *phi = fraction.row(j, k) + begin;
      const int first_bit = begin - evolving->begin_x();
      BitRows::Word *row = evolving->row(j, k);
      // An edge has the mean of the centres around it, summed in the order of average4().
      const auto centre = [&](int i) { return load_four(phi + i) >= rule.centre; };
      const auto edge = [&](int i) {
        const double *q = phi + i;
        return 0.25 * ((load_four(q) + load_four(q - step[0])) +
                       (load_four(q - step[1]) + load_four(q - step[0] - step[1]))) >=
               rule.edge;
      };
      if (steps > 0)
        set_where(end - begin, first_bit, edge, row);
      else
        set_where(end - begin, first_bit, centre, row);
      if (rule.linear && steps == 0)
        for (int i = 0; i < end - begin; ++i)
          if (is_set(first_bit + i, row) && !is_surrounded(phi + i, stride, box.dimension(), rule.edge))
            clear_bit(first_bit + i, row);
    }
}

// The layers of the points of word w of row (j, k) and of the points around them.
struct LayerWords {
  const std::vector<BitRows> &up_to;  ///< [m]: the points in layer m or below
  int j, k, w;

  BitRows::Word word(int m, int d, int step) const {
    const BitRows &mask = up_to[m];
    if (d == 0) return mask.moved_word(j, k, w, step);
    return mask.row(d == 1 ? j + step : j, d == 2 ? k + step : k)[w];
  }
  BitRows::Word in_layer(int m, int d, int step) const {
    return m == 0 ? word(0, d, step) : word(m, d, step) & ~word(m - 1, d, step);
  }
  // The points whose neighbour along d is below layer L, and whose layers decrease for two points beyond it, i.e. the
  // line leads into the body.
  BitRows::Word lines(int L, int d, int side) const {
    BitRows::Word found = 0;
    for (int first = 0; first < L; ++first) {
      BitRows::Word beyond = 0;
      for (int second = 0; second <= std::max(first - 1, 0); ++second)
        beyond |= in_layer(second, d, 2 * side) & word(std::max(second - 1, 0), d, 3 * side);
      found |= in_layer(first, d, side) & beyond;
    }
    return found;
  }
};

// Words of a row, one for each direction -x, +x, -y, ...: the bits of single points in the order of neighbour_bits().
struct DirectionWords {
  std::array<BitRows::Word, 6> of{};

  BitRows::Word any() const { return of[0] | of[1] | of[2] | of[3] | of[4] | of[5]; }
  // Returns for 8 points from bit `first` on, a multiple of 8, a byte with the bits of the directions.
  BitRows::Word of_points(int first) const {
    BitRows::Word bytes = 0;
    for (int n = 0; n < 6; ++n) bytes |= (of[n] >> first & 0xff) << (8 * n);
    return transposed(bytes);
  }
};

// Appends the points of a word whose first bit is a point at an offset.
void append_points(BitRows::Word points, std::ptrdiff_t offset, const DirectionWords &neighbours,
                   const DirectionWords &lines, std::vector<LayerPoint> *entries) {
  const bool any_line = lines.any() != 0;
  for (int first = 0; first < BitRows::word_bits; first += 8) {
    unsigned group = points >> first & 0xff;
    if (group == 0) continue;
    const BitRows::Word near = neighbours.of_points(first), along = any_line ? lines.of_points(first) : 0;
    for (; group != 0; group &= group - 1) {
      const int b = __builtin_ctz(group);
      entries->emplace_back(offset + first + b, near >> (8 * b) & 0xff, along >> (8 * b) & 0xff);
    }
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

void ExteriorLayers::build_location(const Box &box, const Phase &phase, Masks *masks, Location *location) const {
  const Staggering &at = location->staggering;
  const int dimension = box.dimension();
  // An edge depends on one centre further down, so four layers of edges need five layers of centres.
  const PointBlock all(box, at, layers);
  Extent block{all.begin, all.end};  // with the rows that neighbours and lines read
  for (int d = 1; d < dimension; ++d) {
    block.begin[d] -= linear_ ? 3 : 1;
    block.end[d] += linear_ ? 3 : 1;
  }
  masks->resize(layers + 1);
  (*masks)[0].reset(block);
  flag_evolving(box, phase, at, all, &(*masks)[0]);
  for (int L = 1; L <= layers; ++L) {
    BitRows &found = (*masks)[L] = (*masks)[L - 1];
    std::vector<LayerPoint> &entries = location->layer[L - 1];
    entries.clear();
    const BitRows &below = (*masks)[L - 1];
    const std::ptrdiff_t sy = below.words(), sz = below.words_in_plane();
    const int base = below.begin_x();
    const PointBlock extent(box, at, layers - L), with_lines(box, at, L == unexchanged_layer ? 1 : 0);
    for (int k = extent.begin[2]; k < extent.end[2]; ++k)
      for (int j = extent.begin[1]; j < extent.end[1]; ++j)
        for (int w = 0; w < below.words(); ++w) {
          const BitRows::Word *at_w = below.row(j, k) + w;
          DirectionWords neighbours{{below.moved_word(j, k, w, -1), below.moved_word(j, k, w, 1), at_w[-sy], at_w[sy]}};
          if (dimension == 3) {
            neighbours.of[4] = at_w[-sz];
            neighbours.of[5] = at_w[sz];
          }
          BitRows::Word next =
              neighbours.any() & ~*at_w & bits_between(extent.begin[0] - base, extent.end[0] - base, w);
          if (next == 0) continue;
          found.row(j, k)[w] |= next;
          DirectionWords lines;
          if (linear_) {
            next &=
                with_lines.has_row(j, k) ? bits_between(with_lines.begin[0] - base, with_lines.end[0] - base, w) : 0;
            for (int n = 0; next != 0 && n < 2 * dimension; ++n)
              lines.of[n] = LayerWords{*masks, j, k, w}.lines(L, n / 2, n % 2 ? 1 : -1);
          }
          append_points(next, box.layout().offset(base + w * BitRows::word_bits, j, k), neighbours, lines, &entries);
        }
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
    if (linear_ && exchange && L < layers && L != unexchanged_layer)
      PetscCall(exchange->update_ghosts(tensor, L < unexchanged_layer ? unexchanged_layer : line_points));
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
