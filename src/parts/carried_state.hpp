// All that is carried from one step to the next, each value named once, where it lies: the hash of the state, a
// checkpoint and a restart go through it.
#pragma once

#include "io/checkpoint.hpp"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace eulastic {

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
