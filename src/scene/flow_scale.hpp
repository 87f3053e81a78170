// Estimates the speed, length and shear rate of the flow from the options alone, for -check_only.
#pragma once

#include "scene/config.hpp"

#include <optional>

namespace eulastic {

/// Number of bodies of a species and the volume of one of them in the box, in 2-D its area; 0 for an initial state.
struct BodyCount {
  double count = 0, volume = 0;
  double total() const { return count * volume; }
};
BodyCount count_bodies(const Config &config, std::size_t species);

/// Whether the species is a wall to the flow (vessel, obstacle, slab) and not a cell that the flow carries along.
bool is_wall_species(const Config &config, std::size_t species);

struct FlowScale {
  Real3 speed{};                ///< largest expected |u|, |v|, |w|; 0 without a driving force
  bool speed_is_bound = false;  ///< walls of unknown distance slow the flow: `speed` is an upper bound
  double length = 0;            ///< width of the lumen or between the nearest walls, else the shortest side of the box
  std::optional<double> shear_rate;  ///< largest expected; empty if the options do not determine it
  double largest_speed() const;
};

/// The estimate for a parsed configuration.
FlowScale flow_scale(const Config &config);

}  // namespace eulastic
