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
  const int dimension = config.grid.dimension();
  const auto is_inside = [&](int wall, const Int3 &cell) {
    bool inside = !region.cells || region.cells->has(cell);
    for (int d = 0; d < dimension; ++d) {
      const double h = config.grid.spacing(d);
      const double low = d != wall ? cell[d] * h : cell[d] == 0 ? 0 : config.grid.length[d];
      const double high = d != wall ? low + h : low;
      inside = inside && region.low[d] <= high && region.high[d] >= low;
    }
    return inside;
  };
  bool any = false;
  for (int d = 0; d < dimension; ++d)
    for (int high = 0; high < 2; ++high) {
      if (!config.boundary.is_wall(d, high)) continue;
      Extent beside{{}, cells};
      beside.begin[d] = high ? cells[d] - 1 : 0;
      beside.end[d] = beside.begin[d] + 1;
      for_points(beside, [&](int i, int j, int k) { any = any || is_inside(d, {i, j, k}); });
    }
  return any;
}

// The cells of the region that a file has.
std::string read_region(const DomainShape &grid, AdhesionPair *pair) {
  if (pair->region.file.path.empty()) return {};
  auto mask = std::make_shared<SolidMask>(grid);
  bool any = false;
  const std::string option = option_of(*pair, "region_file");
  const std::string wrong = read_cells(
      pair->region.file, option, grid, {grid, {}, grid.cells}, [&](const CellWindow &window, ConstView fraction) {
        mask->add(window, fraction);
        for_points({{}, window.size}, [&](int i, int j, int k) { any = any || fraction(i, j, k) > 0; });
      });
  if (!wrong.empty()) return wrong;
  pair->region.cells = mask;
  return any ? ""
             : option + ": " + pair->region.file.path +
                   " covers no cell of the box; accepted: a file that covers at least one cell";
}

// Whether the second partner is a surface on the grid: of a rigid or an anchored species.
bool adheres_to_grid(const Config &config, const AdhesionPair &pair) {
  if (pair.to_wall()) return false;
  const SpeciesSpec &spec = config.species[pair.second];
  return spec.law == Law::rigid || spec.material().anchored;
}

// Bodies in boxes come first; the second species may be a rigid or an anchored one on the grid.
std::string check_species_of(const Config &config, const AdhesionPair &pair) {
  const auto needs = [&](int which) {
    const SpeciesSpec &spec = config.species[which];
    if (spec.law == Law::rigid) return std::string("bodies that deform");
    return spec.contact == Contact::merge ? "no -" + spec.name + "_contact merge" : config.why_no_boxes(spec);
  };
  if (const std::string needed = needs(pair.first); !needed.empty())
    return "-adhesion: the first species of " + pair.name + " cannot adhere as it is; accepted: " + needed;
  if (pair.to_wall() || adheres_to_grid(config, pair) || needs(pair.second).empty()) return {};
  return "-adhesion: the second species of " + pair.name + " cannot adhere as it is; accepted: " + needs(pair.second) +
         ", or rigid or anchored bodies";
}

std::string check_pair(const Config &config, const AdhesionPair &pair) {
  if (const std::string wrong = check_species_of(config, pair); !wrong.empty()) return wrong;
  const double spacing = config.grid.longest_spacing(), farthest = foot_reach * config.grid.shortest_spacing();
  if (pair.law.reach < spacing)
    return option_of(pair, "reach") + ": " + to_text(pair.law.reach) +
           " is less than a cell, but the fluid on the grid keeps surfaces farther apart; accepted: at least " +
           to_text(spacing);
  const bool on_grid = adheres_to_grid(config, pair);
  const std::string region = option_of(pair, pair.region.file.path.empty() ? "region" : "region_file");
  if (!pair.to_wall() && !on_grid && pair.region.is_given())
    return region + ": applies only to a wall, or to a second species that is rigid or anchored";
  if (on_grid && pair.law.reach > farthest)
    return option_of(pair, "reach") + ": " + to_text(pair.law.reach) + " is more than " + std::to_string(foot_reach) +
           " cells, the largest distance at which surfaces on the grid are searched; accepted: at most " +
           to_text(farthest);
  if (pair.to_wall() && !has_wall(config, pair))
    return pair.region.is_given()
               ? region + ": no wall of the box is in it; accepted: a region that holds part of a wall"
               : "-adhesion: " + pair.name +
                     " in a box without a wall; accepted: at least one boundary of the kind wall";
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
