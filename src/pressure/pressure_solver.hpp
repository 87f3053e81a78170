// One interface for all ways to make the velocity solenoidal: (10) exactly, or (11) by artificial compressibility.
#pragma once

#include "field/field_block.hpp"

namespace eulastic {

class PressureSolver {
public:
  virtual ~PressureSolver() = default;

  /// Finds the pressure increment for lap(increment) = divergence / dt with zero normal derivative on walls.
  /// `divergence`: D* = rho div v* at centres, one ghost layer valid. `pressure`: p^N, one ghost layer valid; a
  /// solver may remove its mean. `increment`: out, one ghost layer valid.
  virtual PetscErrorCode solve(double dt, const FieldBlock &divergence, FieldBlock &pressure, FieldBlock &increment) = 0;
};

}  // namespace eulastic
