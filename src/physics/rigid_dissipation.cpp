// Dissipation by viscosity beside rigid bodies.
#include "base/events.hpp"
#include "field/exact_sum.hpp"
#include "physics/rigid.hpp"
#include "physics/rigid_rows.hpp"

namespace eulastic {

PetscErrorCode measure_rigid_dissipation(const Grid &grid, const RigidFaces &faces, const Fluid &fluid, double time,
                                         const FieldBlock &velocity, double *dissipation) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::rigid);
  const Real3 &h = grid.spacing();
  ExactSums sums(1);
  const double cut_faces = for_rigid_rows(grid, faces, [&](int a, const RigidFaces::Row &row, int j, int k) {
    for (const RigidFaces::Cut *cut = row.cuts; cut != row.cuts_end; ++cut) {
      const int i = cut->i;
      if (!owned(grid, a, i)) continue;
      const double volume = volume_of_face(grid, a, side_of_face(grid, a, i, j, k));
      if (volume == 0) continue;
      const double *u = velocity[a].row(j, k) + i;
      const RigidBody &body = faces.bodies[cut->body];
      const RigidMotion &motion = faces.motions[body.motion];
      const double of_body = faces.velocity(a, body, place_of_face(grid, a, i, j, k), h, motion.of_velocity.at(time),
                                            motion.of_rotation.at(time));
      const Viscous rates = viscous_rates(grid, faces, *cut, a, time, u, strides(velocity[a]));
      sums.add(0, volume * (*u - of_body) * (rates.regular - rates.cut));
    }
  });
  scope.flops(cut_faces * (viscous_rates_flops(grid.dimension()) + 10));
  PetscCall(sums.reduce(grid.comm(), dissipation));
  *dissipation *= fluid.viscosity * grid.cell_volume();
  PetscFunctionReturn(0);
}

}  // namespace eulastic
