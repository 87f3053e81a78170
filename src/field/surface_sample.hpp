// What is known of surfaces: of all of them, and of a cell near a membrane.
#pragma once

#include "grid/box.hpp"

namespace eulastic {

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
