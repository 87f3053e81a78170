// What the kernel of the stress along surfaces reads, out of the blocks of velocity and viscosity.
#pragma once

#include "field/local_viscosity.hpp"
#include "kernels/tangential_stress.hpp"

namespace eulastic {

/// The stress along surfaces around the centres of a row; two ghosts of v.
template <int Dim>
EULASTIC_INLINE kernels::TangentialStress<Dim> tangential_stress(const Box &box, const Field &viscosity,
                                                                 const Field &velocity, int j, int k) {
  const int along = viscosity_along_surface(Dim), last = Dim - 1;
  const ConstView q = velocity[0];
  const Real3 &h = box.spacing();
  const auto of_block = [j, k](const Field &block, int f) { return block[f].row(j, k); };
  return {of_block(velocity, 0),
          of_block(velocity, 1),
          of_block(velocity, last),
          of_block(viscosity, along),
          of_block(viscosity, along + 1),
          of_block(viscosity, along + 2),
          of_block(viscosity, along + 1 + last),
          q.stride(0),
          q.stride(1),
          q.stride(last),
          1 / h[0],
          1 / h[1],
          1 / h[last]};
}

}  // namespace eulastic
