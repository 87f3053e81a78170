#include "scene/rigid_paths.hpp"

#include "io/option_values.hpp"
#include "openings/inlet_generators.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

constexpr int free_cells = 2;         // between a body and a side
constexpr double most_samples = 1e7;  // at pairs of bodies

// Displacement of a body along d.
double shift(const SpeciesSpec &spec, int d, double time) {
  return spec.slides(d) ? 0 : spec.motion.velocity[d] * spec.motion.of_velocity.integral(time);
}

bool has_round_shape(const SpeciesSpec &spec) { return spec.shape == Shape::sphere || spec.shape == Shape::cylinder; }

// Whether a body turns in place without change of its shape. Its surface moves although its faces inside stay the same,
// so that it needs the same free space as a body that travels.
bool spins(const SpeciesSpec &spec, int dimension) {
  return spec.law == Law::rigid && has_round_shape(spec) && spec.motion.angular_velocity != Real3{} &&
         !spec.turns(dimension);
}

struct Interval {
  double low = 0, high = 0;
};

// Of the integral of the factor of the velocity, from time 0.
Interval reach(const Oscillation &factor, double end) {
  if (factor.frequency == 0) {
    const double last = factor.integral(end);
    return {std::min(0.0, last), std::max(0.0, last)};
  }
  const double middle = -std::sin(factor.phase) / factor.frequency, amplitude = 1 / factor.frequency;
  return {middle - amplitude, middle + amplitude};
}

// Its largest extent from its centre along d at any angle that it reaches.
double largest_extent(const Config &config, const SpeciesSpec &spec, const Surface &surface, const BodyPlace &place,
                      int d) {
  const int samples = spec.turns(config.grid.dimension()) ? 360 : 0;  // over a turn at most: within 4e-5 of it
  const Interval way = reach(spec.motion.of_rotation, config.time.end);
  const Real3 &w = spec.motion.angular_velocity;
  const double once = 2 * M_PI / std::hypot(w[0], w[1], w[2]), high = std::min(way.high, way.low + once);
  double extent = 0;
  for (int n = 0; n <= samples; ++n) {
    const double gone = samples > 0 ? way.low + (high - way.low) * n / samples : 0;
    const Rotation R = rotation(turned(place.orientation, {w[0] * gone, w[1] * gone, w[2] * gone}));
    extent = std::max(extent, surface.support(R[d]));
  }
  return extent;
}

// What a body does that comes too close to a boundary along d, with the option that makes it move.
std::string describe_way(const SpeciesSpec &spec, int d, bool turns) {
  const std::string own = "-" + spec.name;
  if (spec.motion.velocity[d] != 0) return own + "_velocity: carries a body to ";
  if (turns) return own + "_angular_velocity: rotates a body to ";
  return own + (spec.motion.velocity != Real3{} ? "_velocity: moves" : "_angular_velocity: rotates") +
         " a body that reaches ";
}

// The profile of an inlet is that of its open part at t = 0, so that no body may move across it.
std::string check_inlets(const Config &config, const SpeciesSpec &spec, int d) {
  if (!spec.travels(config.grid.dimension())) return {};
  for (const int high : {0, 1})
    if (config.sides[d][high].kind == BoundaryKind::inflow)
      return "-" + spec.name + "_velocity: moves a body that covers a part of the inflow boundary " +
             side_name(d, high) + "; accepted: 0,0,0, or a body that ends before this boundary";
  return {};
}

std::string check_path(const Config &config, const SpeciesSpec &spec, const Surface &surface, const BodyPlace &place,
                       int d) {
  const bool turns = spec.turns(config.grid.dimension());
  const double V = spec.motion.velocity[d], length = config.grid.length[d];
  const bool bounded = config.grid.boundary[d] == Boundary::wall;
  const bool in_place = V == 0 && !turns && spins(spec, config.grid.dimension());
  if (V == 0 && !turns && !in_place && !bounded) return {};
  const double extent = largest_extent(config, spec, surface, place, d);
  if (!std::isfinite(extent)) return check_inlets(config, spec, d);
  if (!bounded) {
    const double most = (length - (in_place ? config.grid.spacing(d) : 0)) / 2;
    if (extent < most) return {};
    return "-" + spec.name + "_" + (turns || in_place ? "angular_velocity" : "velocity") + ": the body reaches " +
           to_text(extent) + " from its centre along " + "xyz"[d] +
           (in_place ? ", to within a cell of its periodic image" : ", half of the periodic box or more") +
           "; accepted: below " + to_text(most);
  }
  const double margin = free_cells * length / config.grid.cells[d];
  const Interval way = reach(spec.motion.of_velocity, config.time.end);
  const double low = place.centre[d] + std::min(V * way.low, V * way.high) - extent;
  const double high = place.centre[d] + std::max(V * way.low, V * way.high) + extent;
  if (low >= margin && high <= length - margin) return {};
  const bool below = low < margin;
  return describe_way(spec, d, turns) + "xyz"[d] + " = " + to_text(below ? low : high) + "; accepted: a path between " +
         to_text(margin) + " and " + to_text(length - margin) + ", two cells from the boundaries";
}

