// What a cell near a membrane says of it.
#pragma once

#include "grid/box.hpp"

namespace eulastic {

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
