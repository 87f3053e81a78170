// The rows of the option table about bonds between surfaces.
#pragma once

#include "options/option_rows.hpp"
#include "scene/config.hpp"

namespace eulastic {

/// Pairs that -adhesion names, of species that are known. Returns what is wrong, or nothing.
std::string read_adhesion(const std::string &value, Config *config);
void add_adhesion(Rows &rows, Config &config);

}  // namespace eulastic
