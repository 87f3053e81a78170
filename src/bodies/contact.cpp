#include "bodies/contact.hpp"

#include "base/events.hpp"
#include "bodies/colouring.hpp"
#include "bodies/colours.hpp"
#include "bodies/near_bodies.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <set>

namespace eulastic {
namespace {

BodyCells cells_of(const Phase &phase) { return {phase.label[0], phase.fraction[0]}; }

// Positions of the phases of each species with `separate`, by its first.
std::map<int, std::vector<int>> colours_of(const std::vector<Phase> &phases) {
  std::map<int, std::vector<int>> colours;
  for (int p = 0; p < static_cast<int>(phases.size()); ++p) {
    if (!phases[p].separate) continue;
    int first = 0;
    while (phases[first].species != phases[p].species) ++first;
    colours[first].push_back(p);
  }
  return colours;
}

PetscErrorCode update_ghosts(GhostExchange &exchange, int reach, const std::vector<int> &colours,
                             std::vector<Phase> *phases) {
  PetscFunctionBeginUser;
  std::vector<WantedGhosts> wanted;
  for (const int p : colours)
    for (FieldBlock *block : {&(*phases)[p].label, &(*phases)[p].fraction})
      wanted.push_back({block, reach, &(*phases)[p].rows});
  PetscCall(exchange.update(wanted));
  PetscFunctionReturn(0);
}

// The phase of every body in `colours`, of all ranks.
PetscErrorCode find_homes(const Grid &grid, const std::vector<Phase> &phases, const std::vector<int> &colours,
                          std::map<int, int> *homes) {
  PetscFunctionBeginUser;
  std::vector<NearBodies> found;
  for (const int p : colours)
    for (const int label : labels_in(grid, phases[p].label[0])) found.push_back({label, 0, p});
  PetscCall(gather_near(grid.comm(), &found));
  homes->clear();
  for (const NearBodies &home : found) homes->emplace(home.body, home.phase);
  PetscFunctionReturn(0);
}

// What one look at all phases finds.
struct ContactSurvey {
  std::map<int, std::vector<int>> colours;       // of each species
  std::map<int, std::vector<NearBodies>> pairs;  // of this rank, in one phase
  std::map<int, int> near;                       // whether any rank has a pair
  std::vector<int> occupied;                     // whether a phase has a body
};

// One Allreduce for all species.
PetscErrorCode survey_contacts(const Grid &grid, GhostExchange &exchange, std::vector<Phase> *phases,
                               ContactSurvey *survey) {
  PetscFunctionBeginUser;
  *survey = {};
  survey->colours = colours_of(*phases);
  std::vector<int> found(phases->size(), 0);  // then one of each species
  for (const auto &[first, colours] : survey->colours) {
    PetscCall(update_ghosts(exchange, contact_reach, colours, phases));
    std::vector<NearBodies> &pairs = survey->pairs[first];
    for (const int p : colours) {
      if (p != first) found[p] = !labels_in(grid, (*phases)[p].label[0]).empty();
      find_near_in_phase(grid, cells_of((*phases)[p]), p, contact_reach, &pairs);
    }
    found.push_back(!pairs.empty());
  }
  if (survey->colours.empty()) PetscFunctionReturn(0);
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, found.data(), static_cast<int>(found.size()), MPI_INT, MPI_MAX, grid.comm()));
  std::size_t next = phases->size();
  for (const auto &[first, colours] : survey->colours) survey->near[first] = found[next++];
  found.resize(phases->size());
  survey->occupied = std::move(found);
  PetscFunctionReturn(0);
}

// Removes phases without a body from the end of a species' colours, but the first one. Returns whether there were any.
bool remove_empty_colours(const ContactSurvey &survey, std::vector<Phase> *phases) {
  std::set<int> empty;
  for (const auto &[first, colours] : survey.colours)
    for (auto last = colours.rbegin(); *last != first && !survey.occupied[*last]; ++last) empty.insert(*last);
  for (auto p = empty.rbegin(); p != empty.rend(); ++p) phases->erase(phases->begin() + *p);
  return !empty.empty();
}

// Of every pair in one phase the higher label, unless the other one goes already. `pairs` are ascending.
std::vector<BodyMove> choose_bodies(const std::vector<NearBodies> &pairs) {
  std::vector<BodyMove> moves;
  std::set<int> moving;
  for (const NearBodies &pair : pairs)
    if (moving.count(pair.other) == 0 && moving.insert(pair.body).second) moves.push_back({pair.body, pair.phase, -1});
  return moves;
}

// All that is near the bodies that move, in the other phases of their species.
PetscErrorCode find_neighbours(const Grid &grid, const std::vector<Phase> &phases, const std::vector<int> &colours,
                               const std::vector<BodyMove> &moves, int reach, std::vector<NearBodies> *pairs) {
  PetscFunctionBeginUser;
  for (const int p : colours) {
    std::vector<int> labels;
    for (const BodyMove &move : moves)
      if (move.from == p) labels.push_back(move.label);
    for (const int q : colours)
      if (q != p && !labels.empty())
        find_near_others(grid, cells_of(phases[p]), labels, cells_of(phases[q]), q, reach, pairs);
  }
  PetscCall(gather_near(grid.comm(), pairs));
  PetscFunctionReturn(0);
}

