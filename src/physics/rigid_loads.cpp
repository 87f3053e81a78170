// What the fluid exerts on rigid bodies.
#include "base/events.hpp"
#include "field/exact_sum.hpp"
#include "physics/rigid.hpp"
#include "physics/rigid_rows.hpp"

#include <algorithm>

namespace eulastic {
namespace {

// -1 on the low side of the box that is normal to a, 1 on the high one, else 0.
int side_of_face(const Grid &grid, int a, int i, int j, int k) {
  if (!grid.is_wall(a)) return 0;
  const int at = grid.layout().begin[a] + std::array{i, j, k}[a];
  return at == 0 ? -1 : at == grid.cells()[a] ? 1 : 0;
}

// In cells: a face on an open side has half of one, on others the side gives the velocity.
double volume_of_face(const Grid &grid, int a, int side) { return side == 0 ? 1 : grid.is_open(a, side > 0) ? 0.5 : 0; }

// Laplacian of u in what sides of the box give to the tangential velocity of a face beside them.
double laplacian_of_sides(const Grid &grid, int a, int i, int j, int k, ConstView u) {
  double sum = 0;
  for (int d = 0; d < grid.dimension(); ++d) {
    if (d == a || !grid.is_wall(d)) continue;
    const int at = grid.layout().begin[d] + std::array{i, j, k}[d];
    const double *here = &u(i, j, k), square = grid.spacing()[d] * grid.spacing()[d];
    if (at == 0) sum += (here[-u.stride(d)] - here[0]) / square;
    if (at == grid.cells()[d] - 1) sum += (here[u.stride(d)] - here[0]) / square;
  }
  return sum;
}

}  // namespace

// The momentum equation of the faces inside holds the stress on the stair of faces around them, and what cut faces feel
// of the surface, less what they would feel of the neighbours inside, is the rest. On sides of the box a body has no
// surface: their pressure and friction are not those of the fluid on it. Beside a body that travels a cut face goes
// with the body but for its share, and what is between the stair and the surface is accelerated: as if the stair had
// the body's volume. Power: without what the body's own acceleration takes, as kinetic energy of the box counts it.
PetscErrorCode measure_rigid_loads(const Grid &grid, const RigidFaces &faces, const Fluid &fluid, double time,
                                   bool carried, const FieldBlock &velocity, const FieldBlock &pressure,
                                   const FieldBlock &rate, const Real3 &force, std::vector<RigidLoad> *loads) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::rigid);
  const double mass = fluid.density * grid.cell_volume();
  ExactSums sums(6 * faces.count);
  const auto acceleration = [&](int body, int a, const Real3 &place) {
    const RigidBody &b = faces.bodies[body];
    const RigidMotion &motion = faces.motions[b.motion];
    return carried ? motion.acceleration(RigidFaces::arm(b, place, grid.spacing()), time)[a] : 0;
  };
  const auto add = [&](int body, int a, const Real3 &place, double push) {
    const RigidBody &b = faces.bodies[body];
    const Real3 r = RigidFaces::arm(b, place, grid.spacing());
    Real3 f{};
    f[a] = push;
    sums.add(6 * b.index + a, push);
    for (int d = 0; d < 3; ++d) {
      const int e = (d + 1) % 3, g = (d + 2) % 3;
      if (e == a || g == a) sums.add(6 * b.index + 3 + d, r[e] * f[g] - r[g] * f[e]);
    }
  };
  const auto push = [&](int a, int i, int j, int k, double given) {
    const int side = side_of_face(grid, a, i, j, k);
    const double volume = volume_of_face(grid, a, side);
    const double inside = volume > 0 ? volume * mass * (rate[a](i, j, k) - force[a] - given) : 0;
    if (side == 0) return inside;
    const double *p = &pressure[0](i, j, k);
    return inside + side * grid.cell_volume() / grid.spacing()[a] * 0.5 * (p[0] + p[-pressure[0].stride(a)]);
  };
  const double cut_faces = for_rigid_rows(grid, faces, [&](int a, const RigidFaces::Row &row, int j, int k) {
    const double *u = velocity[a].row(j, k);
    for (const RigidFaces::Cut *cut = row.cuts; cut != row.cuts_end; ++cut) {
      if (!owned(grid, a, cut->i)) continue;
      const double volume = volume_of_face(grid, a, side_of_face(grid, a, cut->i, j, k));
      if (volume == 0) continue;
      const Viscous rates = viscous_rates(grid, faces, *cut, a, time, u + cut->i, strides(velocity[a]));
      const Real3 place = place_of_face(grid, a, cut->i, j, k);
      double of_face = volume * mass * fluid.kinematic_viscosity() * (rates.regular - rates.cut);
      if (faces.motions[faces.bodies[cut->body].motion].travels()) {
        const double *p = pressure[0].row(j, k) + cut->i;
        const double slope = (p[0] - p[-pressure[0].stride(a)]) / (grid.spacing()[a] * fluid.density);
        const double lacks = rate[a](cut->i, j, k) - force[a] - acceleration(cut->body, a, place);
        of_face = cut->share * of_face + volume * mass * ((1 - cut->share) * lacks + (cut->open - cut->share) * slope);
      }
      add(cut->body, a, place, of_face);
    }
    for (const RigidFaces::Run *run = row.runs; run != row.runs_end; ++run)
      for (int i = std::max(run->begin, 0); i < std::min(run->end, grid.faces_end(a, 0)); ++i) {
        const Real3 place = place_of_face(grid, a, i, j, k);
        add(run->body, a, place,
            push(a, i, j, k,
                 acceleration(run->body, a, place) +
                     fluid.kinematic_viscosity() * laplacian_of_sides(grid, a, i, j, k, velocity[a])));
      }
  });
  scope.flops(cut_faces * (viscous_rates_flops(grid.dimension()) + 20));
  std::vector<double> total(6 * faces.count);  // without what accelerates the body itself
  PetscCall(sums.reduce(grid.comm(), total.data()));
  loads->assign(faces.count, {});
  for (const RigidBody &body : faces.bodies) {
    RigidLoad &load = (*loads)[body.index];
    const RigidMotion &motion = faces.motions[body.motion];
    load.power = 0;
    for (int d = 0; d < 3; ++d)
      load.power -= total[6 * body.index + d] * motion.velocity[d] * motion.of_velocity.at(time) +
                    total[6 * body.index + 3 + d] * motion.angular_velocity[d] * motion.of_rotation.at(time);
  }
  for (const RigidBody &body : faces.bodies) {
    const RigidMotion &motion = faces.motions[body.motion];
    const RigidMass &own = faces.masses[body.index];
    const Real3 by_force = carried ? own.force(motion, time, fluid.density) : Real3{},
                by_torque = carried ? own.torque(motion, time, fluid.density) : Real3{};
    for (int d = 0; d < 3; ++d) {
      (*loads)[body.index].force[d] = total[6 * body.index + d] + by_force[d];
      (*loads)[body.index].torque[d] = total[6 * body.index + 3 + d] + by_torque[d];
    }
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
