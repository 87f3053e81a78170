// MembraneTransport: the force of membranes on the flow.
#include "base/events.hpp"
#include "grid/row_scratch.hpp"
#include "physics/membrane.hpp"
#include "physics/membrane_tensor.hpp"
#include "physics/net_force.hpp"
#include "physics/smooth_row.hpp"
#include "field/sides.hpp"
#include "grid/threads.hpp"

#include <algorithm>

namespace eulastic {
namespace {

// Of fourth order: across the band of delta, a few cells, the terms of div(delta tau) cancel up to the error of the
// differences.
EULASTIC_INLINE double between(const double *q, std::ptrdiff_t s) noexcept {
  return (9. / 16) * (q[0] + q[-s]) - (1. / 16) * (q[s] + q[-2 * s]);
}
EULASTIC_INLINE double edge_value(const double *q, std::ptrdiff_t s, std::ptrdiff_t t) noexcept {
  return (9. / 16) * (between(q, s) + between(q - t, s)) - (1. / 16) * (between(q + t, s) + between(q - 2 * t, s));
}
constexpr double near_difference = 27. / 24, far_difference = 1. / 24;

// div T on faces of component a, of a row.
template <int Dim>
EULASTIC_INLINE void divergence_row(const FieldBlock &T, int a, const Real3 &inverse, int n, int j, int k, double scale,
                                    double *out) {
  const ConstView q = T[a];
  const double *aa = q.row(j, k);
  const std::ptrdiff_t sa = q.stride(a);
  for (int i = 0; i < n; ++i)
    out[i] = scale * inverse[a] * (near_difference * (aa[i] - aa[i - sa]) - far_difference * (aa[i + sa] - aa[i - 2 * sa]));
  for (int e = 1; e < Dim; ++e) {
    const int b = (a + e) % Dim;
    const double *ab = T[Dim == 2 ? 2 : 6 - a - b].row(j, k);
    const double ib = scale * inverse[b];
    const std::ptrdiff_t sb = q.stride(b);
#pragma omp simd
    for (int i = 0; i < n; ++i) {
      const double *p = ab + i;
      const double near = edge_value(p + sb, sa, sb) - edge_value(p, sa, sb);
      const double far = edge_value(p + 2 * sb, sa, sb) - edge_value(p - sb, sa, sb);
      out[i] = kernels::fma(ib, near_difference * near - far_difference * far, out[i]);
    }
  }
}
EULASTIC_CLONES void divergence_2d(const FieldBlock &T, int a, const Real3 &inverse, int n, int j, int k, double scale,
                                   double *out) {
  divergence_row<2>(T, a, inverse, n, j, k, scale, out);
}
EULASTIC_CLONES void divergence_3d(const FieldBlock &T, int a, const Real3 &inverse, int n, int j, int k, double scale,
                                   double *out) {
  divergence_row<3>(T, a, inverse, n, j, k, scale, out);
}

// Rows in which faces feel a stress that lives in rows that are not idle, or the next ones.
bool feels(const OccupiedRows &rows, int j, int k) {
  for (int m = -1; m <= 1; ++m)
    for (int n = -1; n <= 1; ++n)
      if (!rows.idle(j + n, k + m)) return true;
  return false;
}

}  // namespace

// delta tau in owned cells and one layer of ghosts; 0 elsewhere on rows that feel it.
PetscErrorCode MembraneTransport::find_stress(const Phase &phase, FieldBlock &stress) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::membrane);
  const int dim = grid_->dimension();
  const Int3 &n = grid_->owned();
  for (int f = 0; f < stress.count(); ++f) clear_around(*grid_, phase.rows, 3, stress[f]);
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
    bool near = true;
    for (int d = 0; d < dim; ++d) near = near && cell.place[d] >= 0 && cell.place[d] < n[d];
    if (!near) continue;
    if (dim == 2)
      set_tensor<2>(stress, cell.at,
                    set(cell, tensor_at<2>(phase.tensor, cell.at), kernels::tangential<2>(normal_of<2>(cell.normal))));
    else
      set_tensor<3>(stress, cell.at,
                    set(cell, tensor_at<3>(phase.tensor, cell.at), kernels::tangential<3>(normal_of<3>(cell.normal))));
  }
  PetscCall(exchange_->update(stress, 4, &phase.rows));
  fill_wall_ghosts_centred_tensor(*grid_, stress, 4, &phase.rows);
  if (0) {
    const double a = 0;
    WorkSpace::Lease lease;
    PetscCall(work_->take("mean of the stress", 1, &lease));
    FieldBlock &mean = lease.fields();
    for (int f = 0; f < stress.count(); ++f) {
      in_parallel(1, 1, [&](int) {
        RowScratch scratch(*grid_, 1);
        const int deep = dim == 3 ? 1 : 0;
        for (int k = -deep; k < n[2] + deep; ++k)
          for (int j = -1; j <= n[1]; ++j)
            if (feels(phase.rows, j, k))
              smooth_row(dim, stress[f], j, k, -1, n[0] + 1, scratch.row(0), mean[0].row(j, k));
        for (int k = -deep; k < n[2] + deep; ++k)
          for (int j = -1; j <= n[1]; ++j)
            if (feels(phase.rows, j, k))
              for (int i = -1; i <= n[0]; ++i) {
                double &T = stress[f](i, j, k);
                T += a * (T - mean[0](i, j, k));
              }
      });
    }
  }
  PetscFunctionReturn(0);
}

