#include "bodies/seeding.hpp"

#include "base/one_line.hpp"
#include "bodies/packing.hpp"
#include "bodies/random.hpp"
#include "bodies/relaxation.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

constexpr double degrees = 180 / 3.14159265358979323846;
constexpr int least_rounds = 12, most_rounds = 2000;  // trial moves of each body
constexpr int least_rounds_of_copies = 2;
constexpr std::size_t all_tries = 1000000;  // trial moves of all bodies together, which limit the rounds
constexpr int insertions = 2000;            // random insertions tried for a body without a site
constexpr std::size_t most_single = 20000;  // above this number bodies start as copies of a periodic block
constexpr double block_bodies = 3000;
constexpr double small_turn = 25;   // degrees
constexpr double small_step = 0.3;  // in inner radii

// Returns the angles about x, y, z of a rotation, in degrees; the inverse of rotation().
Real3 angles(const Rotation &q) {
  return {std::atan2(q[2][1], q[2][2]) * degrees, std::asin(std::clamp(-q[2][0], -1.0, 1.0)) * degrees,
          std::atan2(q[1][0], q[0][0]) * degrees};
}

Rotation product(const Rotation &p, const Rotation &q) {
  Rotation r{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r[i][j] = p[i][0] * q[0][j] + p[i][1] * q[1][j] + p[i][2] * q[2][j];
  return r;
}

// Returns the orientations with which regular packings are tried, in degrees.
std::vector<Real3> orientations(const SpeciesSpec &spec, int dimension) {
  if (!spec.random_orientation) return {spec.orientation};
  if (dimension == 2) return {{}, {0, 0, 90}};
  return {{}, {90, 0, 0}, {0, 0, 90}, {0, 90, 0}};
}

class Seeding {
public:
  Seeding(const SpeciesSpec &spec, const DomainShape &grid, const Region &region, Crowd *crowd, const ConvexBody &shape)
      : spec_(spec),
        grid_(grid),
        dimension_(grid.dimension()),
        region_(region),
        crowd_(*crowd),
        shape_(shape),
        random_(spec.seed, spec.name),
        first_(crowd->size()) {}

  /// Places up to `count` bodies and returns their number.
  std::size_t place(std::size_t count, std::vector<BodyPlace> *places) {
    std::vector<BodyPlace> sites;
    if (count > most_single) sites = repeat_block(count);
    const bool repeated = sites.size() >= count;
    if (!repeated)
      sites = find_packing(region_, crowd_, grid_, shape_, orientations(spec_, dimension_), count + count / 2);
    places->clear();
    places->reserve(count);
    // In order, so that neighbours stay close in memory.
    for (std::size_t s = 0; s < sites.size() && places->size() < count; ++s) {
      if (random_.below(sites.size() - s) >= count - places->size()) continue;
      places->push_back(sites[s]);
      crowd_.add(convex(sites[s]));
    }
    for (int failures = 0; places->size() < count && failures < insertions;) {
      const BodyPlace place = anywhere();
      failures = fits(place) ? 0 : failures + 1;
      if (failures > 0) continue;
      places->push_back(place);
      crowd_.add(convex(place));
    }
    if (places->size() == count) shuffle(repeated, places);
    return places->size();
  }

private:
  PlacedConvex convex(const BodyPlace &place) const { return {&shape_, place.centre, rotation(place.orientation)}; }
  bool fits(const BodyPlace &place, std::size_t except = Crowd::nobody) const {
    const PlacedConvex body = convex(place);
    return region_.holds(body) && crowd_.has_room_for(body, except);
  }

  BodyPlace anywhere() {
    BodyPlace place{{0, 0, grid_.length[2] / 2}, spec_.orientation};
    for (int d = 0; d < dimension_; ++d) place.centre[d] = random_.between(region_.low(d), region_.high(d));
    if (spec_.random_orientation) place.orientation = random_.orientation(dimension_);
    return place;
  }
  BodyPlace nearby(BodyPlace place, const Rotation &turned) {
    const double step = small_step * shape_.inner_radius();
    for (int d = 0; d < dimension_; ++d) {
      double &x = place.centre[d];
      x += random_.between(-step, step);
      if (grid_.boundary[d] == Boundary::periodic) x -= std::floor(x / grid_.length[d]) * grid_.length[d];
      x = std::clamp(x, 0.0, grid_.length[d]);
    }
    if (!spec_.random_orientation) return place;
    Real3 turn{};
    for (int d = dimension_ == 2 ? 2 : 0; d < 3; ++d) turn[d] = random_.between(-small_turn, small_turn);
    place.orientation = angles(product(rotation(turn), turned));
    return place;
  }

  // Seeds a periodic block of the domain and repeats it: these sites are random already. Returns none if the block has
  // too few.
  std::vector<BodyPlace> repeat_block(std::size_t count) const {
    const double share = std::min(1.0, block_bodies / double(count)), least = 6 * shape_.outer_radius();
    const double side = std::pow(share * region_.volume(), 1.0 / dimension_);
    DomainShape block = grid_;
    Int3 copies{1, 1, 1};
    double volume = 1;
    for (int d = 0; d < dimension_; ++d) {
      copies[d] = std::max(1, static_cast<int>(grid_.length[d] / std::max(side, least)));
      block.length[d] /= copies[d];
      block.boundary[d] = Boundary::periodic;
      volume *= block.length[d];
    }
    SpeciesSpec spec = spec_;
    spec.name += " block";  // its own stream of random numbers
    spec.inside.clear();
    std::vector<BodyPlace> places, sites;
    for (const double more : {1.15, 1.05}) {  // some copies overlap walls and earlier species
      spec.number = static_cast<long>(std::ceil(more * double(count) * volume / region_.volume()));
      if (!seed_bodies({spec}, 0, block, {}, {}, &places, false).empty()) continue;
      sites.clear();
      for_points({{}, copies}, [&](int i, int j, int k) {
        for (BodyPlace place : places) {
          for (int d = 0; d < dimension_; ++d) place.centre[d] += Int3{i, j, k}[d] * block.length[d];
          if (fits(place)) sites.push_back(place);
        }
      });
      if (sites.size() >= count) return sites;
    }
    return {};
  }

  // Moves bodies at random. Copies of a block are random already, and some were left out: small moves remove the rest
  // of their likeness.
  void shuffle(bool copies, std::vector<BodyPlace> *places) {
    std::vector<bool> far(places->size());
    std::size_t moved = places->size();
    const int least = copies ? least_rounds_of_copies : least_rounds;
    const int rounds = std::clamp(static_cast<int>(all_tries / (places->size() + 1)), least, most_rounds);
    for (int round = 0; round < rounds; ++round) {
      const bool try_far = rounds > least || (!copies && moved > places->size() / 50);  // otherwise it rarely succeeds
      moved = 0;
      for (std::size_t b = 0; b < places->size(); ++b) {
        if (far[b]) continue;
        BodyPlace to;
        if (try_far) far[b] = fits(to = anywhere(), first_ + b);
        moved += far[b];
        if (!far[b] && !fits(to = nearby((*places)[b], crowd_[first_ + b].rotation), first_ + b)) continue;
        (*places)[b] = to;
        crowd_.move(first_ + b, convex(to));
      }
    }
  }

  const SpeciesSpec &spec_;
  const DomainShape &grid_;
  int dimension_;
  const Region &region_;
  Crowd &crowd_;
  const ConvexBody &shape_;
  Random random_;
  std::size_t first_;  // index of this species' first body in the crowd
};

std::string too_many(const SpeciesSpec &spec, std::size_t count, std::size_t placed, double hematocrit) {
  const std::string gap = spec.gap > 0 ? print(", or a -%s_gap below %.3g", spec.name.c_str(), spec.gap) : "";
  return print("-%s_%s: %zu bodies do not fit; %zu could be placed, hematocrit %.4g; accepted: fewer bodies",
               spec.name.c_str(), spec.number >= 0 ? "count" : "hematocrit", count, placed, hematocrit) +
         gap;
}

}  // namespace

