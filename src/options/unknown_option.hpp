// The error about an unknown option, and names of features that the program lacks or that have another name.
#pragma once

#include "options/option_table.hpp"

#include <string>

namespace eulastic {

/// One line about `name`: its present name, the nearest option of `table`, the missing species, or only -help.
std::string unknown_option(const std::string &name, const std::vector<Option> &table);

/// `name`: of an option, or a word as its value. Returns one clause with a reason and a replacement if it asks for a
/// missing feature, or the present name of a feature; else nothing. README.md, "What it does not do", has the same
/// list.
std::string not_supported(const std::string &name);

}  // namespace eulastic
