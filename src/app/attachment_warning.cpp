#include "app/attachment_warning.hpp"

#include "physics/exterior.hpp"
#include "physics/viscosity.hpp"

#include <cstdio>

namespace eulastic {

std::vector<std::string> attachment_warnings(const Config &config) {
  std::vector<std::string> warnings;
  if (config.method.exterior != SolidExterior::extrapolate) return warnings;
  const int dimension = config.grid.cells[2] == 1 ? 2 : 3;
  Real3 spacing;
  for (int d = 0; d < 3; ++d) spacing[d] = config.grid.length[d] / config.grid.cells[d];
  for (const SpeciesSpec &spec : config.species) {
    const Material material = spec.material();
    if (!material.attached || damps_short_waves(spacing, dimension, config.fluid, material)) continue;
    char text[300];
    std::snprintf(text, sizeof text,
                  "%s is attached and too stiff for the grid: sqrt(shear modulus/density) h exceeds the kinematic "
                  "viscosity %g, so that its strain at the surface is first order, as of a free body; a spacing of at "
                  "most %.3g would do",
                  spec.name.c_str(), viscosity_of(material, config.fluid) / config.fluid.density,
                  damping_spacing(config.fluid, material));
    warnings.emplace_back(text);
  }
  return warnings;
}

}  // namespace eulastic
