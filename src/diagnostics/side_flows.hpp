// Flow rates, pressures and powers of the boundaries that volume crosses. Sums are exact, so that the bits do not
// depend on the ranks.
#pragma once

#include "base/petsc.hpp"
#include "field/boundaries.hpp"
#include "grid/domain.hpp"

#include <string>

namespace eulastic {

struct SideFlow {
  int direction = 0;
  bool high = false;
  BoundaryKind kind = BoundaryKind::inflow;
  double flow_rate = 0;  ///< volume into the box per time; in 2-D per depth
  double pressure = 0;   ///< given, or the mean over the open part of the boundary, extrapolated from two cells
  double power = 0;      ///< of pressure and kinetic energy into the box; viscous work on the boundary is neglected
  std::string name() const { return side_name(direction, high); }
};

/// All boundaries that volume crosses, in the order xmin, xmax, ymin, ...
std::vector<SideFlow> crossed_boundaries(const BoundaryConditions &sides, const Box &box);
/// Measures the boundaries of crossed_boundaries(). Reads one ghost layer of the velocity. One Allreduce if there are
/// any.
PetscErrorCode measure_side_flows(const Domain &domain, const BoundaryConditions &sides, double time, double density,
                                  const Field &velocity, const Field &pressure, std::vector<SideFlow> *flows);

}  // namespace eulastic
