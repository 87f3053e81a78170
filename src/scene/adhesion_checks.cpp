#include "scene/adhesion_checks.hpp"

#include "adhesion/surface_feet.hpp"
#include "field/open_sides.hpp"
#include "io/option_values.hpp"

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
  const int dimension = config.grid.cells[2] == 1 ? 2 : 3;
  for (int d = 0; d < dimension; ++d)
    for (int high = 0; high < 2; ++high) {
      if (!config.boundary.is_wall(d, high)) continue;
      bool inside = true;
      for (int e = 0; e < dimension; ++e) {
        const double end = high ? config.grid.length[d] : 0;
        const double low = e == d ? end : 0, most = e == d ? end : config.grid.length[e];
        inside = inside && pair.low[e] <= most && pair.high[e] >= low;
      }
      if (inside) return true;
    }
  return false;
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
  if (spec.law == Law::rigid || spec.material().attached) return {};
  return "-adhesion: the second species of " + pair.name + " needs " + needs(pair.second) +
         ", or to be rigid or attached";
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
                                           config.species[pair.second].material().attached);
  if (!pair.to_wall() && !on_grid && pair.low[0] != -HUGE_VAL)
    return option_of(pair, "region") + ": applies only with a wall, or a species that is rigid or attached";
  if (on_grid && pair.law.reach > foot_reach * shortest)
    return option_of(pair, "reach") + ": " + to_text(pair.law.reach) + " is more than " + std::to_string(foot_reach) +
           " cells, as far as surfaces on the grid are looked for; accepted: at most " + to_text(foot_reach * shortest);
  if (pair.to_wall() && !has_wall(config, pair))
    return pair.low[0] == -HUGE_VAL
               ? "-adhesion: " + pair.name + " without a wall; accepted: with a -boundary that is a wall"
               : option_of(pair, "region") + ": no wall of the box is in it; accepted: a box that holds part of a wall";
  return {};
}

}  // namespace

std::string check_adhesion(const Config &config) {
  for (const AdhesionPair &pair : config.adhesion.pairs)
    if (const std::string wrong = check_pair(config, pair); !wrong.empty()) return wrong;
  if (!config.adhesion.pairs.empty() && has_feeders(config.sides))
    return "-adhesion: bodies that an inlet generator lets in have no receptors; accepted: without "
           "-boundary_..._generator_length";
  return {};
}

}  // namespace eulastic
