// Shear stress of the fluid on the surfaces of vessels and obstacles, in the cells they cut: sigma.n without its normal
// part, with n out of the body (docs/method.md, section 14).
#pragma once

#include "diagnostics/edge_stress.hpp"

namespace eulastic {

/// Adds the shear stress to the three components of `stress` in owned cells that the surface cuts, and in cells without
/// solid beside a full one. `solid`: solid fraction of rigid bodies. Reads three ghosts of it and of the velocity.
/// `viscosity`: dynamic, of the fluid.
void add_rigid_surface_stress(const Box &box, double viscosity, ConstView solid, const Field &velocity, Field &stress);
/// Does the same for elastic bodies; reads two ghosts of B and of the viscosity as well.
void add_elastic_surface_stress(const TotalStress &whole, ConstView solid, Field &stress);

}  // namespace eulastic
