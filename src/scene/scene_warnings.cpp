#include "scene/scene_warnings.hpp"

#include "base/one_line.hpp"
#include "flow/viscosity.hpp"
#include "scene/lumens.hpp"
#include "scene/red_cell.hpp"
#include "solids/exterior.hpp"

namespace eulastic {

namespace {

void add_attachment_warnings(const Config &config, std::vector<std::string> *warnings) {
  if (config.method.exterior != SolidExterior::extrapolate) return;
  const int dimension = config.grid.cells[2] == 1 ? 2 : 3;
  Real3 spacing;
  for (int d = 0; d < 3; ++d) spacing[d] = config.grid.length[d] / config.grid.cells[d];
  for (const SpeciesSpec &spec : config.species) {
    const Material material = spec.material();
    if (!material.anchored || damps_short_waves(spacing, dimension, config.fluid, material)) continue;
    warnings->push_back(
        print("%s is anchored and too stiff for the grid: sqrt(shear modulus/density) h exceeds the kinematic "
              "viscosity %g, so that its strain at the surface is of first order only, as for a free body; use a "
              "spacing of at most %.3g",
              spec.name.c_str(), viscosity_of(material, config.fluid) / config.fluid.density,
              damping_spacing(config.fluid, material)));
  }
}

// Of a drop: docs/method.md, section 16, "Pressure".
void add_lag_warnings(const Config &config, std::vector<std::string> *warnings) {
  if (!config.method.staggered() || config.method.explicit_viscosity()) return;
  ViscosityContrast all(config.fluid);
  for (const SpeciesSpec &spec : config.species) all.add(spec.material(), 0);
  for (const SpeciesSpec &spec : config.species) {
    ViscosityContrast alone(config.fluid);
    alone.add(spec.material(), 0);
    if (!alone.exists() || alone.allows_pressure_extrapolation()) continue;
    warnings->push_back(
        print("%s is %.3g times as viscous as the fluid: beyond a factor of 20 the velocity lags by about %.0f "
              "steps; use a shorter -time_step",
              spec.name.c_str(), viscosity_of(spec.material(), config.fluid) / config.fluid.viscosity,
              4 * all.most / all.least));
  }
}

// With a sharp interface users expect that bodies stay separate.
void add_merging_warnings(const Config &config, std::vector<std::string> *warnings) {
  for (std::size_t s = 0; s < config.species.size(); ++s) {
    const SpeciesSpec &spec = config.species[s];
    const std::string needed = config.why_no_boxes(spec);
    if (needed.empty() || spec.contact || config.method.interface != InterfaceScheme::plic) continue;
    if (spec.law == Law::rigid || spec.material().anchored || config.places[s].count < 2) continue;
    warnings->push_back("bodies of " + spec.name + " merge where they touch: to stay separate they need " + needed +
                        "; -" + spec.name + "_contact merge accepts it without this warning");
  }
}

}  // namespace

std::vector<std::string> scene_warnings(const Config &config) {
  std::vector<std::string> warnings = coarse_surface_warnings(config);
  add_attachment_warnings(config, &warnings);
  add_lag_warnings(config, &warnings);
  add_merging_warnings(config, &warnings);
  for (std::string &warning : lumen_warnings(config)) warnings.push_back(std::move(warning));
  return warnings;
}

}  // namespace eulastic
