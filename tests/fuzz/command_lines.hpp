// Command lines near the border between right and wrong, made from the option table itself.
#pragma once

#include "fuzz/dice.hpp"

namespace eulastic::fuzz {

using Words = std::vector<std::string>;

/// A small scene that is right: few cells, one body or two, one or two species.
Words valid_line(Dice &dice);
/// Options added, values replaced, words lost, doubled, exchanged, spoiled.
Words spoiled_line(Dice &dice, Words words);

}  // namespace eulastic::fuzz
