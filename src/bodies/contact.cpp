#include "bodies/contact.hpp"

#include "base/events.hpp"
#include "bodies/colouring.hpp"
#include "bodies/colours.hpp"
#include "bodies/near_groups.hpp"
#include "grid/domain.hpp"

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
    for (Field *block : {&(*phases)[p].label, &(*phases)[p].fraction})
      wanted.push_back({block, reach, &(*phases)[p].rows});
  PetscCall(exchange.update_ghosts(wanted));
  PetscFunctionReturn(0);
}

// The phases of the bodies in `colours` that this rank sees, as moves without an end.
PetscErrorCode find_homes(const Box &box, const std::vector<Phase> &phases, const std::vector<int> &colours,
                          const NearGroups &groups, std::vector<BodyMove> *moves) {
  PetscFunctionBeginUser;
  std::vector<NearBodies> found;
  for (const int p : colours)
    for (const int label : labels_in(box, phases[p].label[0])) found.push_back({label, 0, p});
  PetscCall(groups.gather(&found));
  moves->clear();
  for (const NearBodies &home : found)
    if (moves->empty() || moves->back().label != home.body) moves->push_back({home.body, home.phase, -1});
  PetscCall(groups.spread(moves));
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
PetscErrorCode survey_contacts(const Domain &domain, GhostExchange &exchange, std::vector<Phase> *phases,
                               ContactSurvey *survey) {
  PetscFunctionBeginUser;
  *survey = {};
  survey->colours = colours_of(*phases);
  std::vector<int> found(phases->size(), 0);  // then one of each species
  for (const auto &[first, colours] : survey->colours) {
    PetscCall(update_ghosts(exchange, contact_reach, colours, phases));
    std::vector<NearBodies> &pairs = survey->pairs[first];
    for (const int p : colours) {
      if (p != first) found[p] = !labels_in(domain, (*phases)[p].label[0]).empty();
      find_near_in_phase(domain, cells_of((*phases)[p]), p, contact_reach, &pairs);
    }
    found.push_back(!pairs.empty());
  }
  if (survey->colours.empty()) PetscFunctionReturn(0);
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, found.data(), static_cast<int>(found.size()), MPI_INT, MPI_MAX, domain.comm()));
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

// Adds to the pairs that this rank has found all that is near the bodies that move, in the other phases of their
// species; `moves` of those that it sees. Then both are those of the groups that it decides on.
PetscErrorCode find_neighbours(const Box &box, const std::vector<Phase> &phases, const std::vector<int> &colours,
                               const NearGroups &groups, int reach, std::vector<BodyMove> *moves,
                               std::vector<NearBodies> *pairs) {
  PetscFunctionBeginUser;
  for (const int p : colours) {
    std::vector<int> labels;
    for (const BodyMove &move : *moves)
      if (move.from == p) labels.push_back(move.label);
    for (const int q : colours)
      if (q != p && !labels.empty())
        find_near_others(box, cells_of(phases[p]), labels, cells_of(phases[q]), q, reach, pairs);
  }
  for (const BodyMove &move : *moves) pairs->push_back({move.label, 0, move.from});
  PetscCall(groups.gather(pairs));
  moves->clear();
  for (const NearBodies &pair : *pairs)
    if (pair.other == 0) moves->push_back({pair.body, pair.phase, -1});
  const auto is_move = [](const NearBodies &pair) { return pair.other == 0; };
  pairs->erase(std::remove_if(pairs->begin(), pairs->end(), is_move), pairs->end());
  PetscFunctionReturn(0);
}

// The first phase of the species that nobody near a body is in, before the moves or after them. False if one has none.
bool choose_own(const std::vector<int> &colours, const std::vector<NearBodies> &pairs, std::vector<BodyMove> *moves) {
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

// The same, and false if one of any rank has none.
PetscErrorCode choose_colours(const Domain &domain, const std::vector<int> &colours,
                              const std::vector<NearBodies> &pairs, std::vector<BodyMove> *moves, bool *all) {
  PetscFunctionBeginUser;
  int chosen = choose_own(colours, pairs, moves);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &chosen, 1, MPI_INT, MPI_MIN, domain.comm()));
  *all = chosen > 0;
  PetscFunctionReturn(0);
}

