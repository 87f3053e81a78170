// Command lines near the border between right and wrong, made from the option table itself.
#pragma once

#include "fuzz/dice.hpp"
#include "scene/config.hpp"

namespace eulastic::fuzz {

using Words = std::vector<std::string>;

/// A small scene that is right: few cells, one body or two, one or two species.
Words valid_line(Dice &dice);
/// Options added, values replaced, words lost, doubled, exchanged, spoiled.
Words spoiled_line(Dice &dice, Words words);

/// Whether a run of it takes a moment.
bool small(const Config &config);

/// Writes `cases` spoiled lines to stdout, for the program itself. Each is what should come of it (the error, or
/// "message", "run" or "check": valid but not small), the number of words, the words, each of them ended by a 0.
void print_lines(long cases, unsigned long seed);

}  // namespace eulastic::fuzz
