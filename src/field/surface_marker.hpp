// A material point of a membrane, by which its surface knows its shape at rest.
#pragma once

#include "grid/box.hpp"

#include <cstdint>

namespace eulastic {

struct SurfaceMarker {
  std::int64_t number = 0;         ///< of the body's markers
  int label = 0;                   ///< of the body, 0 where there are none
  int phase = 0;                   ///< position in the vector of phases
  Int3 cell{};                     ///< global
  Real3 offset{};                  ///< from the cell's centre, in cells
  Real3 rest{};                    ///< where it was when it was placed, in the box
  Real3 normal{};                  ///< of the surface there, when it was placed
  std::array<double, 6> metric{};  ///< of the membrane's rest there: xx, yy, zz, yz, xz, xy; 1 of one that was at rest

  static constexpr int numbers = 21;
  /// All of it, exactly.
  std::array<double, numbers> packed() const;
  static SurfaceMarker unpacked(const double *values);
};

}  // namespace eulastic
