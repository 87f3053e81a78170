#include "scene/adhesion_checks.hpp"

#include "adhesion/surface_feet.hpp"
#include "io/option_values.hpp"
#include "scene/voxels.hpp"

#include <algorithm>

namespace eulastic {
namespace {

std::string option_of(const AdhesionPair &pair, const std::string &name) {
  std::string of = pair.name;
  of[of.find('-')] = '_';
  return "-adhesion_" + of + "_" + name;
}

// Whether any wall of the box has a part in the region.
bool has_wall(const Config &config, const AdhesionPair &pair) {
  const AdhesiveRegion &region = pair.region;
  const Int3 &cells = config.grid.cells;
  const int dimension = cells[2] == 1 ? 2 : 3;
  Real3 h{};
  for (int d = 0; d < 3; ++d) h[d] = config.grid.length[d] / cells[d];
  const auto is_inside = [&](int wall, const Int3 &cell) {
    bool inside = !region.cells || region.cells->has(cell);
    for (int d = 0; d < dimension; ++d) {
      const double low = d != wall ? cell[d] * h[d] : cell[d] == 0 ? 0 : config.grid.length[d];
      const double high = d != wall ? low + h[d] : low;
      inside = inside && region.low[d] <= high && region.high[d] >= low;
    }
    return inside;
  };
  for (int d = 0; d < dimension; ++d)
    for (int high = 0; high < 2; ++high) {
      if (!config.boundary.is_wall(d, high)) continue;
      Int3 first{}, last = cells;
      first[d] = high ? cells[d] - 1 : 0;
      last[d] = first[d] + 1;
      for (int k = first[2]; k < last[2]; ++k)
        for (int j = first[1]; j < last[1]; ++j)
          for (int i = first[0]; i < last[0]; ++i)
            if (is_inside(d, {i, j, k})) return true;
    }
  return false;
}

// The cells of the region that a file has.
std::string read_region(const DomainShape &grid, AdhesionPair *pair) {
  if (pair->region.file.path.empty()) return {};
  auto mask = std::make_shared<SolidMask>(grid);
  bool any = false;
  const std::string option = option_of(*pair, "region_file");
  const std::string wrong = read_cells(pair->region.file, option, grid, {grid, {}, grid.cells},
                                       [&](const CellWindow &window, ConstView fraction) {
                                         mask->add(window, fraction);
                                         for (int k = 0; k < window.size[2]; ++k)
                                           for (int j = 0; j < window.size[1]; ++j)
                                             for (int i = 0; i < window.size[0]; ++i)
                                               any = any || fraction(i, j, k) > 0;
                                       });
  if (!wrong.empty()) return wrong;
  pair->region.cells = mask;
  return any ? "" : option + ": " + pair->region.file.path + " has no cell in the box";
}

// Bodies in boxes come first; the second species may be a rigid or an anchored one on the grid.
std::string check_species_of(const Config &config, const AdhesionPair &pair) {
  const auto needs = [&](int which) {
    const SpeciesSpec &spec = config.species[which];
    if (spec.law == Law::rigid) return std::string("bodies that deform");
    return spec.contact == Contact::merge ? "no -" + spec.name + "_contact merge" : config.why_no_boxes(spec);
  };
  if (const std::string needed = needs(pair.first); !needed.empty())
    return "-adhesion: the first species of " + pair.name + " needs " + needed;
  if (pair.to_wall() || needs(pair.second).empty()) return {};
  const SpeciesSpec &spec = config.species[pair.second];
  if (spec.law == Law::rigid || spec.material().anchored) return {};
  return "-adhesion: the second species of " + pair.name + " needs " + needs(pair.second) +
         ", or to be rigid or anchored";
}

std::string check_pair(const Config &config, const AdhesionPair &pair) {
  if (const std::string wrong = check_species_of(config, pair); !wrong.empty()) return wrong;
  double spacing = 0;
  for (int d = 0; d < (config.grid.cells[2] == 1 ? 2 : 3); ++d)
    spacing = std::max(spacing, config.grid.length[d] / config.grid.cells[d]);
  if (pair.law.reach < spacing)
    return option_of(pair, "reach") + ": " + to_text(pair.law.reach) +
           " is less than a cell, so that hydrodynamics would hold surfaces apart; accepted: at least " +
           to_text(spacing);
  double shortest = spacing;
  for (int d = 0; d < (config.grid.cells[2] == 1 ? 2 : 3); ++d)
    shortest = std::min(shortest, config.grid.length[d] / config.grid.cells[d]);
  const bool on_grid = !pair.to_wall() && (config.species[pair.second].law == Law::rigid ||
                                           config.species[pair.second].material().anchored);
  const std::string region = option_of(pair, pair.region.file.path.empty() ? "region" : "region_file");
  if (!pair.to_wall() && !on_grid && pair.region.is_given())
    return region + ": applies only with a wall, or a species that is rigid or anchored";
  if (on_grid && pair.law.reach > foot_reach * shortest)
    return option_of(pair, "reach") + ": " + to_text(pair.law.reach) + " is more than " + std::to_string(foot_reach) +
           " cells, as far as surfaces on the grid are looked for; accepted: at most " + to_text(foot_reach * shortest);
  if (pair.to_wall() && !has_wall(config, pair))
    return pair.region.is_given()
               ? region + ": no wall of the box is in it; accepted: a region that holds part of a wall"
               : "-adhesion: " + pair.name + " without a wall; accepted: with a -boundary that is a wall";
  return {};
}

}  // namespace

std::string check_adhesion(Config *config) {
  for (AdhesionPair &pair : config->adhesion.pairs) {
    if (const std::string wrong = read_region(config->grid, &pair); !wrong.empty()) return wrong;
    if (const std::string wrong = check_pair(*config, pair); !wrong.empty()) return wrong;
  }
  return {};
}

}  // namespace eulastic
