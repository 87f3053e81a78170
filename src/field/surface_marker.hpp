// A material point on the surface of a membrane, which stores its undeformed position.
#pragma once

#include "grid/box.hpp"

#include <cstdint>

namespace eulastic {

struct SurfaceMarker {
  std::int64_t number = 0;  ///< number of the marker on its body
  int label = 0;            ///< label of the body, 0 if there are no labels
  int phase = 0;            ///< index in the vector of phases
  Int3 cell{};              ///< global index of its cell
  Real3 offset{};           ///< from the centre of the cell, in cells
  Real3 rest{};             ///< undeformed position in the box
  Real3 normal{};           ///< normal of the surface when the marker was placed
  /// M of (25a) when it was placed: xx, yy, zz, yz, xz, xy; the identity for an undeformed membrane
  std::array<double, 6> metric{};

  static constexpr int numbers = 21;
  /// Returns all members as doubles, exactly.
  std::array<double, numbers> packed() const;
  static SurfaceMarker unpacked(const double *values);
};

}  // namespace eulastic
