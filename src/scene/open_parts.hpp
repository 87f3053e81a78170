// Parts of inflow and open boundaries that rigid bodies leave open.
#pragma once

#include "scene/config.hpp"

#include <string>

namespace eulastic {

/// Measures Config::open_parts. Returns an error of one line, or nothing; errors are a rigid slab that fills the box, a
/// closed inflow boundary, and an inflow that cannot leave the box or that rigid bodies cut off. Collective.
std::string measure_open_parts(Config *config);

/// Calls visit(d, high) for every inflow or open boundary.
template <class Visit>
void for_crossed_sides(const Config &config, Visit visit) {
  for (int d = 0; d < 3; ++d)
    for (int high = 0; high < 2; ++high)
      if (fluid_crosses(config.sides[d][high].kind)) visit(d, high);
}

}  // namespace eulastic
