#include "scene/red_cell.hpp"

#include "base/one_line.hpp"
#include "bodies/shapes.hpp"

#include <algorithm>

namespace eulastic {

const std::vector<std::pair<std::string, std::string>> &red_cell_preset() {
  static const std::vector<std::pair<std::string, std::string>> preset{
      {"shape", "biconcave"}, {"membrane_law", "skalak"},    {"surface_shear_modulus", "0.0053"},
      {"skalak_c", "20"},     {"bending_modulus", "0.0002"}, {"viscosity", "6"}};
  return preset;
}

std::vector<std::string> red_cell_lines(const Config &config) {
  std::vector<std::string> lines;
  for (const SpeciesSpec &spec : config.species) {
    if (spec.law != Law::red_cell) continue;
    const Membrane &m = spec.membrane;
    lines.push_back(
        print("red cells %s: surface shear modulus %g, area dilation modulus %g (that of a real cell is 1000 times as "
              "large), bending modulus %g, viscosity %g inside and %g outside",
              spec.name.c_str(), m.shear_modulus, m.largest_modulus() - m.shear_modulus, m.bending_modulus,
              spec.viscosity.value_or(config.fluid.viscosity), config.fluid.viscosity));
  }
  return lines;
}

namespace {

std::vector<std::string> coarse_surfaces(const Config &config, bool of_membranes) {
  constexpr double apart = 3, radius_of_drop = 6, round_off = 1 - 1e-9;  // in cells
  std::vector<std::string> warnings;
  const int dimension = config.grid.dimension();
  const double spacing = config.grid.longest_spacing();
  for (const SpeciesSpec &spec : config.species) {
    if (spec.is_membrane() ? !of_membranes : !(spec.surface_tension > 0)) continue;
    const auto &axes = spec.semi_axes;
    double thickness = 2 * spec.radius;
    if (spec.shape == Shape::ellipsoid) thickness = 2 * *std::min_element(axes.begin(), axes.begin() + dimension);
    if (spec.shape == Shape::biconcave) thickness = spec.radius * red_cell_waist;
    const double least = spec.is_membrane() ? apart : 2 * radius_of_drop;
    if (!(thickness > 0 && thickness < round_off * least * spacing)) continue;
    if (spec.is_membrane())
      warnings.push_back(
          print("membranes of %s are %.3g apart where they are thinnest, %.2g cells: the grid does not resolve the "
                "fluid between them; use a spacing of at most %.3g",
                spec.name.c_str(), thickness, thickness / spacing, thickness / least));
    else
      warnings.push_back(
          print("drops of %s are %.3g in radius where they are thinnest, %.2g cells: their surface is too coarse "
                "to hold them together; use a spacing of at most %.3g",
                spec.name.c_str(), 0.5 * thickness, 0.5 * thickness / spacing, thickness / least));
  }
  return warnings;
}

}  // namespace

std::vector<std::string> coarse_surface_warnings(const Config &config) { return coarse_surfaces(config, true); }

std::vector<std::string> coarse_drop_warnings(const Config &config) { return coarse_surfaces(config, false); }

}  // namespace eulastic
