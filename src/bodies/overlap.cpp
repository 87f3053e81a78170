#include "bodies/overlap.hpp"

#include "bodies/crowd.hpp"
#include "bodies/volume_fraction.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace eulastic {
namespace {

constexpr double excess = 0.01;  // of two fractions in a cell: more than the digits of a list of places
constexpr double skin = 5e-4;    // cells: bodies that only touch need no closer look

bool has_shape(const SpeciesSpec &spec) { return spec.shape != Shape::voxels && spec.shape != Shape::state; }
bool has_ends(const SpeciesSpec &spec) {
  return has_shape(spec) && spec.shape != Shape::cylinder && !is_attached(spec.shape);
}

// Whether a body of `two` is to be compared with one of `one` that comes before it.
bool is_wanted(const SpeciesSpec &one, const SpeciesSpec &two) {
  if (!has_shape(one) || !has_shape(two) || two.placement == Placement::random) return false;
  if (one.material().attached && two.material().attached) return false;
  return &one != &two || two.contact != Contact::merge;
}

// Cells of the box that two bodies may touch, and where each has them.
struct Common {
  int begin, end, shift_a, shift_b;
};

// How much more than full two bodies make a cell.
double shared_in(const PlacedBody &a, const PlacedBody &b, const Common (&range)[3], const Int3 &cell) {
  Int3 in_a, in_b;
  for (int d = 0; d < 3; ++d) in_a[d] = cell[d] + range[d].shift_a, in_b[d] = cell[d] + range[d].shift_b;
  if (a.is_clear_of(in_a) || b.is_clear_of(in_b)) return 0;
  return std::max(0.0, a.fraction(in_a) + b.fraction(in_b) - 1);
}

// What a and b share in a range of cells; unless it is `all` to be counted, the first that is found.
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

class Search {
public:
  Search(const std::vector<SpeciesSpec> &species, const std::vector<std::vector<BodyPlace>> &places,
         const GridSpec &grid, const BodyRange &own)
      : species_(species),
        places_(places),
        grid_(grid),
        dimension_(grid.cells[2] == 1 ? 2 : 3),
        own_(own),
        candidates_(own.size()) {
    double spacing = grid.length[0] / grid.cells[0];
    for (int d = 1; d < dimension_; ++d) spacing = std::min(spacing, grid.length[d] / grid.cells[d]);
    for (std::size_t s = 0; s < species.size(); ++s) {
      surfaces_.emplace_back(species[s], dimension_);
      shapes_.emplace_back(species[s], dimension_, -skin * spacing);
      if (has_ends(species[s])) widest_ = std::max(widest_, 2 * shapes_[s].outer_radius());
      first_.push_back(bodies_);
      bodies_ += species[s].shape == Shape::voxels ? 1 : static_cast<int>(places[s].size());
    }
    find_candidates();
  }

  int bodies() const { return bodies_; }

  // Bodies that may share cells with body b, one of the rank's own, ascending.
  const std::vector<int> &candidates(int b) const { return candidates_[b - own_.begin]; }

  // What two bodies share, or the first part of it that is found.
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
  std::size_t whose(int b) const { return std::upper_bound(first_.begin(), first_.end(), b) - first_.begin() - 1; }
  const SpeciesSpec &spec(int b) const { return species_[whose(b)]; }
  const BodyPlace &place(int b) const { return places_[whose(b)][b - first_[whose(b)]]; }
  PlacedConvex convex(int b) const { return {&shapes_[whose(b)], place(b).centre, rotation(place(b).orientation)}; }

  void find_candidates() {
    Crowd crowd(grid_, widest_ > 0 ? widest_ : grid_.length[0], own_.size());  // the own ones with ends
    std::vector<int> in_crowd, endless;
    Real3 low = grid_.length, high{};  // of their centres
    for (int b = own_.begin; b < own_.end; ++b) {
      if (!has_shape(spec(b))) continue;
      (has_ends(spec(b)) ? in_crowd : endless).push_back(b);
      if (!has_ends(spec(b))) continue;
      crowd.add(convex(b));
      for (int d = 0; d < 3; ++d) {
        low[d] = std::min(low[d], place(b).centre[d]);
        high[d] = std::max(high[d], place(b).centre[d]);
      }
    }
    const auto is_far = [&](const Real3 &centre) {
      for (int d = 0; d < dimension_; ++d) {
        double away = std::abs(centre[d] - (low[d] + high[d]) / 2);
        if (grid_.boundary[d] == Boundary::periodic) away = std::min(away, grid_.length[d] - away);
        if (away > (high[d] - low[d]) / 2 + 1.0001 * widest_) return true;
      }
      return in_crowd.empty();
    };
    const auto add = [&](int own, int other) {
      if (is_wanted(spec(std::min(own, other)), spec(std::max(own, other))))
        candidates_[own - own_.begin].push_back(other);
    };
    for (int other = 0; other < bodies_; ++other) {
      if (!has_shape(spec(other))) continue;
      if (has_ends(spec(other))) {
        for (const int b : endless)
          if (may_meet(b, other)) add(b, other);
        if (is_far(place(other).centre)) continue;
        const auto self = std::lower_bound(in_crowd.begin(), in_crowd.end(), other) - in_crowd.begin();
        const bool is_own = own_.has(other);
        for (const int c : crowd.touching(convex(other), is_own ? self : in_crowd.size())) add(in_crowd[c], other);
      } else {
        for (const int b : in_crowd)
          if (may_meet(other, b)) add(b, other);
        for (const int b : endless)
          if (b != other) add(b, other);
      }
    }
  }

