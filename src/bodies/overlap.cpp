#include "bodies/overlap.hpp"

#include "bodies/crowd.hpp"
#include "bodies/volume_fraction.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace eulastic {
namespace {

constexpr double excess = 0.01;  // of the sum of two fractions over 1; above the rounding of listed positions
constexpr double skin = 5e-4;    // in cells: bodies that overlap by less count as touching

// Returns whether bodies of `two` are compared with those of `one`, an earlier species or the same.
bool is_wanted(const SpeciesSpec &one, const SpeciesSpec &two) {
  if (is_from_file(one.shape) || is_from_file(two.shape) || two.placement == Placement::random) return false;
  if (one.material().anchored && two.material().anchored) return false;
  return &one != &two || two.contact != Contact::merge;
}

// A range of cells that two bodies may touch, with the shift to each body's unwrapped indices.
struct Common {
  int begin, end, shift_a, shift_b;
};

// Returns by how much the fractions of two bodies in a cell exceed 1 together.
double shared_in(const PlacedBody &a, const PlacedBody &b, const Common (&range)[3], const Int3 &cell) {
  Int3 in_a, in_b;
  for (int d = 0; d < 3; ++d) in_a[d] = cell[d] + range[d].shift_a, in_b[d] = cell[d] + range[d].shift_b;
  if (a.is_clear_of(in_a) || b.is_clear_of(in_b)) return 0;
  return std::max(0.0, a.fraction(in_a) + b.fraction(in_b) - 1);
}

// Returns the sum of shared_in() over a range of cells or, unless `all`, the first value above `excess`.
double shared_in(const PlacedBody &a, const PlacedBody &b, const Common (&range)[3], bool all) {
  const Common &x = range[0], &y = range[1], &z = range[2];
  const auto middle = [](const Common &c) { return (c.begin + c.end) / 2; };
  double sum = 0;
  if (const double more = shared_in(a, b, range, {middle(x), middle(y), middle(z)}); !all && more > excess) return more;
  for (int k = z.begin; k < z.end; ++k)
    for (int j = y.begin; j < y.end; ++j)
      for (int i = x.begin; i < x.end; ++i) {
        const double more = shared_in(a, b, range, {i, j, k});
        if (!all && more > excess) return more;
        if (all) sum += more;
      }
  return sum;
}

// Pairs of the bodies that this rank knows, in the order of their labels.
class Search {
public:
  Search(const std::vector<SpeciesSpec> &species, const std::vector<Places> &places, const DomainShape &grid)
      : species_(species), grid_(grid), dimension_(grid.dimension()) {
    const std::vector<int> first = first_labels(species, places);
    for (std::size_t s = 0; s < species.size(); ++s) {
      surfaces_.emplace_back(species[s], dimension_);
      shapes_.emplace_back(species[s], dimension_, -skin * grid.shortest_spacing());
      if (is_closed(species[s].shape)) widest_ = std::max(widest_, 2 * shapes_[s].outer_radius());
      if (is_from_file(species[s].shape)) continue;
      for (const NumberedPlace &place : places[s].known) bodies_.push_back({first[s] + place.index, s, &place});
    }
    find_candidates();
  }

  int bodies() const { return static_cast<int>(bodies_.size()); }
  int label(int b) const { return bodies_[b].label; }

  // Pairs of bodies that may share cells, in both orders, ascending.
  const std::vector<std::pair<int, int>> &candidates() const { return candidates_; }

  // Returns whether the centres of two bodies, periodic images included, and their extents agree to 0.01 cells.
  bool at_same_place(int one, int two) const {
    if (!is_closed(spec(one).shape) || !is_closed(spec(two).shape)) return false;
    for (int d = 0; d < dimension_; ++d) {
      const double close = 0.01 * grid_.length[d] / grid_.cells[d];
      double apart = place(one).centre[d] - place(two).centre[d];
      if (grid_.boundary[d] == Boundary::periodic) apart = std::remainder(apart, grid_.length[d]);
      if (std::fabs(apart) > close) return false;
      if (std::fabs(shapes_[whose(one)].outer_radius() - shapes_[whose(two)].outer_radius()) > close) return false;
    }
    return true;
  }

  // Returns the volume that two bodies share or, unless `all`, the first part of it that is found.
  double shared(int one, int two, bool all) const {
    const PlacedBody a(surfaces_[whose(one)], grid_, place(one)), b(surfaces_[whose(two)], grid_, place(two));
    std::array<std::vector<Common>, 3> common;
    double sum = 0, cell = 1;
    for (int d = 0; d < 3; ++d) {
      for (const PlacedBody::Range &p : a.ranges(d, 0, grid_.cells[d]))
        for (const PlacedBody::Range &q : b.ranges(d, p.begin, p.end))
          common[d].push_back({q.begin, q.end, p.shift, q.shift});
      if (d < dimension_) cell *= grid_.length[d] / grid_.cells[d];
    }
    for (const Common &z : common[2])
      for (const Common &y : common[1])
        for (const Common &x : common[0])
          if (all || sum == 0) sum += shared_in(a, b, {x, y, z}, all);
    return sum * cell;
  }

private:
  struct Body {
    int label;
    std::size_t species;
    const BodyPlace *place;
  };
  std::size_t whose(int b) const { return bodies_[b].species; }
  const SpeciesSpec &spec(int b) const { return species_[whose(b)]; }
  const BodyPlace &place(int b) const { return *bodies_[b].place; }
  PlacedConvex convex(int b) const { return {&shapes_[whose(b)], place(b).centre, rotation(place(b).orientation)}; }

