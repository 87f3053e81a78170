// Measures of surfaces: sums over all of them, and values in a cell near a membrane.
#pragma once

#include "grid/box.hpp"

namespace eulastic {

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
