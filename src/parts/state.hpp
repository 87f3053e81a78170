// The state of a flow, which persists from one step to the next.
#pragma once

#include "field/boundaries.hpp"
#include "field/phase.hpp"
#include "field/surface_marker.hpp"
#include "io/checkpoint.hpp"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

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

struct CarriedState {
  std::vector<CheckpointField> fields;
  std::map<std::string, std::vector<double *>> reals;  ///< equal on all ranks
  std::map<std::string, std::vector<std::int64_t *>> integers;

  /// Adds the components of a velocity on faces as NAME_x, NAME_y (, NAME_z).
  void add_velocity(const std::string &name, Field &velocity) {
    for (int d = 0; d < velocity.count(); ++d) fields.push_back({name + "_" + "xyz"[d], at_face[d], velocity[d]});
  }
  /// Adds a scalar at centres; an empty field is skipped.
  void add_centred(const std::string &name, Field &field) {
    if (field) fields.push_back({name, at_centre, field[0]});
  }
};

}  // namespace eulastic
