// What to say of an option that nobody knows, and of what the program does not do.
#pragma once

#include "options/option_table.hpp"

#include <string>

namespace eulastic {

/// One line about `name`: the nearest option of `table`, or the species that is missing, or only -help.
std::string unknown_option(const std::string &name, const std::vector<Option> &table);

/// One clause if `name`, of an option or a word as its value, asks for something that does not exist: why, and what to
/// use instead; or for something that has another name: that name. Else nothing. README.md, "What it does not do", says
/// the same.
std::string not_supported(const std::string &name);

}  // namespace eulastic
