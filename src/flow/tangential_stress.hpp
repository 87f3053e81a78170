// The viscous stress along surfaces between different viscosities, and its force: docs/method.md, (29a).
#pragma once

#include "flow/viscosity.hpp"

namespace eulastic {

/// Computes the stress at the centres viscosity->stressed and stores it in viscosity->stress. v needs two ghosts.
void compute_tangential_stress(const Box &box, const Field &velocity, LocalViscosity *viscosity);
/// Adds `scale` times the force of this stress to `out` on the faces of a row normal to a.
void add_tangential_force(const Box &box, const LocalViscosity &viscosity, double scale, int a, const Segment &faces,
                          double *out);
/// Returns the flops of both functions.
double tangential_stress_flops(const Box &box, const LocalViscosity &viscosity);

}  // namespace eulastic
