// What a cell near a membrane says of it.
#pragma once

#include "field/material.hpp"

namespace eulastic {

/// A cell at a surface.
struct SurfaceSample {
  int label;
  Int3 place;        ///< local
  double delta;      ///< of the surface, 1/length
  double spread;     ///< delta that spreads forces
  double surface_x;  ///< of the nearest point of the surface, in cells from the cell's centre
  const Material *material;
  Real3 velocity;  ///< at its centre
  double shear_energy, area_energy, bending_energy;
};

}  // namespace eulastic
