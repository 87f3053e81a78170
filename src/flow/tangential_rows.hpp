// Input of the kernel for the stress along surfaces, from the fields of velocity and viscosity.
#pragma once

#include "flow/local_viscosity.hpp"
#include "kernels/tangential_stress.hpp"

namespace eulastic {

/// Returns the stress along surfaces around the centres of a row. v needs two ghosts.
template <int Dim>
EULASTIC_INLINE kernels::TangentialStress<Dim> tangential_stress(const Box &box, const Field &viscosity,
                                                                 const Field &velocity, int j, int k) {
  const int along = viscosity_along_surface(Dim), last = Dim - 1;
  const ConstView q = velocity[0];
  const Real3 &h = box.spacing();
  const auto component = [j, k](const Field &field, int f) { return field[f].row(j, k); };
  return {component(velocity, 0),
          component(velocity, 1),
          component(velocity, last),
          component(viscosity, along),
          component(viscosity, along + 1),
          component(viscosity, along + 2),
          component(viscosity, along + 1 + last),
          q.stride(0),
          q.stride(1),
          q.stride(last),
          1 / h[0],
          1 / h[1],
          1 / h[last]};
}

}  // namespace eulastic
