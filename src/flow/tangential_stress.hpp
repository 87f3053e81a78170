// The stress along surfaces between viscosities, of a velocity, and its force: docs/method.md, (29a).
#pragma once

#include "flow/viscosity.hpp"

namespace eulastic {

/// At all centres whose faces feel it; two ghosts of v. Writes the stress of `viscosity`.
void find_tangential_stress(const Box &box, const Field &velocity, LocalViscosity *viscosity);
/// out += scale times its force on faces of a row, normal to a.
void add_tangential_force(const Box &box, const LocalViscosity &viscosity, double scale, int a, const Segment &faces,
                          double *out);
/// Of both.
double tangential_stress_flops(const Box &box, const LocalViscosity &viscosity);

}  // namespace eulastic
