// HDF5 files that are almost right: by hand, dataset by dataset, or a good file with something done to it.
#pragma once

#include "fuzz/dice.hpp"

namespace eulastic::fuzz {

/// An initial state for a grid of `cells`, mostly with something wrong: names, shapes, types, values, links, holes.
void write_state(Dice &dice, const std::string &path, const int (&cells)[3]);

/// Changes the HDF5 file at `path`: objects removed, replaced, renamed, attributes changed.
void change_objects(Dice &dice, const std::string &path);

}  // namespace eulastic::fuzz
