// Dissipation by viscosity beside rigid bodies.
#include "base/events.hpp"
#include "base/exact_sum.hpp"
#include "grid/domain.hpp"
#include "physics/rigid.hpp"
#include "physics/rigid_rows.hpp"

#include <algorithm>

namespace eulastic {

PetscErrorCode measure_rigid_dissipation(const Domain &domain, const RigidFaces &faces, const Fluid &fluid, double time,
                                         const Field &velocity, double *dissipation) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::rigid);
  const Real3 &h = domain.spacing();
  ExactSums sums(1);
  const double cut_faces = for_rigid_rows(domain, faces, [&](int a, const RigidFaces::Row &row, int j, int k) {
    for (const RigidFaces::Cut *cut = row.cuts; cut != row.cuts_end; ++cut) {
      const int i = cut->i;
      if (!owned(domain, a, i)) continue;
      const double volume = volume_of_face(domain, a, side_of_face(domain, a, i, j, k));
      if (volume == 0) continue;
      const double *u = velocity[a].row(j, k) + i;
      const RigidBody &body = faces.bodies[cut->body];
      const RigidMotion &motion = faces.motions[body.motion];
      const double of_body = faces.velocity(a, body, place_of_face(domain, a, i, j, k), h, motion.of_velocity.at(time),
                                            motion.of_rotation.at(time));
      const Viscous rates = viscous_rates(domain, faces, *cut, a, time, u, strides(velocity[a]));
      sums.add(0, volume * (*u - of_body) * (rates.regular - rates.cut));
    }
    // Faces inside feel no friction on sides of the box, where a body has no surface.
    for (const RigidFaces::Run *run = row.runs; run != row.runs_end; ++run)
      for (int i = std::max(run->begin, 0); i < std::min(run->end, domain.points_end(0, a == 0)); ++i) {
        const double of_body = velocity[a](i, j, k);
        if (of_body != 0)
          sums.add(0, volume_of_face(domain, a, side_of_face(domain, a, i, j, k)) * of_body *
                          laplacian_of_sides(domain, a, i, j, k, velocity[a]));
      }
  });
  scope.flops(cut_faces * (viscous_rates_flops(domain.dimension()) + 10));
  PetscCall(sums.reduce(domain.comm(), dissipation));
  *dissipation *= fluid.viscosity * domain.cell_volume();
  PetscFunctionReturn(0);
}

}  // namespace eulastic
