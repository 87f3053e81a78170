#include "flow/tangential_stress.hpp"

#include "flow/tangential_rows.hpp"
#include "grid/blocks.hpp"
#include "grid/threads.hpp"

#include <algorithm>
#include <cstdint>

namespace eulastic {
namespace {

template <int Dim>
EULASTIC_INLINE void tangential_row(const Box &box, const Field &viscosity, const Field &velocity, Field &out,
                                    const Segment &row) {
  const kernels::TangentialStress<Dim> stress = tangential_stress<Dim>(box, viscosity, velocity, row.j, row.k);
  const auto component = [&](int x, int y) { return out[kernels::position<Dim>(x, y)].row(row.j, row.k); };
  constexpr int z = Dim - 1;
  double *xx = component(0, 0), *yy = component(1, 1), *zz = component(z, z);
  double *yz = component(1, z), *xz = component(0, z), *xy = component(0, 1);
#pragma omp simd
  for (int i = row.i_begin; i < row.i_end; ++i) {
    const typename kernels::TangentialStress<Dim>::Rate rate = stress.rate(i);
    const double excess = stress.excess[i];
    // Where the excess is 0 the rate may be undefined. A select on the result would prevent vectorisation.
    const std::uint64_t mask = excess != 0 ? ~std::uint64_t{0} : 0;
    const auto times = [mask, excess](double r) EULASTIC_BODY {
      return excess * __builtin_bit_cast(double, __builtin_bit_cast(std::uint64_t, r) & mask);
    };
    xx[i] = times(rate.xx);
    yy[i] = times(rate.yy);
    xy[i] = times(rate.xy);
    if constexpr (Dim == 3) {
      zz[i] = times(rate.zz);
      yz[i] = times(rate.yz);
      xz[i] = times(rate.xz);
    }
  }
}

EULASTIC_CLONES void tangential_row_2d(const Box &box, const Field &viscosity, const Field &velocity, Field &out,
                                       const Segment &row) {
  tangential_row<2>(box, viscosity, velocity, out, row);
}
EULASTIC_CLONES void tangential_row_3d(const Box &box, const Field &viscosity, const Field &velocity, Field &out,
                                       const Segment &row) {
  tangential_row<3>(box, viscosity, velocity, out, row);
}

template <int Dim>
EULASTIC_INLINE void add_tangential_force(const Box &box, const Field &stress, double scale, int a, const Segment &row,
                                          double *out) {
  const int b = (a + 1) % Dim, c = Dim == 3 ? (a + 2) % 3 : b;
  const auto component = [&](int x, int y) { return stress[kernels::position<Dim>(x, y)].row(row.j, row.k); };
  const ConstView q = stress[0];
  const Real3 &h = box.spacing();
  const kernels::DivergenceFromCentres<Dim> force{component(a, a), component(a, b), component(a, c),
                                                  q.stride(a),     q.stride(b),     q.stride(c),
                                                  1 / h[a],        1 / h[b],        1 / h[c]};
#pragma omp simd
  for (int i = row.i_begin; i < row.i_end; ++i) out[i] = kernels::fma(scale, force.at(i), out[i]);
}

EULASTIC_CLONES void add_tangential_force_2d(const Box &box, const Field &stress, double scale, int a,
                                             const Segment &row, double *out) {
  add_tangential_force<2>(box, stress, scale, a, row, out);
}
EULASTIC_CLONES void add_tangential_force_3d(const Box &box, const Field &stress, double scale, int a,
                                             const Segment &row, double *out) {
  add_tangential_force<3>(box, stress, scale, a, row, out);
}

// Prefetches the data of a later segment that earlier ones did not read or write.
void prefetch_ahead(const LocalViscosity &viscosity, const Field &velocity, const Segment &cells) {
  const auto prefetch_piece = [&cells](const double *row) { prefetch(row + cells.i_begin, cells.size()); };
  for (int d = 0; d < 3; ++d) prefetch_piece(velocity[d].row(cells.j, cells.k + 1));
  for (int f = viscosity_along_surface(3); f < viscosity_fields(3); ++f)
    prefetch_piece(viscosity.fields[f].row(cells.j, cells.k));
  for (int c = 0; c < viscosity.stress.count(); ++c) prefetch_piece(viscosity.stress[c].row(cells.j, cells.k));
}

}  // namespace

void compute_tangential_stress(const Box &box, const Field &velocity, LocalViscosity *viscosity) {
  constexpr std::ptrdiff_t ahead = 8;
  const bool flat = box.dimension() == 2;
  in_segment_parts(viscosity->stressed.all(), box, [&](const Segment *begin, const Segment *end) {
    for (const Segment *cells = begin; cells < end; ++cells) {
      if (!flat && end - cells > ahead) prefetch_ahead(*viscosity, velocity, cells[ahead]);
      (flat ? tangential_row_2d : tangential_row_3d)(box, viscosity->fields, velocity, viscosity->stress, *cells);
    }
  });
}

void add_tangential_force(const Box &box, const LocalViscosity &viscosity, double scale, int a, const Segment &faces,
                          double *out) {
  if (viscosity.stressed.all().empty()) return;
  for (Segment s : viscosity.beside.row(faces.j, faces.k)) {
    s.i_begin = std::max(s.i_begin, faces.i_begin);
    s.i_end = std::min(s.i_end, faces.i_end);
    (box.dimension() == 2 ? add_tangential_force_2d : add_tangential_force_3d)(box, viscosity.stress, scale, a, s, out);
  }
}

double tangential_stress_flops(const Box &box, const LocalViscosity &viscosity) {
  const bool flat = box.dimension() == 2;
  return viscosity.stressed.points() *
             (flat ? kernels::tangential_stress_flops_2d : kernels::tangential_stress_flops_3d) +
         viscosity.beside.points() * box.dimension() *
             (2 + (flat ? kernels::centred_divergence_flops_2d : kernels::centred_divergence_flops_3d));
}

}  // namespace eulastic
