#include "bodies/contact.hpp"

#include "base/events.hpp"
#include "bodies/colours.hpp"
#include "bodies/near_bodies.hpp"

#include <algorithm>
#include <set>

namespace eulastic {
namespace {

// Positions of the phases of one species.
std::vector<int> colours_of(const std::vector<Phase> &phases, const std::string &species) {
  std::vector<int> colours;
  for (std::size_t p = 0; p < phases.size(); ++p)
    if (phases[p].species == species) colours.push_back(static_cast<int>(p));
  return colours;
}

// Of every pair in one phase the higher label, unless the other one goes already. `pairs` are ascending.
std::vector<BodyMove> choose_bodies(const std::vector<NearBodies> &pairs) {
  std::vector<BodyMove> moves;
  std::set<int> moving;
  for (const NearBodies &pair : pairs)
    if (moving.count(pair.other) == 0 && moving.insert(pair.body).second) moves.push_back({pair.body, pair.phase, -1});
  return moves;
}

// All that is near the bodies that move, in any phase of their species.
PetscErrorCode find_neighbours(const Grid &grid, const std::vector<Phase> &phases, const std::vector<BodyMove> &moves,
                               std::vector<NearBodies> *pairs) {
  PetscFunctionBeginUser;
  for (int p = 0; p < static_cast<int>(phases.size()); ++p) {
    std::vector<int> labels;
    for (const BodyMove &move : moves)
      if (move.from == p) labels.push_back(move.label);
    if (labels.empty()) continue;
    for (const int q : colours_of(phases, phases[p].species))
      if (q != p) find_near_others(grid, phases[p].label[0], labels, phases[q].label[0], q, contact_reach, pairs);
  }
  PetscCall(gather_near(grid.comm(), pairs));
  PetscFunctionReturn(0);
}

// The first phase of the species that nobody near a body is in, before the moves or after them.
PetscErrorCode choose_colours(const Grid &grid, const std::vector<NearBodies> &pairs, std::vector<Phase> *phases,
                              std::vector<BodyMove> *moves) {
  PetscFunctionBeginUser;
  for (BodyMove &move : *moves) {
    std::set<int> taken{move.from};
    const auto first = std::lower_bound(pairs.begin(), pairs.end(), NearBodies{move.label, 0, 0});
    for (auto pair = first; pair != pairs.end() && pair->body == move.label; ++pair) {
      taken.insert(pair->phase);
      const auto other = std::lower_bound(moves->begin(), moves->end(), pair->other,
                                          [](const BodyMove &m, int label) { return m.label < label; });
      if (other != moves->end() && other->label == pair->other) taken.insert(other->to);
    }
    const std::string species = (*phases)[move.from].species;
    const std::vector<int> colours = colours_of(*phases, species);
    for (const int colour : colours)
      if (move.to < 0 && taken.count(colour) == 0) move.to = colour;
    if (move.to >= 0) continue;
    if (colours.size() >= most_colours)
      SETERRQ(grid.comm(), PETSC_ERR_USER_INPUT,
              "-%s_contact: more than %d bodies within %d cells of each other; accepted: more cells, or merge",
              species.c_str(), most_colours, contact_reach);
    move.to = static_cast<int>(phases->size());
    add_colour(grid, move.from, phases);
  }
  PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode separate_bodies(const Grid &grid, GhostExchange &exchange, std::vector<Phase> *phases,
                               std::vector<BodyMove> *moves) {
  PetscFunctionBeginUser;
  moves->clear();
  VerbScope scope(Verb::contact);
  std::vector<NearBodies> pairs;
  bool any = false;
  for (std::size_t p = 0; p < phases->size(); ++p) {
    Phase &phase = (*phases)[p];
    if (!phase.separate) continue;
    any = true;
    PetscCall(exchange.update(phase.label, contact_reach));
    find_near_in_phase(grid, phase.label[0], static_cast<int>(p), contact_reach, &pairs);
  }
  if (!any) PetscFunctionReturn(0);
  PetscCall(gather_near(grid.comm(), &pairs));
  if (pairs.empty()) PetscFunctionReturn(0);
  *moves = choose_bodies(pairs);
  PetscCall(find_neighbours(grid, *phases, *moves, &pairs));
  PetscCall(choose_colours(grid, pairs, phases, moves));
  move_bodies(grid, *moves, phases);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
