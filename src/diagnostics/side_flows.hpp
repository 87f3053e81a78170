// What passes the sides of the box that volume crosses. Exact sums: the same bits on any ranks.
#pragma once

#include "base/petsc.hpp"
#include "field/sides.hpp"
#include "grid/domain.hpp"

#include <string>

namespace eulastic {

struct SideFlow {
  int direction = 0;
  bool high = false;
  SideKind kind = SideKind::inflow;
  double flow_rate = 0;  ///< volume into the box per time; 2-D: per depth
  double pressure = 0;   ///< given, or the mean over the open part of the side, extrapolated from two cells
  double power = 0;      ///< of pressure and kinetic energy that come in; without what viscosity does on the side
  std::string name() const { return side_name(direction, high); }
};

/// All sides that volume crosses, in the order xmin, xmax, ymin ...
std::vector<SideFlow> crossed_sides(const BoxSides &sides, const Box &box);
/// Measures them. One ghost layer of the velocity. One Allreduce, or none if there are none.
PetscErrorCode measure_side_flows(const Domain &domain, const BoxSides &sides, double time, double density,
                                  const Field &velocity, const Field &pressure, std::vector<SideFlow> *flows);

}  // namespace eulastic
