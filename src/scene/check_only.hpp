// -check_only: what follows from the options, without creating any field.
#pragma once

#include "grid/domain.hpp"
#include "scene/config.hpp"

#include <string>

namespace eulastic {

/// Derived numbers of a parsed `config` that fits on `ranks` ranks (Domain::refusal_reason): grid, bodies, estimated
/// flow, dimensionless numbers, limits of the time step, memory. One `name: value` a line.
std::string check_report(const Config &config, int ranks);

}  // namespace eulastic
