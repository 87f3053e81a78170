// The state of a flow, which persists from one step to the next.
#pragma once

#include "field/phase.hpp"
#include "field/sides.hpp"
#include "field/surface_marker.hpp"

#include <cstdint>

namespace eulastic {

struct State {
  double time = 0;
  std::int64_t step = 0;
  double dt = 0;                       ///< of the last step; the automatic one grows gradually from it
  double speed_scale = 0;              ///< max |v| when last measured; scales epsilon of WENO5
  double crossing_rate = 0;            ///< max |u_d|/h_d when last measured, cells per time
  std::int64_t forgotten = 0;          ///< number of centres, over all steps, where an unresolved B was repaired
  double travel_since_labels = 0;      ///< cells the interface may have moved since the labels were updated
  Field velocity;                      ///< u, v (, w) on faces, three ghosts valid
  Field pressure;                      ///< at centres, one ghost valid; half a step behind when staggered
  Field pressure_before;               ///< pressure one step earlier, if it is needed; else empty
  double pressure_interval = 0;        ///< time between both pressures; 0: there is only one yet
  Field advection;                     ///< v.grad v of the last step for Adams-Bashforth; empty with Euler
  std::vector<SurfaceMarker> markers;  ///< of membranes, owned, in any order; half a step behind when staggered
  std::vector<Phase> phases;           ///< three ghosts valid; half a step behind when staggered
};

}  // namespace eulastic