// Of the cells in surface_: that of the stress, then that of bending.
PetscErrorCode MembraneTransport::for_force_rows(const Phase &phase, ConstView smooth, double scale,
                                                 const ForceRow &use) {
  PetscFunctionBeginUser;
  const int dim = grid_->dimension();
  const Real3 &h = grid_->spacing(), inverse{1 / h[0], 1 / h[1], 1 / h[2]};
  const int n = grid_->owned()[0];
  for (const bool bending : {false, true}) {
    if (bending && !(phase.material.membrane.bending_modulus > 0)) continue;
    WorkSpace::Lease lease;
    FieldBlock &fields = lease.fields();
    PetscCall(work_->take(bending ? "bending" : "stress of a membrane",
                          bending ? MembraneBending::work_fields : phase.tensor.count(), &lease));
    if (bending)
      PetscCall(bending_.find(phase, smooth, fields));
    else
      PetscCall(find_stress(phase, fields));
    VerbScope scope(Verb::membrane);
    in_row_parts(*grid_, [&](const RowPart &part) {
      RowScratch scratch(*grid_, 1);
      double *force = scratch.row(0);
      for (int k = part.k_begin; k < part.k_end; ++k)
        for (int j = part.j_begin; j < part.j_end; ++j) {
          if (phase.rows.idle(j, k)) continue;
          for (int a = 0; a < dim; ++a) {
            if (bending)
              bending_.force_row(fields, a, j, k, scale, force);
            else
              (dim == 2 ? divergence_2d : divergence_3d)(fields, a, inverse, n, j, k, scale, force);
            use(part.number, bending, a, j, k, force);
          }
        }
    });
    scope.flops(double(phase.rows.cells()) * dim * (bending ? 6 : 12 * dim));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode MembraneTransport::add_force(const std::vector<Phase> &phases, double scale, bool balanced,
                                            FieldBlock &force, const ForceSlope &slope) {
  PetscFunctionBeginUser;
  const int n = grid_->owned()[0];
  const bool bends = std::any_of(phases.begin(), phases.end(), [](const Phase &phase) {
    return phase.material.is_membrane() && phase.material.membrane.bending_modulus > 0;
  });
  NetForce net(*grid_, balanced && drifts_ && bends);
  for (const Phase &phase : phases) {
    if (!phase.material.is_membrane()) continue;
    WorkSpace::Lease psi;
    PetscCall(work_->take("smoothed solid fraction", 1, &psi));
    PetscCall(surface_.find(phase, psi.fields()));
    PetscCall(for_force_rows(
        phase, psi.fields()[0], scale, [&](int part, bool bending, int a, int j, int k, const double *added) {
          add_force_row(n, added, slope.factor, force[a].row(j, k), slope.field ? (*slope.field)[a].row(j, k) : nullptr);
          if (bending) net.add_row(part, a, added);
        }));
  }
  PetscCall(net.take_off(force));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
