// The shear stress of the fluid on the surfaces of vessels and obstacles, in the cells that these cut: sigma.n without
// its normal part, n out of the body (docs/method.md, section 14).
#pragma once

#include "diagnostics/edge_stress.hpp"

namespace eulastic {

/// Adds to `stress`, three fields, in owned cells that the surface cuts, and in those without solid whose neighbour is
/// full of it. `solid`: volume fraction of rigid bodies, three ghosts, as of the velocity; `viscosity`: dynamic, of the
/// fluid.
void add_rigid_surface_stress(const Box &box, double viscosity, ConstView solid, const Field &velocity, Field &stress);
/// The same of elastic bodies; two ghosts of B and of the viscosity too.
void add_elastic_surface_stress(const WholeStress &whole, ConstView solid, Field &stress);

}  // namespace eulastic