  // Whether the sphere around a body may meet a body without ends. Across its axis a tube has no images.
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
  const std::vector<std::vector<BodyPlace>> &places_;
  GridSpec grid_;
  int dimension_;
  BodyRange own_;
  std::vector<Surface> surfaces_;   // of species
  std::vector<ConvexBody> shapes_;  // of species
  std::vector<int> first_;          // body of a species
  int bodies_ = 0;
  double widest_ = 0;
  std::vector<std::vector<int>> candidates_;  // of own bodies
};

}  // namespace

std::vector<char> find_overlaps(const std::vector<SpeciesSpec> &species,
                                const std::vector<std::vector<BodyPlace>> &places, const GridSpec &grid,
                                const BodyRange &own, Overlap *first) {
  *first = {};
  std::vector<char> overlaps(own.size(), 0);
  bool any = false;
  for (std::size_t t = 0; t < species.size(); ++t)
    for (std::size_t s = 0; s <= t; ++s)
      any = any || (is_wanted(species[s], species[t]) && (s < t || places[s].size() > 1));
  if (!any) return overlaps;
  const Search search(species, places, grid, own);
  for (int b = own.begin; b < own.end; ++b)
    for (const int candidate : search.candidates(b)) {
      const auto [one, two] = std::minmax({b, candidate});
      if (search.shared(one, two, false) == 0) continue;
      overlaps[b - own.begin] = 1;
      if (first->body == 0 || std::pair(one + 1, two + 1) < std::pair(first->body, first->other))
        *first = {one + 1, two + 1, 0};
      break;
    }
  if (first->body > 0) first->volume = search.shared(first->body - 1, first->other - 1, true);
  return overlaps;
}

void add_shared(const SpeciesSpec &spec, const std::vector<BodyPlace> &places, const GridSpec &grid,
                const CellWindow &layers, ConstView fraction, std::map<int, SharedVolume> *shared) {
  const Surface surface(spec, grid.cells[2] == 1 ? 2 : 3);
  const double radius = surface.bounding_radius(), half = layers.size[2] * layers.spacing(2) / 2;
  const double middle = layers.begin[2] * layers.spacing(2) + half, length = grid.length[2];
  for (std::size_t b = 0; b < places.size(); ++b) {
    double distance = std::abs(places[b].centre[2] - middle);
    if (grid.boundary[2] == Boundary::periodic) distance = std::min(distance, length - distance);
    if (distance > half + radius) continue;
    const PlacedBody body(surface, grid, places[b]);
    SharedVolume with;
    for (const PlacedBody::Range &z : body.ranges(2, layers.begin[2], layers.begin[2] + layers.size[2]))
      for (const PlacedBody::Range &y : body.ranges(1, 0, grid.cells[1]))
        for (const PlacedBody::Range &x : body.ranges(0, 0, grid.cells[0]))
          for (int k = z.begin; k < z.end; ++k)
            for (int j = y.begin; j < y.end; ++j)
              for (int i = x.begin; i < x.end; ++i) {
                const double solid = fraction(i, j, k - layers.begin[2]);
                if (!(solid > 0)) continue;
                const double more = solid + body.fraction({i + x.shift, j + y.shift, k + z.shift}) - 1;
                if (more > excess) with.overlaps = true;
                if (more > 0) with.volume += std::llround(std::ldexp(more, 30));
              }
    if (with.volume == 0) continue;
    SharedVolume &all = (*shared)[static_cast<int>(b)];
    all.volume += with.volume;
    all.overlaps = all.overlaps || with.overlaps;
  }
}

}  // namespace eulastic
