#include "scene/adhesion_checks.hpp"

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

std::string check_pair(const Config &config, const AdhesionPair &pair) {
  for (const int which : {pair.first, pair.second}) {
    if (which < 0) continue;
    const SpeciesSpec &spec = config.species[which];
    if (spec.law == Law::rigid) return "-adhesion: " + spec.name + " is rigid; accepted: species that deform, or wall";
    const std::string needed =
        spec.contact == Contact::merge ? "no -" + spec.name + "_contact merge" : config.why_no_boxes(spec);
    if (!needed.empty()) return "-adhesion: " + spec.name + " needs " + needed;
  }
  double spacing = 0;
  for (int d = 0; d < (config.grid.cells[2] == 1 ? 2 : 3); ++d)
    spacing = std::max(spacing, config.grid.length[d] / config.grid.cells[d]);
  if (pair.law.reach < spacing)
    return option_of(pair, "reach") + ": " + to_text(pair.law.reach) +
           " is less than a cell, so that hydrodynamics would hold surfaces apart; accepted: at least " +
           to_text(spacing);
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
    return "-adhesion: bodies that an inlet generator lets in have no receptors; accepted: without -inflow_..._feeder";
  return {};
}

}  // namespace eulastic
