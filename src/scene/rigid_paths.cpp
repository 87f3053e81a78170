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

std::string check_path(const Config &config, const SpeciesSpec &spec, const Surface &surface, const BodyPlace &place,
                       int d) {
  const bool turns = spec.turns(config.grid.dimension());
  const double V = spec.motion.velocity[d], length = config.grid.length[d];
  if (V == 0 && !turns) return {};
  const double extent = largest_extent(config, spec, surface, place, d);
  if (!std::isfinite(extent)) return {};
  if (config.grid.boundary[d] != Boundary::wall) {
    if (2 * extent < length) return {};
    return "-" + spec.name + "_" + (turns ? "angular_velocity" : "velocity") + ": the body reaches " + to_text(extent) +
           " from its centre along " + "xyz"[d] + ", half of the periodic box or more; accepted: below " +
           to_text(length / 2);
  }
  const double margin = free_cells * length / config.grid.cells[d];
  const Interval way = reach(spec.motion.of_velocity, config.time.end);
  const double low = place.centre[d] + std::min(V * way.low, V * way.high) - extent;
  const double high = place.centre[d] + std::max(V * way.low, V * way.high) + extent;
  if (low >= margin && high <= length - margin) return {};
  const bool below = low < margin;
  return "-" + spec.name + (V == 0 ? "_angular_velocity: rotates" : "_velocity: carries") + " a body to " + "xyz"[d] +
         " = " + to_text(below ? low : high) + "; accepted: a path between " + to_text(margin) + " and " +
         to_text(length - margin) + ", two cells from the boundaries";
}

// Distance of two bodies at a time; infinite for shapes without a formula here.
double gap_between(const Config &config, const SpeciesSpec &one, const BodyPlace &at, const SpeciesSpec &two,
                   const BodyPlace &place, double time) {
  const int dimension = config.grid.dimension();
  const auto round = [](Shape shape) { return shape == Shape::sphere || shape == Shape::cylinder; };
  if (!round(one.shape) || !(round(two.shape) || two.shape == Shape::tube)) return HUGE_VAL;
  double square = 0;
  for (int d = 0; d < dimension; ++d) {
    if ((one.shape == Shape::cylinder && one.axis == d) || (two.shape != Shape::sphere && two.axis == d)) continue;
    double way = at.centre[d] + shift(one, d, time) - place.centre[d] - shift(two, d, time);
    if (config.grid.boundary[d] == Boundary::periodic) way = std::remainder(way, config.grid.length[d]);
    square += way * way;
  }
  const double distance = std::sqrt(square);
  return two.shape == Shape::tube ? two.radius - one.radius - distance : distance - one.radius - two.radius;
}

// Collisions of a moving species with all others. Collisions that are missed here stop the run when they happen
// (rigid/rigid_bodies.hpp).
std::string check_meetings(const Config &config, std::size_t which) {
  const SpeciesSpec &one = config.species[which];
  const double spacing = config.grid.shortest_spacing();
  for (std::size_t s = 0; s < config.species.size(); ++s) {
    const SpeciesSpec &two = config.species[s];
    if (s == which || two.law != Law::rigid) continue;
    double speed = 0;
    for (const SpeciesSpec *spec : {&one, &two})
      for (const double V : spec->motion.velocity) speed += std::fabs(V);
    const double pairs = double(config.places[which].count) * double(config.places[s].count);
    const double samples = std::min(4 * speed * config.time.end / spacing, most_samples / std::max(1.0, pairs));
    for (const BodyPlace &at : config.places[which].known)
      for (const BodyPlace &place : config.places[s].known)
        for (long n = 0; n <= static_cast<long>(samples) + 1; ++n) {
          const double time = config.time.end * double(n) / (static_cast<double>(static_cast<long>(samples)) + 1);
          if (gap_between(config, one, at, two, place, time) < spacing)
            return "-" + one.name + "_velocity: carries a body to one of " + two.name + " at t = " + to_text(time) +
                   "; accepted: a path with a cell or more between them";
        }
  }
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
    if (!spec.travels(dimension)) continue;
    const std::string option = "-" + spec.name + (spec.turns(dimension) ? "_angular_velocity" : "_velocity") +
                               ": a body that moves or rotates through the grid ";
    if (!config.method.staggered())
      return option + "needs -method fast; accepted here: motion along the surface of the body, or 0,0,0";
    if (config.method.is_single_acm_step())
      return option +
             "needs more than one pressure iteration per step; accepted here: -acm_iterations_max > 1, or motion along "
             "the surface of the body";
    if (has_inlet_generators(config.sides))
      return option + "cannot be combined with an inlet generator; accepted: without -boundary_SIDE_generator_length";
    if (spec.shape == Shape::voxels) continue;
    const Surface surface(spec, dimension);
    for (const BodyPlace &place : config.places[s].known)
      if (const std::string wrong = check_path(config, spec, surface, place); !wrong.empty()) return wrong;
    if (const std::string wrong = check_meetings(config, s); !wrong.empty()) return wrong;
  }
  return {};
}

}  // namespace eulastic
