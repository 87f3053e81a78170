#include "bodies/overlap.hpp"

#include "bodies/crowd.hpp"
#include "bodies/volume_fraction.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>

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
         const GridSpec &grid)
      : species_(species), places_(places), grid_(grid), dimension_(grid.cells[2] == 1 ? 2 : 3) {
    double spacing = grid.length[0] / grid.cells[0], widest = 0;
    for (int d = 1; d < dimension_; ++d) spacing = std::min(spacing, grid.length[d] / grid.cells[d]);
    for (std::size_t s = 0; s < species.size(); ++s) {
      surfaces_.emplace_back(species[s], dimension_);
      shapes_.emplace_back(species[s], dimension_, -skin * spacing);
      if (has_ends(species[s])) widest = std::max(widest, 2 * shapes_[s].outer_radius());
      first_.push_back(static_cast<int>(whose_.size()));
      const std::size_t count = species[s].shape == Shape::voxels ? 1 : places[s].size();
      whose_.insert(whose_.end(), count, static_cast<int>(s));
    }
    crowd_ = std::make_unique<Crowd>(grid, widest > 0 ? widest : grid.length[0], whose_.size());
    for (int b = 0; b < bodies(); ++b) {
      in_crowd_.push_back(-1);
      if (!has_ends(spec(b))) {
        if (has_shape(spec(b))) endless_.push_back(b);
        continue;
      }
      in_crowd_[b] = static_cast<int>(from_crowd_.size());
      from_crowd_.push_back(b);
      crowd_->add({&shapes_[whose_[b]], place(b).centre, rotation(place(b).orientation)});
    }
  }

  int bodies() const { return static_cast<int>(whose_.size()); }

  // Bodies before b that may share cells with it, ascending.
  std::vector<int> candidates(int b) const {
    std::vector<int> others;
    const auto add = [&](int other) {
      if (other < b && is_wanted(spec(other), spec(b))) others.push_back(other);
    };
    if (in_crowd_[b] >= 0) {
      for (const int c : crowd_->touching(in_crowd_[b])) add(from_crowd_[c]);
      for (const int other : endless_)
        if (may_meet(other, b)) add(other);
    } else if (has_shape(spec(b))) {
      for (int other = 0; other < b; ++other)
        if (in_crowd_[other] < 0 || may_meet(b, other)) add(other);
    }
    std::sort(others.begin(), others.end());
    return others;
  }

  // What two bodies share, or the first part of it that is found.
  double shared(int one, int two, bool all) const {
    const PlacedBody a(surfaces_[whose_[one]], grid_, place(one)), b(surfaces_[whose_[two]], grid_, place(two));
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
  const SpeciesSpec &spec(int b) const { return species_[whose_[b]]; }
  const BodyPlace &place(int b) const { return places_[whose_[b]][b - first_[whose_[b]]]; }

  // Whether the sphere around a body may meet a body without ends. Across its axis a tube has no images.
  bool may_meet(int endless, int b) const {
    const double radius = shapes_[whose_[b]].outer_radius();
    const Surface &surface = surfaces_[whose_[endless]];
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
  std::vector<Surface> surfaces_;                     // of species
  std::vector<ConvexBody> shapes_;                    // of species
  std::vector<int> first_;                            // body of a species
  std::vector<int> whose_;                            // species of a body
  std::vector<int> in_crowd_, from_crowd_, endless_;  // bodies
  std::unique_ptr<Crowd> crowd_;
};

}  // namespace

std::vector<char> find_overlaps(const std::vector<SpeciesSpec> &species,
                                const std::vector<std::vector<BodyPlace>> &places, const GridSpec &grid, int part,
                                int parts, Overlap *first) {
  *first = {};
  bool any = false;
  for (std::size_t t = 0; t < species.size(); ++t)
    for (std::size_t s = 0; s <= t; ++s)
      any = any || (is_wanted(species[s], species[t]) && (s < t || places[s].size() > 1));
  if (!any) return {};
  const Search search(species, places, grid);
  std::vector<char> overlaps(search.bodies(), 0);
  const auto limit = [&](int p) { return static_cast<int>(std::int64_t{search.bodies()} * p / parts); };
  for (int b = limit(part); b < limit(part + 1); ++b)
    for (const int other : search.candidates(b)) {
      if ((overlaps[b] && overlaps[other]) || search.shared(other, b, false) == 0) continue;
      overlaps[b] = overlaps[other] = 1;
      if (first->body == 0 || other + 1 < first->body) *first = {other + 1, b + 1, 0};
    }
  if (first->body > 0) first->volume = search.shared(first->body - 1, first->other - 1, true);
  return overlaps;
}

void add_shared(const SpeciesSpec &spec, const std::vector<BodyPlace> &places, const GridSpec &grid,
                const CellWindow &layers, ConstView fraction, SharedVolumes *shared) {
  const Surface surface(spec, grid.cells[2] == 1 ? 2 : 3);
  const double radius = surface.bounding_radius(), half = layers.size[2] * layers.spacing(2) / 2;
  const double middle = layers.begin[2] * layers.spacing(2) + half, length = grid.length[2];
  for (std::size_t b = 0; b < places.size(); ++b) {
    double distance = std::abs(places[b].centre[2] - middle);
    if (grid.boundary[2] == Boundary::periodic) distance = std::min(distance, length - distance);
    if (distance > half + radius) continue;
    const PlacedBody body(surface, grid, places[b]);
    for (const PlacedBody::Range &z : body.ranges(2, layers.begin[2], layers.begin[2] + layers.size[2]))
      for (const PlacedBody::Range &y : body.ranges(1, 0, grid.cells[1]))
        for (const PlacedBody::Range &x : body.ranges(0, 0, grid.cells[0]))
          for (int k = z.begin; k < z.end; ++k)
            for (int j = y.begin; j < y.end; ++j)
              for (int i = x.begin; i < x.end; ++i) {
                const double solid = fraction(i, j, k - layers.begin[2]);
                if (!(solid > 0)) continue;
                const double more = solid + body.fraction({i + x.shift, j + y.shift, k + z.shift}) - 1;
                if (more > excess) shared->overlaps[b] = 1;
                if (more > 0) shared->volume[b] += std::llround(std::ldexp(more, 30));
              }
  }
}

}  // namespace eulastic