std::string seed_bodies(const std::vector<SpeciesSpec> &species, std::size_t which, const DomainShape &grid,
                        const SolidBodies &solids, const std::vector<Places> &earlier, std::vector<BodyPlace> *places,
                        bool relax) {
  const SpeciesSpec &spec = species[which];
  const int dimension = grid.dimension();
  const SpeciesSpec *vessel = nullptr;
  bool found = spec.inside.empty();
  for (const SpeciesSpec &other : species) {
    found = found || (other.shape == Shape::voxels && spec.inside == other.name);  // all bodies avoid its wall
    if (!is_tube(other.shape) || !(spec.inside.empty() || spec.inside == other.name)) continue;
    if (vessel) return "-" + spec.name + "_inside: there are several tubes; accepted: the name of one of them";
    vessel = &other;
  }
  if (!vessel && !found)
    return "-" + spec.name + "_inside: " + spec.inside +
           " is not a species of tubes or voxels; accepted: the name of one";
  const double margin = spec.is_membrane() ? std::max(grid.longest_spacing() - spec.gap / 2, 0.0) : 0;
  const Region region(species, earlier, vessel, solids, grid, margin);
  const double body = shape_volume(spec, dimension);
  const double wanted = spec.number >= 0 ? double(spec.number) : std::round(spec.hematocrit * region.volume() / body);
  if (!(wanted <= most_bodies))
    return "-" + spec.name + (spec.number >= 0 ? "_count" : "_hematocrit") + ": too many bodies; accepted: at most " +
           std::to_string(most_bodies) + " bodies";
  const std::size_t count = static_cast<std::size_t>(wanted);

  std::vector<ConvexBody> shapes;
  shapes.reserve(which + 1);  // bodies keep pointers to its elements
  std::size_t all = count;
  double widest = 0;
  for (std::size_t s = 0; s <= which; ++s) {
    const bool own = s == which;
    shapes.emplace_back(species[s], dimension,
                        own || species[s].placement == Placement::random ? species[s].gap / 2 : 0);
    if (!own && !is_closed(species[s].shape)) continue;  // part of the region
    widest = std::max(widest, 2 * shapes.back().outer_radius());
    if (!own) all += earlier[s].count;
  }
  Crowd crowd(grid, widest, all);
  for (std::size_t s = 0; s < which; ++s)
    if (is_closed(species[s].shape))
      for (const BodyPlace &place : earlier[s].known)
        crowd.add({&shapes[s], place.centre, rotation(place.orientation)});
  const Crowd others = crowd;
  std::size_t placed = Seeding(spec, grid, region, &crowd, shapes[which]).place(count, places);
  if (placed < count && relax)
    placed = std::max(placed, relax_crowd(spec, grid, region, others, orientations(spec, dimension), count, places));
  return placed < count ? too_many(spec, count, placed, placed > 0 ? double(placed) * body / region.volume() : 0) : "";
}

}  // namespace eulastic
