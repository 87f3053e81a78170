// The header of series.csv.
#pragma once

#include "diagnostics/side_flows.hpp"

namespace eulastic {

/// Those of every run, then those of `sides`: side_power and, of each, flow_rate and pressure.
std::vector<std::string> series_columns(const std::vector<SideFlow> &sides);

}  // namespace eulastic
