// A force per mass, constant or oscillating.
#pragma once

#include "grid/box.hpp"

#include <cmath>

namespace eulastic {

/// The force per mass f cos(frequency t + phase).
struct BodyForce {
  Real3 force{};         ///< length / time^2
  double frequency = 0;  ///< angular, 1 / time
  double phase = 0;      ///< rad
  bool acts() const { return force != Real3{}; }
  Real3 at(double time) const {
    const double factor = frequency == 0 && phase == 0 ? 1.0 : std::cos(frequency * time + phase);
    return {force[0] * factor, force[1] * factor, force[2] * factor};
  }
};

}  // namespace eulastic
