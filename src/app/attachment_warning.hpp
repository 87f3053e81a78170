// The warning of attached bodies that are too stiff for their grid.
#pragma once

#include "app/config.hpp"

namespace eulastic {

/// One line for every attached species whose elastic waves as short as a cell are not damped (damps_short_waves): its
/// surface is treated like that of a free body, first order in the spacing.
std::vector<std::string> attachment_warnings(const Config &config);

}  // namespace eulastic
