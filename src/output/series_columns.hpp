// The header of series.csv.
#pragma once

#include "scene/vessels.hpp"

namespace eulastic {

/// Those of every run, then those of `sides`: side_power and, of each, flow_rate and pressure; then flow rate and
/// apparent viscosity of every vessel; with bonds (`adheres`) their numbers and force.
std::vector<std::string> series_columns(const std::vector<SideFlow> &sides, const std::vector<VesselFlow> &vessels,
                                        bool adheres);

}  // namespace eulastic
