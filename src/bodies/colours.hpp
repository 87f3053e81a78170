// Colours: several phases of one species, each with some of its bodies.
#pragma once

#include "bodies/contact.hpp"

namespace eulastic {

/// Appends a phase of the same species as the one at position `like`, with nothing in it: phi = 0, B = I, no labels.
void add_colour(const Box &box, int like, std::vector<Phase> *phases);

/// Of each phase beyond the first ones of the species: the position of the first phase of its species.
std::vector<long> species_of_colours(const std::vector<Phase> &phases);
/// Adds empty phases or removes some until species_of_colours(phases) is `first`. False if that is impossible.
bool set_colours(const Box &box, const std::vector<long> &first, std::vector<Phase> *phases);

/// phi and label of the owned cells of each body, and B of all points that a cell of BodyCells touches, go to its new
/// phase; there B of nobody is overwritten. Where remains of two bodies share a cell their phi adds up and the label of
/// the larger stays. B stays where it was, too: it means nothing any more where phi is gone. One ghost of label and
/// phi.
void move_bodies(const Box &box, const std::vector<BodyMove> &moves, std::vector<Phase> *phases);

}  // namespace eulastic
