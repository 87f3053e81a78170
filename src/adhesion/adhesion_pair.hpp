// Which surfaces adhere to which, and how.
#pragma once

#include "grid/box.hpp"
#include "kernels/bond.hpp"

#include <string>
#include <vector>

namespace eulastic {

struct AdhesionPair {
  static constexpr int wall = -1;
  std::string name;           ///< NAME1-NAME2, or NAME-wall
  int first = 0, second = 0;  ///< species, the second one may be on the grid; `wall`: the walls of the box
  kernels::BondLaw law;
  double density = 0;  ///< receptors per area (2-D: per length) of the bodies of both species
  Real3 low{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL},
      high{HUGE_VAL, HUGE_VAL, HUGE_VAL};  ///< where walls and surfaces are adhesive

  bool to_wall() const { return second == wall; }
  bool joins(int one, int two) const { return (first == one && second == two) || (first == two && second == one); }
  bool has(int species) const { return species == first || species == second; }
};

struct AdhesionSpec {
  std::vector<AdhesionPair> pairs;
  long seed = 0;
};

}  // namespace eulastic