// Colours for all bodies of a species anew, in place of `moves`.
PetscErrorCode recolour(const Domain &domain, std::vector<int> colours, const NearGroups &groups,
                        std::vector<NearBodies> pairs, std::vector<Phase> *phases, std::vector<BodyMove> *moves,
                        std::string *crowded) {
  PetscFunctionBeginUser;
  PetscCall(find_homes(domain, *phases, colours, groups, moves));
  PetscCall(find_neighbours(domain, *phases, colours, groups, contact_reach, moves, &pairs));
  std::vector<int> bodies;
  for (const BodyMove &move : *moves) bodies.push_back(move.label);
  const std::vector<int> chosen = colour_bodies(bodies, pairs);
  int needed = 0;
  for (const int colour : chosen) needed = std::max(needed, colour + 1);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &needed, 1, MPI_INT, MPI_MAX, domain.comm()));
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
    add_colour(domain, colours[0], phases);
  }
  for (std::size_t b = 0; b < chosen.size(); ++b) (*moves)[b].to = colours[chosen[b]];
  const auto stays = [](const BodyMove &move) { return move.from == move.to; };
  moves->erase(std::remove_if(moves->begin(), moves->end(), stays), moves->end());
  PetscFunctionReturn(0);
}

// Moves of all bodies of the last phase of a species to others, none if one cannot. From one cell further than the
// distance that would send them away again.
PetscErrorCode empty_last_colour(const Domain &domain, const std::vector<int> &colours, const NearGroups &groups,
                                 int reach, const std::vector<Phase> &phases, std::vector<BodyMove> *moves) {
  PetscFunctionBeginUser;
  bool all = false;
  const int last = colours.back();
  for (const int label : labels_in(domain, phases[last].label[0])) moves->push_back({label, last, -1});
  std::vector<NearBodies> pairs;
  PetscCall(find_neighbours(domain, phases, colours, groups, reach, moves, &pairs));
  PetscCall(choose_colours(domain, {colours.begin(), colours.end() - 1}, pairs, moves, &all));
  if (!all) moves->clear();
  PetscFunctionReturn(0);
}

// Of every two near bodies the higher label to the first phase that is free for it, or all bodies to other phases.
PetscErrorCode part_near_bodies(const Domain &domain, const std::vector<int> &colours, const NearGroups &groups,
                                const std::vector<NearBodies> &found, std::vector<Phase> *phases,
                                std::vector<BodyMove> *moves, std::string *crowded) {
  PetscFunctionBeginUser;
  bool all = false;
  std::vector<NearBodies> pairs = found;
  PetscCall(groups.gather(&pairs));
  *moves = choose_bodies(pairs);
  PetscCall(groups.spread(moves));
  pairs = found;
  PetscCall(find_neighbours(domain, *phases, colours, groups, contact_reach, moves, &pairs));
  PetscCall(choose_colours(domain, colours, pairs, moves, &all));
  if (!all) PetscCall(recolour(domain, colours, groups, found, phases, moves, crowded));
  PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode separate_bodies(const Domain &domain, GhostExchange &exchange, const std::vector<int> &also,
                               std::vector<Phase> *phases, Separation *result) {
  PetscFunctionBeginUser;
  *result = {};
  VerbScope scope(Verb::contact);
  ContactSurvey survey;
  do PetscCall(survey_contacts(domain, exchange, phases, &survey));
  while (remove_empty_colours(survey, phases));  // positions have changed
  std::vector<BodyMove> &moves = result->moves;
  for (const auto &[first, colours] : survey.colours) {
    const bool near = survey.near[first];
    if (!near && colours.size() == 1) continue;
    const int reach = near ? contact_reach : contact_reach + 1;
    if (!near) PetscCall(update_ghosts(exchange, reach, colours, phases));
    std::set<int> seen(also.begin(), also.end());
    for (const int p : colours)
      for (const int label : labels_in(domain, (*phases)[p].label[0], reach)) seen.insert(label);
    NearGroups groups;
    PetscCall(groups.connect(domain.comm(), {seen.begin(), seen.end()}));
    std::vector<BodyMove> own;
    if (near)
      PetscCall(part_near_bodies(domain, colours, groups, survey.pairs[first], phases, &own, &result->crowded));
    else
      PetscCall(empty_last_colour(domain, colours, groups, reach, *phases, &own));
    PetscCall(groups.spread(&own));
    moves.insert(moves.end(), own.begin(), own.end());
    if (result->crowded.empty()) continue;
    moves.clear();
    PetscFunctionReturn(0);
  }
  if (survey.colours.empty()) PetscFunctionReturn(0);
  std::vector<int> changed(phases->size(), 0);
  for (const BodyMove &move : moves) changed[move.from] = changed[move.to] = 1;
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, changed.data(), static_cast<int>(changed.size()), MPI_INT, MPI_MAX, domain.comm()));
  for (std::size_t p = 0; p < changed.size(); ++p)
    if (changed[p]) result->changed.insert(static_cast<int>(p));
  std::sort(moves.begin(), moves.end(), [](const BodyMove &a, const BodyMove &b) { return a.label < b.label; });
  if (!moves.empty()) move_bodies(domain, moves, phases);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
