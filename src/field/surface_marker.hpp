// Points of surfaces: markers, which store the undeformed position of a membrane, and measures in cells.
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

/// Sums over all phases; in 2-D per unit depth.
struct SurfaceEnergy {
  double energy = 0;  ///< surface tension times area, energy of membranes, and E_w of (27b)
  double power = 0;   ///< minus the power of the surface forces: from the flow to the surfaces
};

/// Values in a cell at the surface of a membrane.
struct SurfaceSample {
  int label;
  Int3 place;      ///< local index of the cell
  double delta;    ///< delta function of the surface, 1/length
  double rest;     ///< the same for the undeformed surface
  double stretch;  ///< larger principal stretch along the surface
  Real3 velocity;  ///< at the centre of the cell
  double shear_energy, area_energy, bending_energy;
};

}  // namespace eulastic
