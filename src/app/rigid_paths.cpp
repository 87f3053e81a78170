#include "app/rigid_paths.hpp"

#include "app/option_values.hpp"
#include "bodies/shapes.hpp"
#include "solver/feeders.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

constexpr int free_cells = 2;  // between a body and a side

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

std::string check_path(const Config &config, const SpeciesSpec &spec, const BodyPlace &place, int d) {
  const int dimension = config.grid.cells[2] == 1 ? 2 : 3;
  const double extent = Surface(spec, dimension).support(rotation(place.orientation)[d]);
  if (config.grid.boundary[d] != Boundary::wall || !std::isfinite(extent) || spec.motion.velocity[d] == 0) return {};
  const double V = spec.motion.velocity[d], length = config.grid.length[d];
  const double margin = free_cells * length / config.grid.cells[d];
  const Interval way = reach(spec.motion.of_velocity, config.time.end);
  const double low = place.centre[d] + std::min(V * way.low, V * way.high) - extent;
  const double high = place.centre[d] + std::max(V * way.low, V * way.high) + extent;
  if (low >= margin && high <= length - margin) return {};
  const bool below = low < margin;
  return "-" + spec.name + "_velocity: carries a body to " + "xyz"[d] + " = " + to_text(below ? low : high) +
         "; accepted: a path between " + to_text(margin) + " and " + to_text(length - margin) + ", two cells from the sides";
}

}  // namespace

std::string check_paths(const Config &config) {
  const int dimension = config.grid.cells[2] == 1 ? 2 : 3;
  for (std::size_t s = 0; s < config.species.size(); ++s) {
    const SpeciesSpec &spec = config.species[s];
    if (!spec.travels(dimension)) continue;
    const std::string option = "-" + spec.name + "_velocity: a body that travels through the grid ";
    if (!config.method.staggered())
      return option + "needs -time_integrator staggered; accepted here: along itself, or 0,0,0";
    if (Feeders::exist(config.sides)) return option + "does not go with a feeder; accepted: without -inflow_SIDE_feeder";
    for (const BodyPlace &place : config.places[s])
      for (int d = 0; d < dimension; ++d)
        if (const std::string wrong = check_path(config, spec, place, d); !wrong.empty()) return wrong;
  }
  return {};
}

}  // namespace eulastic
