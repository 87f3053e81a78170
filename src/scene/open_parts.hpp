// What rigid bodies leave open of the sides that volume crosses.
#pragma once

#include "scene/config.hpp"

#include <string>

namespace eulastic {

/// Measures Config::open_parts. Returns one line on what cannot run, or nothing: a rigid slab that fills the box, an
/// inflow side that is closed, flow that comes in and has no way out. Collective.
std::string measure_open_parts(Config *config);

/// visit(d, high) of every side that volume crosses.
template <class Visit>
void for_crossed_sides(const Config &config, Visit visit) {
  for (int d = 0; d < 3; ++d)
    for (int high = 0; high < 2; ++high)
      if (volume_crosses(config.sides[d][high].kind)) visit(d, high);
}

}  // namespace eulastic
