// All that is carried from one step to the next.
#pragma once

#include "field/phase.hpp"
#include "field/sides.hpp"
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

struct CarriedState {
  std::vector<CheckpointField> fields;
  std::map<std::string, std::vector<double *>> reals;  ///< the same on all ranks
  std::map<std::string, std::vector<std::int64_t *>> integers;

  /// The components of a velocity, NAME_x ...
  void add_velocity(const std::string &name, Field &velocity) {
    for (int d = 0; d < velocity.count(); ++d) fields.push_back({name + "_" + "xyz"[d], at_face[d], velocity[d]});
  }
  void add_centred(const std::string &name, Field &field) {
    if (field) fields.push_back({name, at_centre, field[0]});
  }
};

}  // namespace eulastic
