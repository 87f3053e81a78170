// What to say of an option that nobody knows.
#pragma once

#include "options/option_table.hpp"

namespace eulastic {

/// One line about `name`: the nearest option of `table`, or the species that is missing, or only -help.
std::string unknown_option(const std::string &name, const std::vector<Option> &table);

}  // namespace eulastic
