// Membrane: the force of membranes on the flow.
#include "base/events.hpp"
#include "field/sides.hpp"
#include "grid/row_scratch.hpp"
#include "grid/threads.hpp"
#include "physics/membrane.hpp"
#include "physics/membrane_tensor.hpp"
#include "physics/smooth_row.hpp"

#include <algorithm>

namespace eulastic {
namespace {

// Half way between q[-s] and q[0], of fourth order.
EULASTIC_INLINE double between(const double *q, std::ptrdiff_t s) noexcept {
  return (9. / 16) * (q[-s] + q[0]) - (1. / 16) * (q[-2 * s] + q[s]);
}

// div T on faces of component a, of a row. Within the few cells of delta the terms have to cancel where the surface is
// flat and its tension uniform, in whatever direction.
template <int Dim>
EULASTIC_INLINE void divergence_row(const Field &T, int a, const Real3 &inverse, int n, int j, int k, double *out) {
  const ConstView q = T[a];
  const double *aa = q.row(j, k);
  const std::ptrdiff_t sa = q.stride(a);
  for (int i = 0; i < n; ++i) out[i] = inverse[a] * (aa[i] - aa[i - sa]);
  for (int e = 1; e < Dim; ++e) {
    const int b = (a + e) % Dim;
    const double *ab = T[Dim == 2 ? 2 : 6 - a - b].row(j, k);
    const double ib = inverse[b];
    const std::ptrdiff_t sb = q.stride(b);
#pragma omp simd
    for (int i = 0; i < n; ++i) {
      const double *p = ab + i;
      const double near = between(p + sb, sa) - between(p - sb, sa);
      const double far = between(p + 2 * sb, sa) - between(p - 2 * sb, sa);
      out[i] = kernels::fma(ib, (2. / 3) * near - (1. / 12) * far, out[i]);
    }
  }
}
EULASTIC_CLONES void divergence_2d(const Field &T, int a, const Real3 &inverse, int n, int j, int k, double *out) {
  divergence_row<2>(T, a, inverse, n, j, k, out);
}
EULASTIC_CLONES void divergence_3d(const Field &T, int a, const Real3 &inverse, int n, int j, int k, double *out) {
  divergence_row<3>(T, a, inverse, n, j, k, out);
}

// Of these differences: the stress lives in three cells around a body, and rows that are not idle reach five.
constexpr int force_reach = 2;

}  // namespace

// delta tau at centres, with the ghosts that the force takes; 0 elsewhere on rows that feel it.
PetscErrorCode MembraneMechanics::find_stress(const Phase &phase, Field &stress) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::membrane);
  const int dim = place_.box->dimension();
  for (int f = 0; f < stress.count(); ++f) clear_around(*place_.box, phase.rows, force_reach, stress[f]);
  const auto set = [&](const SurfaceCells::Cell &cell, auto zero, auto P) {
    auto B = zero;
    const kernels::MembraneState state = kernels::membrane_state(
        phase.material.membrane, kernels::surface_strain<int(std::tuple_size_v<decltype(B)>)>(B));
    for (std::size_t a = 0; a < B.size(); ++a)
      for (std::size_t b = 0; b < B.size(); ++b)
        B[a][b] = cell.spread * kernels::fma(state.alpha, B[a][b], state.beta * P[a][b]);
    return B;
  };
  for (const SurfaceCells::Cell &cell : surface_.all()) {
    if (!cell.owned) continue;
    if (dim == 2)
      set_tensor<2>(
          stress, cell.at,
          set(cell, tensor_at<2>(phase.tensor.field, cell.at), kernels::tangential<2>(normal_of<2>(cell.normal))));
    else
      set_tensor<3>(
          stress, cell.at,
          set(cell, tensor_at<3>(phase.tensor.field, cell.at), kernels::tangential<3>(normal_of<3>(cell.normal))));
  }
  PetscCall(place_.exchange_ghosts(stress, force_reach, &phase.rows));
  fill_wall_ghosts_centred_tensor(*place_.box, stress, force_reach, &phase.rows);
  PetscFunctionReturn(0);
}

// That of the stress, then that of bending.
PetscErrorCode MembraneMechanics::for_force_rows(const Phase &phase, const ForceRow &use,
                                                 std::vector<double> *bending_energy) {
  PetscFunctionBeginUser;
  const int dim = place_.box->dimension();
  const Real3 &h = place_.box->spacing(), inverse{1 / h[0], 1 / h[1], 1 / h[2]};
  const int n = place_.box->cells()[0];
  if (bending_energy) bending_energy->assign(surface_.all().size(), 0);
  for (const bool bending : {false, true}) {
    if (bending && !(phase.material.membrane.bending_modulus > 0)) continue;
    Field fields = others_.part(0, bending ? MembraneBending::work_fields : phase.tensor.field.count());
    if (bending)
      PetscCall(bending_.find(phase, smooth(), fields));
    else
      PetscCall(find_stress(phase, fields));
    VerbScope scope(Verb::membrane);
    in_row_parts(*place_.box, [&](const RowPart &part) {
      RowScratch scratch(*place_.box, 1);
      double *force = scratch.row(0);
      for (int k = part.k_begin; k < part.k_end; ++k)
        for (int j = part.j_begin; j < part.j_end; ++j) {
          if (phase.rows.idle(j, k)) continue;
          for (int a = 0; a < dim; ++a) {
            if (bending)
              bending_.force_row(fields, a, j, k, force);
            else
              (dim == 2 ? divergence_2d : divergence_3d)(fields, a, inverse, n, j, k, force);
            use(part.number, bending, a, j, k, force);
          }
        }
    });
    for (std::size_t c = 0; bending && bending_energy && c < bending_energy->size(); ++c)
      if (const SurfaceCells::Cell &cell = surface_.all()[c]; cell.owned)
        (*bending_energy)[c] = MembraneBending::energy(phase.material, fields, cell.at);
    scope.flops(double(phase.rows.cells()) * dim * (bending ? 6 : 12 * dim));
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
