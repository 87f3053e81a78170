#include "output/series_columns.hpp"

namespace eulastic {
namespace {

const std::vector<std::string> always{"time",
                                      "step",
                                      "dt",
                                      "kinetic_energy",
                                      "elastic_energy",
                                      "viscous_dissipation",
                                      "bulk_velocity_x",
                                      "bulk_velocity_y",
                                      "bulk_velocity_z",
                                      "speed_max",
                                      "divergence_rms",
                                      "divergence_max",
                                      "solid_volume",
                                      "volume_drift",
                                      "force_power",
                                      "wall_power",
                                      "elastic_power",
                                      "energy_lost",
                                      "energy_lost_elastic",
                                      "energy_lost_extended",
                                      "surface_energy",
                                      "surface_power"};

}  // namespace

std::vector<std::string> series_columns(const std::vector<SideFlow> &sides, const std::vector<VesselFlow> &vessels,
                                        bool adheres) {
  std::vector<std::string> columns = always;
  if (!sides.empty()) columns.emplace_back("side_power");
  for (const SideFlow &side : sides) {
    columns.push_back("flow_rate_" + side.name());
    columns.push_back("pressure_" + side.name());
  }
  for (const VesselFlow &vessel : vessels) {
    columns.push_back(vessel.species + "_flow_rate");
    columns.push_back(vessel.species + "_apparent_viscosity");
  }
  for (const char *name : {"bonds", "bonds_formed", "bonds_broken", "bond_force_x", "bond_force_y", "bond_force_z"})
    if (adheres) columns.emplace_back(name);
  return columns;
}

}  // namespace eulastic
