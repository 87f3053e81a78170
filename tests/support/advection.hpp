// -v . grad q of a row with velocities that are there already.
#pragma once

#include "kernels/weno5.hpp"

namespace eulastic::test {

/// rate = -v . grad q; velocity[d] and rate by cells of the row.
template <int Dim>
EULASTIC_INLINE void advection_rate(const Segment &s, ConstView q, const double *const *velocity,
                                    const double *inverse_spacing, double epsilon, double *rate) {
  for (int d = 0; d < Dim; ++d) {
    const double *along = velocity[d];
    kernels::add_advection_rate(
        s, q, d, kernels::direction_order(d, Dim), [=](int i) EULASTIC_BODY { return along[i]; }, inverse_spacing[d],
        epsilon, rate);
  }
}

}  // namespace eulastic::test
