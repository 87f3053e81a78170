#include "solids/transport.hpp"

#include "base/events.hpp"
#include "grid/skipping.hpp"
#include "solids/transport_rows.hpp"

namespace eulastic {

using transport::Evolved;
using transport::fraction_at;
using transport::TransportTerms;

PetscErrorCode transport_tensor(const Box &box, const TensorStage &stage, const Field &velocity, const Phase &phase,
                                const Field &tensor, Field &next) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::left_cauchy_green);
  const Real3 &h = box.spacing();
  const TransportTerms terms{
      &box,        stage.dt,       &velocity, {1 / h[0], 1 / h[1], 1 / h[2]}, phase.tensor.rule, stage.second_of_heun,
      stage.stale, skips_nothing()};
  const bool flat = box.dimension() == 2;
  const int parts = row_parts(box);
  std::vector<Evolved> found(parts);
  in_parallel(parts, parts, [&](int part) {
    found[part] = (flat ? transport::advance_tensor_2d : transport::advance_tensor_3d)(
        terms, row_part(box, part, parts), phase, tensor, next);
  });
  Evolved points;
  for (const Evolved &some : found) points = {points.centres + some.centres, points.edges + some.edges};
  const double advection = box.dimension() * (kernels::weno5_flops + 5) + 2;
  const double diagonal = flat ? kernels::stretch_diagonal_flops_2d : kernels::stretch_diagonal_flops_3d;
  const double shear = flat ? kernels::stretch_shear_flops_2d : kernels::stretch_shear_flops_3d;
  scope.flops(double(points.centres) * box.dimension() * (advection + diagonal) +
              double(points.edges) * (advection + shear));
  PetscFunctionReturn(0);
}

PetscErrorCode reset_exterior(const Box &box, const OccupiedRows &before, Phase &phase) {
  PetscFunctionBeginUser;
  const ConstView phi = phase.fraction[0];
  const EvolveRule &rule = phase.tensor.rule;
  for (int f = 0; f < phase.tensor.field.count(); ++f) {
    const TensorComponent &c = phase.tensor.components()[f];
    const auto [a, b, at] = c;
    const View B = phase.tensor.field[f];
    for (int k = 0; k < box.points_end(2, at[2]); ++k)
      for (int j = 0; j < box.points_end(1, at[1]); ++j) {
        if (before.idle(j, k) && phase.rows.idle(j, k)) continue;
        for (int i = 0; i < box.points_end(0, at[0]); ++i)
          if (fraction_at(phi.row(j, k) + i, a == b, phi.stride(a), phi.stride(b)) < (a == b ? rule.centre : rule.edge))
            if (B(i, j, k) != c.rest()) B(i, j, k) = c.rest();  // Field::at_rest
      }
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
