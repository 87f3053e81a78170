#include "options/renamed_options.hpp"

#include <regex>

namespace eulastic {

const std::vector<RenamedOption> &renamed_options() {
  static const std::vector<RenamedOption> table{
      {"wall_SIDE_velocity", "boundary_SIDE_velocity"},
      {"wall_SIDE_frequency", "boundary_SIDE_angular_frequency"},
      {"wall_SIDE_phase", "boundary_SIDE_phase"},
      {"inflow_SIDE_velocity", "boundary_SIDE_velocity"},
      {"inflow_SIDE_flow_rate", "boundary_SIDE_flow_rate"},
      {"inflow_SIDE_profile", "boundary_SIDE_profile"},
      {"inflow_SIDE_frequency", "boundary_SIDE_angular_frequency"},
      {"inflow_SIDE_phase", "boundary_SIDE_phase"},
      {"inflow_SIDE_period", "boundary_SIDE_table_period"},
      {"inflow_SIDE_hold", "boundary_SIDE_table_hold"},
      {"inflow_SIDE_feeder", "boundary_SIDE_generator_length"},
      {"pressure_SIDE_value", "boundary_SIDE_pressure"},
      {"pressure_SIDE_table", "boundary_SIDE_pressure"},
      {"pressure_SIDE_period", "boundary_SIDE_table_period"},
      {"pressure_SIDE_hold", "boundary_SIDE_table_hold"},
      {"pressure_SIDE_resistance", "boundary_SIDE_resistance"},
      {"pressure_SIDE_windkessel", "boundary_SIDE_windkessel"},
      {"pressure_SIDE_windkessel_start", "boundary_SIDE_windkessel_initial_pressure"},
      {"body_force_frequency", "body_force_angular_frequency"},
      {"NAME_body_force_frequency", "NAME_body_force_angular_frequency"},
      {"NAME_velocity_frequency", "NAME_velocity_angular_frequency"},
      {"NAME_angular_velocity_frequency", "NAME_angular_velocity_angular_frequency"},
      {"NAME_membrane", "NAME_membrane_law"},
      {"NAME_area_modulus", "NAME_skalak_c"},
      {"NAME_stretch_volume", "NAME_stretch_volume_fraction"},
      {"NAME_attached", "NAME_anchored"},
      {"acm_sweeps_max", "acm_iterations_max"},
      {"acm_memory", "acm_search_directions"},
      {"balance", "load_balance"},
  };
  return table;
}

std::string present_name(const std::string &name) {
  static const std::regex placeholder("SIDE|NAME");
  static const std::vector<std::regex> patterns = [] {
    std::vector<std::regex> found;
    for (const RenamedOption &option : renamed_options()) {
      const bool of_side = option.former.find("SIDE") != std::string::npos;
      found.emplace_back(std::regex_replace(option.former, placeholder, of_side ? "([xyz](?:min|max))" : "(.+)"));
    }
    return found;
  }();
  std::smatch found;
  for (std::size_t p = 0; p < patterns.size(); ++p)
    if (std::regex_match(name, found, patterns[p]))
      return std::regex_replace(renamed_options()[p].now, placeholder, found.size() > 1 ? found[1].str() : "");
  return {};
}

}  // namespace eulastic
