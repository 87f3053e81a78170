// The state that persists from one step to the next, as named pointers to the fields and numbers themselves. The hash
// of the state, checkpoints and restarts all use this one list.
#pragma once

#include "io/checkpoint.hpp"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace eulastic {

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
