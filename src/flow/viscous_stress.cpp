#include "flow/viscous_stress.hpp"

#include "base/events.hpp"
#include "flow/stress_rows.hpp"
#include "flow/tangential_stress.hpp"
#include "grid/blocks.hpp"

namespace eulastic {
namespace {

template <int Dim>
EULASTIC_INLINE void add_force(const Box &box, const Field &viscosity, double scale, const Field &velocity, int a,
                               const Segment &faces, int side, double *out) {
  const auto stress = stress_on_row<Dim>(box, viscosity, velocity, a, faces.j, faces.k);
  if (side != 0) {
    for (int i = faces.i_begin; i < faces.i_end; ++i)
      out[i] = kernels::fma(scale, stress.force_on_open_boundary(i, side), out[i]);
    return;
  }
#pragma omp simd
  for (int i = faces.i_begin; i < faces.i_end; ++i) out[i] = kernels::fma(scale, stress.force(i), out[i]);
}

EULASTIC_CLONES void add_force_2d(const Box &box, const Field &viscosity, double scale, const Field &velocity, int a,
                                  const Segment &faces, int side, double *out) {
  add_force<2>(box, viscosity, scale, velocity, a, faces, side, out);
}
EULASTIC_CLONES void add_force_3d(const Box &box, const Field &viscosity, double scale, const Field &velocity, int a,
                                  const Segment &faces, int side, double *out) {
  add_force<3>(box, viscosity, scale, velocity, a, faces, side, out);
}

EULASTIC_CLONES void rotate_row(int n, double factor, const double *viscosity, const double *D, double *p) {
#pragma omp simd
  for (int i = -1; i < n + 1; ++i) p[i] = kernels::fma(-factor * viscosity[i], D[i], p[i]);
}

}  // namespace

PetscErrorCode add_viscous_force(const Box &box, LocalViscosity &viscosity, double scale, const Field &velocity,
                                 Field &out) {
  PetscFunctionBeginUser;
  EventScope scope(Event::viscous);
  compute_tangential_stress(box, velocity, &viscosity);
  const auto add_on_row = [&](int a, const Segment &row) {
    for_faces(box, a, row, [&](const Segment &faces, int side) {
      double *sum = out[a].row(faces.j, faces.k);
      (box.dimension() == 2 ? add_force_2d : add_force_3d)(box, viscosity.fields, scale, velocity, a, faces, side, sum);
      if (side == 0) add_tangential_force(box, viscosity, scale, a, faces, sum);
    });
  };
  in_row_parts(box, [&](const RowPart &part) {
    for_rows_in_blocks(part, [&](int j, int k) {
      for (int a = 0; a < box.dimension(); ++a) add_on_row(a, {0, box.cells()[0], j, k});
    });
  });
  for (int a = 0; a < box.dimension(); ++a)
    for (const Segment &faces : box.open_high_faces(a)) add_on_row(a, faces);
  const double per_point = box.dimension() == 2 ? kernels::viscous_force_flops_2d : kernels::viscous_force_flops_3d;
  scope.flops(box.cell_count() * box.dimension() * (per_point + 2) + tangential_stress_flops(box, viscosity));
  PetscFunctionReturn(0);
}

PetscErrorCode apply_rotational_update(const Box &box, const Field &viscosity, double factor, const Field &divergence,
                                       Field &pressure) {
  PetscFunctionBeginUser;
  EventScope scope(Event::correction);
  in_row_parts(box, [&](const RowPart &owned) {
    const RowPart part = owned.with_ghosts(box);
    for (int k = part.k_begin; k < part.k_end; ++k)
      for (int j = part.j_begin; j < part.j_end; ++j)
        rotate_row(box.cells()[0], factor, viscosity[0].row(j, k), divergence[0].row(j, k), pressure[0].row(j, k));
  });
  scope.flops(box.cell_count() * 3);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
