// Points of surfaces: markers by which a membrane knows its shape at rest, and samples of what surfaces do.
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

/// Of all phases together; 2-D: per unit depth.
struct SurfaceEnergy {
  double energy = 0;  ///< sum of sigma times the area of the planes that transport cuts cells with, and of membranes
  double power = 0;   ///< minus that of the forces: flow to surfaces
};

/// A cell at a surface.
struct SurfaceSample {
  int label;
  Int3 place;      ///< local
  double delta;    ///< of the surface, 1/length
  double rest;     ///< the same of what the surface was at rest
  double stretch;  ///< larger principal stretch along the surface
  Real3 velocity;  ///< at its centre
  double shear_energy, area_energy, bending_energy;
};

}  // namespace eulastic