  void find_candidates() {
    Crowd crowd(grid_, widest_ > 0 ? widest_ : grid_.length[0], bodies_.size());  // those with ends
    std::vector<int> in_crowd, endless;
    const auto add = [&](int one, int two) {
      if (!is_wanted(spec(std::min(one, two)), spec(std::max(one, two)))) return;
      candidates_.emplace_back(one, two);
      candidates_.emplace_back(two, one);
    };
    for (int b = 0; b < bodies(); ++b) {
      const bool ends = is_closed(spec(b).shape);
      for (const int other : endless)
        if (!ends || may_meet(other, b)) add(b, other);
      if (ends)
        for (const int c : crowd.touching(convex(b))) add(b, in_crowd[c]);
      else
        for (const int other : in_crowd)
          if (may_meet(b, other)) add(b, other);
      (ends ? in_crowd : endless).push_back(b);
      if (ends) crowd.add(convex(b));
    }
    std::sort(candidates_.begin(), candidates_.end());
  }

  // Returns whether the circumscribed sphere of a body may touch an infinite body. A tube has no images across its
  // axis.
  bool may_meet(int endless, int b) const {
    const double radius = shapes_[whose(b)].outer_radius();
    const Surface &surface = surfaces_[whose(endless)];
    Int3 images{};
    for (int d = 0; d < dimension_; ++d)
      images[d] = grid_.boundary[d] == Boundary::periodic && !(is_tube(spec(endless).shape) && d != spec(endless).axis);
    for (int k = -images[2]; k <= images[2]; ++k)
      for (int j = -images[1]; j <= images[1]; ++j)
        for (int i = -images[0]; i <= images[0]; ++i) {
          const Int3 image{i, j, k};
          Real3 y;
          for (int d = 0; d < 3; ++d) y[d] = place(b).centre[d] + image[d] * grid_.length[d] - place(endless).centre[d];
          if (surface.level(y) < surface.slope(y, radius) * radius) return true;
        }
    return false;
  }

  const std::vector<SpeciesSpec> &species_;
  DomainShape grid_;
  int dimension_;
  std::vector<Surface> surfaces_;   // of species
  std::vector<ConvexBody> shapes_;  // of species
  std::vector<Body> bodies_;
  double widest_ = 0;
  std::vector<std::pair<int, int>> candidates_;
};

}  // namespace

std::vector<int> first_labels(const std::vector<SpeciesSpec> &species, const std::vector<Places> &places) {
  std::vector<int> first{1};
  for (std::size_t s = 0; s < species.size(); ++s)
    first.push_back(first[s] + (species[s].shape == Shape::voxels ? 1 : places[s].count));
  return first;
}

bool may_overlap(const std::vector<SpeciesSpec> &species, const std::vector<Places> &places) {
  bool any = false;
  for (std::size_t t = 0; t < species.size(); ++t)
    for (std::size_t s = 0; s <= t; ++s)
      any = any || (is_wanted(species[s], species[t]) && (s < t || places[s].count > 1));
  return any;
}

std::vector<int> find_overlaps(const std::vector<SpeciesSpec> &species, const std::vector<Places> &places,
                               const DomainShape &grid, Overlap *first) {
  *first = {};
  std::pair<int, int> found;
  bool same_place = false;
  std::vector<int> overlaps;
  const Search search(species, places, grid);
  for (const auto &[b, candidate] : search.candidates()) {
    const std::pair<int, int> pair = std::minmax(b, candidate);
    const bool same = search.at_same_place(b, candidate),
               known = !overlaps.empty() && overlaps.back() == search.label(b);
    if (known && (!same || same_place)) continue;
    if (!same && search.shared(pair.first, pair.second, false) == 0) continue;
    if (overlaps.empty() || (same && !same_place) || (same == same_place && pair < found)) found = pair;
    same_place = same_place || same;
    if (!known) overlaps.push_back(search.label(b));
  }
  if (overlaps.empty()) return overlaps;
  *first = {search.label(found.first), search.label(found.second), search.shared(found.first, found.second, true),
            same_place};
  return overlaps;
}

void add_shared(const SpeciesSpec &spec, const Places &places, const DomainShape &grid, const CellWindow &cells,
                ConstView fraction, std::map<int, SharedVolume> *shared) {
  const Surface surface(spec, grid.dimension());
  const Int3 &first = cells.begin;
  for (const NumberedPlace &place : places.known) {
    const PlacedBody body(surface, grid, place);
    SharedVolume with;
    body.for_cells(first, cells.size, [&](const Int3 &cell, const Int3 &unwrapped) {
      const double solid = fraction(cell[0] - first[0], cell[1] - first[1], cell[2] - first[2]);
      if (!(solid > 0)) return;
      const double more = solid + body.fraction(unwrapped) - 1;
      if (more > excess) with.overlaps = true;
      if (more > 0) with.volume += std::llround(std::ldexp(more, 30));
    });
    if (with.volume == 0) continue;
    SharedVolume &all = (*shared)[place.index];
    all.volume += with.volume;
    all.overlaps = all.overlaps || with.overlaps;
  }
}

}  // namespace eulastic
