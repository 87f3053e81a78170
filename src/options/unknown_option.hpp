// The error about an unknown option.
#pragma once

#include "options/option_table.hpp"

namespace eulastic {

/// One line about `name`: its present name, the nearest option of `table`, the missing species, or only -help.
std::string unknown_option(const std::string &name, const std::vector<Option> &table);

}  // namespace eulastic
