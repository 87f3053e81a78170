// All that is carried from one step to the next.
#pragma once

#include "field/phase.hpp"
#include "field/sides.hpp"
#include "field/surface_marker.hpp"

#include <cstdint>

namespace eulastic {

struct State {
  double time = 0;
  std::int64_t step = 0;
  double dt = 0;                       ///< of the last step; the automatic one grows from it smoothly
  double speed_scale = 0;              ///< max |v| when last measured; scales WENO5's epsilon
  double crossing_rate = 0;            ///< max |u_d|/h_d when last measured, cells per time
  std::int64_t forgotten = 0;          ///< centres where B was not resolved, and mended or set to I, of all steps
  double travel = 0;                   ///< cells the interface may have moved since the labels were carried
  Field velocity;                      ///< u, v (, w) on faces, three ghosts valid
  Field pressure;                      ///< at centres, one ghost valid; half a step behind when staggered
  Field pressure_before;               ///< that of the step before, where it is needed; else empty
  double pressure_interval = 0;        ///< between both, 0: there are not two yet
  Field advection;                     ///< v.grad v of the last step, for Adams-Bashforth; empty with Euler
  std::vector<SurfaceMarker> markers;  ///< of membranes, owned, half a step behind when staggered; in any order
  std::vector<Phase> phases;           ///< three ghosts valid; half a step behind when staggered
};

}  // namespace eulastic