// The first phase of the species that nobody near a body is in, before the moves or after them. False if one has none.
bool choose_colours(const std::vector<int> &colours, const std::vector<NearBodies> &pairs,
                    std::vector<BodyMove> *moves) {
  for (BodyMove &move : *moves) {
    std::set<int> taken{move.from};
    const auto first = std::lower_bound(pairs.begin(), pairs.end(), NearBodies{move.label, 0, 0});
    for (auto pair = first; pair != pairs.end() && pair->body == move.label; ++pair) {
      taken.insert(pair->phase);
      const auto other = std::lower_bound(moves->begin(), moves->end(), pair->other,
                                          [](const BodyMove &m, int label) { return m.label < label; });
      if (other != moves->end() && other->label == pair->other) taken.insert(other->to);
    }
    const auto free = std::find_if(colours.begin(), colours.end(), [&](int c) { return taken.count(c) == 0; });
    if (free == colours.end()) return false;
    move.to = *free;
  }
  return true;
}

// Colours for all bodies of a species anew, in place of `moves`.
PetscErrorCode recolour(const Grid &grid, std::vector<int> colours, std::vector<Phase> *phases,
                        std::vector<BodyMove> *moves, std::string *crowded) {
  PetscFunctionBeginUser;
  std::map<int, int> homes;
  PetscCall(find_homes(grid, *phases, colours, &homes));
  std::vector<NearBodies> pairs;
  std::vector<int> bodies;
  moves->clear();
  for (const auto &[label, phase] : homes) {
    bodies.push_back(label);
    moves->push_back({label, phase, -1});
  }
  for (const int p : colours) find_near_in_phase(grid, cells_of((*phases)[p]), p, contact_reach, &pairs);
  PetscCall(find_neighbours(grid, *phases, colours, *moves, contact_reach, &pairs));
  const std::vector<int> chosen = colour_bodies(bodies, pairs);
  const int needed = 1 + *std::max_element(chosen.begin(), chosen.end());
  if (needed > most_colours) {
    char text[200];
    std::snprintf(text, sizeof text,
                  "-%s_contact: more than %d bodies within %d cells of each other; accepted: more cells, or merge",
                  (*phases)[colours[0]].species.c_str(), most_colours, contact_reach);
    *crowded = text;
    PetscFunctionReturn(0);
  }
  while (static_cast<int>(colours.size()) < needed) {
    colours.push_back(static_cast<int>(phases->size()));
    add_colour(grid, colours[0], phases);
  }
  for (std::size_t b = 0; b < chosen.size(); ++b) (*moves)[b].to = colours[chosen[b]];
  const auto stays = [](const BodyMove &move) { return move.from == move.to; };
  moves->erase(std::remove_if(moves->begin(), moves->end(), stays), moves->end());
  PetscFunctionReturn(0);
}

// Moves of all bodies of the last phase of a species to others, none if one cannot. From one cell further than the
// distance that would send them away again.
PetscErrorCode empty_last_colour(const Grid &grid, GhostExchange &exchange, const std::vector<int> &colours,
                                 std::vector<Phase> *phases, std::vector<BodyMove> *moves) {
  PetscFunctionBeginUser;
  moves->clear();
  if (colours.size() == 1) PetscFunctionReturn(0);
  const std::vector<int> last{colours.back()}, others(colours.begin(), colours.end() - 1);
  std::map<int, int> homes;
  PetscCall(find_homes(grid, *phases, last, &homes));
  for (const auto &[label, phase] : homes) moves->push_back({label, phase, -1});
  PetscCall(update_ghosts(exchange, contact_reach + 1, colours, phases));
  std::vector<NearBodies> pairs;
  PetscCall(find_neighbours(grid, *phases, colours, *moves, contact_reach + 1, &pairs));
  if (!choose_colours(others, pairs, moves)) moves->clear();
  PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode separate_bodies(const Grid &grid, GhostExchange &exchange, std::vector<Phase> *phases,
                               std::vector<BodyMove> *moves, std::string *crowded) {
  PetscFunctionBeginUser;
  moves->clear();
  crowded->clear();
  VerbScope scope(Verb::contact);
  ContactSurvey survey;
  do PetscCall(survey_contacts(grid, exchange, phases, &survey));
  while (remove_empty_colours(survey, phases));  // positions have changed
  for (const auto &[first, colours] : survey.colours) {
    std::vector<BodyMove> own;
    if (!survey.near[first]) {
      PetscCall(empty_last_colour(grid, exchange, colours, phases, &own));
    } else {
      std::vector<NearBodies> &pairs = survey.pairs[first];
      PetscCall(gather_near(grid.comm(), &pairs));
      own = choose_bodies(pairs);
      PetscCall(find_neighbours(grid, *phases, colours, own, contact_reach, &pairs));
      if (!choose_colours(colours, pairs, &own)) PetscCall(recolour(grid, colours, phases, &own, crowded));
    }
    moves->insert(moves->end(), own.begin(), own.end());
    if (crowded->empty()) continue;
    moves->clear();
    break;
  }
  std::sort(moves->begin(), moves->end(), [](const BodyMove &a, const BodyMove &b) { return a.label < b.label; });
  if (!moves->empty()) move_bodies(grid, *moves, phases);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
