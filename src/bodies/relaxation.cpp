#include "bodies/relaxation.hpp"

#include "bodies/packing.hpp"
#include "bodies/random.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

constexpr double densest = 0.7;   // largest volume fraction of the region that is tried
constexpr double skin = 0.01;     // margin around bodies while they move, in inner radii
constexpr double finer = 1.02;    // ratio of successive sizes for which a packing is sought
constexpr double growth = 1.005;  // growth of the size in one step
constexpr int melting = 100;      // rounds of random moves before bodies grow
constexpr int patience = 400;     // rounds at full size within which the overlap must fall by a quarter
constexpr int tries = 6;          // trial moves of an overlapping body in one round
constexpr int inward_tries = 40;  // trial moves of a body that has grown out of the region
constexpr double least_moves = 4e6, moves_of_body = 1500, most_moves = 2e7;
constexpr double pi = 3.14159265358979323846;

double dot(const Real3 &a, const Real3 &b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Real3 cross(const Real3 &a, const Real3 &b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// Returns the sum of the squared penetration depths; squares make bodies share an overlap evenly.
double overlap(const std::vector<Penetration> &contacts) {
  double sum = 0;
  for (const Penetration &contact : contacts) sum += contact.depth * contact.depth;
  return sum;
}

class Relaxation {
public:
  Relaxation(const SpeciesSpec &spec, const DomainShape &grid, const Region &region, const Crowd &others,
             const std::vector<Real3> &orientations, std::size_t count)
      : spec_(spec),
        grid_(grid),
        dimension_(grid.dimension()),
        region_(region),
        others_(others),
        orientations_(orientations),
        count_(count),
        shape_(spec, dimension_, spec.gap / 2),
        wide_(spec, dimension_, spec.gap / 2 + skin * shape_.inner_radius()),
        now_(wide_),
        crowd_(others),
        random_(spec.seed, spec.name + " relaxation") {}

  std::size_t run(std::vector<BodyPlace> *places) {
    if (double(count_) * volume() > densest * region_.volume()) return 0;
    const double moves = std::clamp(moves_of_body * double(count_), least_moves, most_moves);
    std::size_t most = 0;
    for (int attempt = 1; most < count_ && (attempt == 1 || moved_ < moves); ++attempt) {
      if (!begin(attempt % 2 == 1 ? 1.05 : 1.25)) return most;
      most = std::max(most, grow(attempt % 2 == 1 ? 60 : 200, moves) ? count_ : clear_ones());
    }
    *places = places_;
    return most;
  }

private:
  struct Round {
    double overlap = 0, deepest = 0;
    std::size_t outside = 0;  ///< number of bodies outside the region
  };

  PlacedConvex convex(const BodyPlace &place, const ConvexBody &shape) const {
    return {&shape, place.centre, rotation(place.orientation)};
  }

  // Estimates the volume of a body with its gap from its widths.
  double volume() const {
    const ConvexBody bare(spec_, dimension_, 0);
    double volume = shape_volume(spec_, dimension_);
    for (int d = 0; d < dimension_; ++d) volume *= convex({}, shape_).half_width(d) / convex({}, bare).half_width(d);
    return volume;
  }

  // Finds the largest size at which a regular packing has enough sites, and places the bodies on random sites of it,
  // smaller by the factor `looser`. Returns whether there is such a packing.
  bool begin(double looser) {
    std::vector<BodyPlace> sites;
    double widest = wide_.outer_radius();
    for (std::size_t b = 0; b < others_.size(); ++b) widest = std::max(widest, others_[b].body->outer_radius());
    crowd_ = Crowd(grid_, 2 * widest, others_.size() + count_);
    for (std::size_t b = 0; b < others_.size(); ++b) crowd_.add(others_[b]);
    for (scale_ = 1; sites.size() < count_; scale_ /= finer) {
      if (scale_ < 0.3) return false;
      now_ = wide_.scaled(scale_);
      sites = find_packing(region_, crowd_, grid_, now_, orientations_, count_);
    }
    scale_ = std::min(1.0, scale_ * finer) / looser;
    now_ = wide_.scaled(scale_);
    places_.clear();
    for (std::size_t s = 0; places_.size() < count_; ++s) {
      if (random_.below(sites.size() - s) >= count_ - places_.size()) continue;
      places_.push_back(sites[s]);
      crowd_.add(convex(sites[s], now_));
    }
    return true;
  }

  // Grows the bodies to full size with at most `most_waiting` rounds at each size, and returns whether none overlap.
  bool grow(int most_waiting, double most) {
    double before = HUGE_VAL;
    for (int round = 0, waited = 0; moved_ < most; ++round, ++waited) {
      const Round now = move_all();
      if (round < melting) continue;
      const bool settled = now.outside == 0 && now.deepest < 2 * skin * shape_.inner_radius();
      if (scale_ == 1 && settled && is_clear()) return true;
      if (scale_ == 1 && waited >= (settled ? 5 : 1) * patience) {
        if (now.overlap > 0.75 * before) return false;
        before = now.overlap;
        waited = 0;
      }
      if (scale_ == 1 || !(settled || waited >= most_waiting)) continue;
      scale_ = std::min(1.0, scale_ * growth);
      now_ = wide_.scaled(scale_);
      waited = 0;
    }
    return false;
  }

  BodyPlace moved(BodyPlace place, const Real3 &step, const Real3 &turn) const {
    for (int d = 0; d < dimension_; ++d) {
      double &x = place.centre[d];
      x += step[d];
      if (grid_.boundary[d] == Boundary::periodic) x -= std::floor(x / grid_.length[d]) * grid_.length[d];
      x = std::clamp(x, 0.0, grid_.length[d]);
    }
    if (!spec_.random_orientation) return place;
    if (dimension_ == 2)
      place.orientation[2] = std::remainder(place.orientation[2] + turn[2] * (180 / pi), 360.0);
    else
      place.orientation = turned(place.orientation, turn);
    return place;
  }

  // Moves a body away from those that it overlaps and turns it by the torque of the contacts.
  BodyPlace pushed(const BodyPlace &place, const std::vector<Penetration> &contacts, double part) const {
    const double inertia = 0.3 * shape_.outer_radius() * shape_.outer_radius();
    Real3 step{}, turn{};
    for (const Penetration &with : contacts) {
      const Real3 arm = cross(with.point, with.normal);
      const double share = part * with.depth / (1 + dot(arm, arm) / inertia);
      for (int d = 0; d < 3; ++d) {
        step[d] -= share * with.normal[d];
        turn[d] -= share * arm[d] / inertia;
      }
    }
    return moved(place, step, turn);
  }

  BodyPlace nearby(const BodyPlace &place) {
    const double reach = shape_.inner_radius() * std::exp(random_.between(std::log(0.01), std::log(0.5)));
    const double angle = 2 * reach / shape_.outer_radius();
    Real3 step, turn;
    for (double &q : step) q = random_.between(-reach, reach);
    for (double &q : turn) q = random_.between(-angle, angle);
    return moved(place, step, turn);
  }

  std::vector<Penetration> contacts_of(std::size_t b) const {
    return crowd_.penetrations(crowd_[others_.size() + b], others_.size() + b);
  }
  // Sets the shape of all bodies.
  void set_shape(const ConvexBody &shape) {
    for (std::size_t b = 0; b < places_.size(); ++b) crowd_.move(others_.size() + b, convex(places_[b], shape));
  }

  // Moves body b to `to` if that lies in the region and the overlap there is below `*most`, or is 0; updates `*most`.
  bool move(std::size_t b, const BodyPlace &to, double *most) {
    const PlacedConvex body = convex(to, now_);
    ++moved_;
    if (!region_.holds(body)) return false;
    const double there = overlap(crowd_.penetrations(body, others_.size() + b));
    if (there > *most || (there == *most && there > 0)) return false;
    *most = there;
    places_[b] = to;
    crowd_.move(others_.size() + b, body);
    return true;
  }

  // Moves every body once; returns what was found before.
  Round move_all() {
    Round sum;
    for (std::size_t b = 0; b < places_.size(); ++b) {
      const PlacedConvex &body = crowd_[others_.size() + b];
      if (!region_.holds(body)) {
        const BodyPlace from = places_[b];
        double most = HUGE_VAL;
        for (int n = 0; n < inward_tries; ++n) (void)move(b, nearby(from), &most);
        ++sum.outside;
        continue;
      }
      const std::vector<Penetration> contacts = contacts_of(b);
      double depth = overlap(contacts);
      sum.overlap += depth;
      for (const Penetration &with : contacts) sum.deepest = std::max(sum.deepest, with.depth);
      bool done = depth > 0 && (move(b, pushed(places_[b], contacts, 0.7), &depth) ||
                                move(b, pushed(places_[b], contacts, 0.25), &depth));
      for (int n = contacts.empty() ? tries : 2; n <= tries && !done; ++n) done = move(b, nearby(places_[b]), &depth);
    }
    return sum;
  }

  bool is_clear() {
    set_shape(shape_);
    bool clear = true;
    for (std::size_t b = 0; b < places_.size() && clear; ++b) clear = contacts_of(b).empty();
    if (!clear) set_shape(now_);
    return clear;
  }

  // Counts the bodies that remain after those outside the region, and then those with the most overlaps, are removed.
  std::size_t clear_ones() {
    std::vector<std::vector<Penetration>> contacts(places_.size());
    std::vector<bool> gone(places_.size());
    set_shape(shape_);
    for (std::size_t b = 0; b < places_.size(); ++b) {
      contacts[b] = contacts_of(b);
      gone[b] = !region_.holds(crowd_[others_.size() + b]);
    }
    const auto number = [&](std::size_t b) {
      const int own = static_cast<int>(others_.size());
      return std::count_if(contacts[b].begin(), contacts[b].end(),
                           [&](const Penetration &with) { return with.other < own || !gone[with.other - own]; });
    };
    std::size_t left = 0;
    for (long most = 100; most >= 0; --most)
      for (std::size_t b = 0; b < places_.size(); ++b) {
        if (gone[b] || number(b) < most) continue;
        if (most > 0) gone[b] = true;
        left += most == 0;
      }
    return left;
  }

  const SpeciesSpec &spec_;
  const DomainShape &grid_;
  int dimension_;
  const Region &region_;
  const Crowd &others_;
  const std::vector<Real3> &orientations_;
  std::size_t count_;
  ConvexBody shape_, wide_, now_;  ///< full size; full size with the skin; present size
  Crowd crowd_;                    ///< refers to the three shapes
  Random random_;
  std::vector<BodyPlace> places_;
  double scale_ = 1, moved_ = 0;
};

}  // namespace

std::size_t relax_crowd(const SpeciesSpec &spec, const DomainShape &grid, const Region &region, const Crowd &others,
                        const std::vector<Real3> &orientations, std::size_t count, std::vector<BodyPlace> *places) {
  return Relaxation(spec, grid, region, others, orientations, count).run(places);
}

}  // namespace eulastic