// Distance of two bodies at a time; infinite for shapes without a formula here.
double gap_between(const Config &config, const SpeciesSpec &one, const BodyPlace &at, const SpeciesSpec &two,
                   const BodyPlace &place, double time) {
  const int dimension = config.grid.dimension();
  const bool slab = two.shape == Shape::slab;
  if (!has_round_shape(one) || !(has_round_shape(two) || two.shape == Shape::tube || slab)) return HUGE_VAL;
  if (slab && one.shape == Shape::cylinder && one.axis == two.axis) return HUGE_VAL;  // it stands on the slab
  double square = 0;
  for (int d = 0; d < dimension; ++d) {
    if (slab ? two.axis != d
             : (one.shape == Shape::cylinder && one.axis == d) || (two.shape != Shape::sphere && two.axis == d))
      continue;
    const double other = slab ? (two.interval[0] + two.interval[1]) / 2 : place.centre[d];
    double way = at.centre[d] + shift(one, d, time) - other - shift(two, d, time);
    if (config.grid.boundary[d] == Boundary::periodic) way = std::remainder(way, config.grid.length[d]);
    square += way * way;
  }
  const double distance = std::sqrt(square);
  if (slab) return distance - one.radius - (two.interval[1] - two.interval[0]) / 2;
  return two.shape == Shape::tube ? two.radius - one.radius - distance : distance - one.radius - two.radius;
}

// Two bodies that are too close at a time. `one` moves.
std::string describe_meeting(const SpeciesSpec &one, const SpeciesSpec &two, bool travels, double time) {
  const std::string own = "-" + one.name, nearly = "; accepted: a path with a cell or more between them";
  if (travels) return own + "_velocity: carries a body to one of " + two.name + " at t = " + to_text(time) + nearly;
  return own + "_angular_velocity: rotates a body within a cell of one of " + two.name +
         "; accepted: a cell or more between them";
}

// Collisions of a moving species with all others, and of bodies that spin also with each other. Collisions that are
// missed here stop the run when they happen (rigid/rigid_bodies.hpp).
std::string check_meetings(const Config &config, std::size_t which) {
  const SpeciesSpec &one = config.species[which];
  const bool spinning = spins(one, config.grid.dimension());
  const double spacing = config.grid.shortest_spacing();
  for (std::size_t s = 0; s < config.species.size(); ++s) {
    const SpeciesSpec &two = config.species[s];
    if ((s == which && !spinning) || two.law != Law::rigid) continue;
    double speed = 0;
    for (const SpeciesSpec *spec : {&one, &two})
      for (const double V : spec->motion.velocity) speed += s == which ? 0 : std::fabs(V);
    const double pairs = double(config.places[which].count) * double(config.places[s].count);
    const double samples = std::min(4 * speed * config.time.end / spacing, most_samples / std::max(1.0, pairs));
    for (const NumberedPlace &at : config.places[which].known)
      for (const NumberedPlace &place : config.places[s].known) {
        if (s == which && place.index <= at.index) continue;
        for (long n = 0; n <= static_cast<long>(samples) + 1; ++n) {
          const double time = config.time.end * double(n) / (static_cast<double>(static_cast<long>(samples)) + 1);
          if (gap_between(config, one, at, two, place, time) < spacing)
            return describe_meeting(one, two, speed > 0, time);
        }
      }
  }
  return {};
}

// What the method must be for a species that travels.
std::string check_method_of_travel(const Config &config, const SpeciesSpec &spec) {
  const std::string option = "-" + spec.name +
                             (spec.turns(config.grid.dimension()) ? "_angular_velocity" : "_velocity") +
                             ": a body that moves or rotates through the grid ";
  if (!config.method.staggered())
    return option + "needs -method fast; accepted here: motion along the surface of the body, or 0,0,0";
  if (config.method.is_single_acm_step())
    return option +
           "needs more than one pressure iteration per step; accepted here: -acm_iterations_max > 1, or motion along "
           "the surface of the body";
  if (has_inlet_generators(config.sides))
    return option + "cannot be combined with an inlet generator; accepted: without -boundary_SIDE_generator_length";
  return {};
}

}  // namespace

std::string check_path(const Config &config, const SpeciesSpec &spec, const Surface &surface, const BodyPlace &place) {
  for (int d = 0; d < config.grid.dimension(); ++d)
    if (std::string wrong = check_path(config, spec, surface, place, d); !wrong.empty()) return wrong;
  return {};
}

std::string check_paths(const Config &config) {
  const int dimension = config.grid.dimension();
  for (std::size_t s = 0; s < config.species.size(); ++s) {
    const SpeciesSpec &spec = config.species[s];
    if (!spec.travels(dimension) && !spins(spec, dimension)) continue;
    if (spec.travels(dimension))
      if (std::string wrong = check_method_of_travel(config, spec); !wrong.empty()) return wrong;
    if (spec.shape == Shape::voxels) continue;
    const Surface surface(spec, dimension);
    for (const BodyPlace &place : config.places[s].known)
      if (const std::string wrong = check_path(config, spec, surface, place); !wrong.empty()) return wrong;
    if (const std::string wrong = check_meetings(config, s); !wrong.empty()) return wrong;
  }
  return {};
}

}  // namespace eulastic
