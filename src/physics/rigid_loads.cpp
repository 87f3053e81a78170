// What the fluid exerts on rigid bodies of a scene in which some travel.
#include "base/events.hpp"
#include "field/exact_sum.hpp"
#include "grid/domain.hpp"
#include "physics/rigid.hpp"
#include "physics/rigid_rows.hpp"

#include <algorithm>

namespace eulastic {
namespace {

// Sums over the faces that bodies are at, of what they push.
class RigidLoadSums {
public:
  RigidLoadSums(const Domain &domain, const RigidFaces &faces, const Fluid &fluid, double time, bool carried,
                const FieldBlock &velocity, const FieldBlock &pressure, const FieldBlock &rate, const Real3 &force)
      : domain_(domain),
        faces_(faces),
        fluid_(fluid),
        time_(time),
        carried_(carried),
        velocity_(velocity),
        pressure_(pressure),
        rate_(rate),
        force_(force),
        mass_(fluid.density * domain.cell_volume()),
        sums_(6 * faces.count) {}

  void add_row(int a, const RigidFaces::Row &row, int j, int k) {
    for (const RigidFaces::Cut *cut = row.cuts; cut != row.cuts_end; ++cut) add_cut(a, *cut, j, k);
    for (const RigidFaces::Run *run = row.runs; run != row.runs_end; ++run)
      for (int i = std::max(run->begin, 0); i < std::min(run->end, domain_.faces_end(a, 0)); ++i)
        add(run->body, a, i, j, k, push_of_inner(run->body, a, i, j, k));
  }
  /// Force and torque of each body, without what accelerates the body itself.
  PetscErrorCode reduce(std::vector<double> *total) {
    PetscFunctionBeginUser;
    total->assign(6 * faces_.count, 0);
    PetscCall(sums_.reduce(domain_.comm(), total->data()));
    PetscFunctionReturn(0);
  }

private:
  Real3 arm(int body, int a, int i, int j, int k) const {
    return RigidFaces::arm(faces_.bodies[body], place_of_face(domain_, a, i, j, k), domain_.spacing());
  }
  const RigidMotion &motion(int body) const { return faces_.motions[faces_.bodies[body].motion]; }
  double acceleration(int body, int a, int i, int j, int k) const {
    return carried_ ? motion(body).acceleration(arm(body, a, i, j, k), time_)[a] : 0;
  }

  void add(int body, int a, int i, int j, int k, double push) {
    const Real3 r = arm(body, a, i, j, k);
    const int at = 6 * faces_.bodies[body].index;
    Real3 f{};
    f[a] = push;
    sums_.add(at + a, push);
    for (int d = 0; d < 3; ++d) {
      const int e = (d + 1) % 3, g = (d + 2) % 3;
      if (e == a || g == a) sums_.add(at + 3 + d, r[e] * f[g] - r[g] * f[e]);
    }
  }

  double push_of_inner(int body, int a, int i, int j, int k) const {
    const double given = acceleration(body, a, i, j, k) +
                         fluid_.kinematic_viscosity() * laplacian_of_sides(domain_, a, i, j, k, velocity_[a]);
    const int side = side_of_face(domain_, a, i, j, k);
    const double volume = volume_of_face(domain_, a, side);
    const double inside = volume > 0 ? volume * mass_ * (rate_[a](i, j, k) - force_[a] - given) : 0;
    if (side == 0) return inside;
    const double *p = &pressure_[0](i, j, k);
    return inside + side * domain_.cell_volume() / domain_.spacing()[a] * 0.5 * (p[0] + p[-pressure_[0].stride(a)]);
  }

  void add_cut(int a, const RigidFaces::Cut &cut, int j, int k) {
    const int i = cut.i;
    if (!owned(domain_, a, i)) return;
    const double volume = volume_of_face(domain_, a, side_of_face(domain_, a, i, j, k));
    if (volume == 0) return;
    const Viscous rates =
        viscous_rates(domain_, faces_, cut, a, time_, velocity_[a].row(j, k) + i, strides(velocity_[a]));
    double push = volume * mass_ * fluid_.kinematic_viscosity() * (rates.regular - rates.cut);
    if (motion(cut.body).travels()) {
      const double *p = pressure_[0].row(j, k) + i;
      const double slope = (p[0] - p[-pressure_[0].stride(a)]) / (domain_.spacing()[a] * fluid_.density);
      const double lacks = rate_[a](i, j, k) - force_[a] - acceleration(cut.body, a, i, j, k);
      push = cut.share * push + volume * mass_ * ((1 - cut.share) * lacks + (cut.open - cut.share) * slope);
    }
    add(cut.body, a, i, j, k, push);
  }

  const Domain &domain_;
  const RigidFaces &faces_;
  const Fluid &fluid_;
  double time_;
  bool carried_;
  const FieldBlock &velocity_, &pressure_, &rate_;
  const Real3 &force_;
  double mass_;  // of the fluid in a cell
  ExactSums sums_;
};

}  // namespace

// The momentum equation of the faces inside holds the stress on the stair of faces around them, and what cut faces feel
// of the surface, less what they would feel of the neighbours inside, is the rest. On sides of the box a body has no
// surface: their pressure and friction are not those of the fluid on it. Beside a body that travels a cut face goes
// with the body but for its share, and what is between the stair and the surface is accelerated: as if the stair had
// the body's volume. Power: without what the body's own acceleration takes, as kinetic energy of the box counts it.
PetscErrorCode measure_rigid_loads(const Domain &domain, const RigidFaces &faces, const Fluid &fluid, double time,
                                   bool carried, const FieldBlock &velocity, const FieldBlock &pressure,
                                   const FieldBlock &rate, const Real3 &force, std::vector<RigidLoad> *loads) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::rigid);
  RigidLoadSums sums(domain, faces, fluid, time, carried, velocity, pressure, rate, force);
  const double cut_faces = for_rigid_rows(
      domain, faces, [&](int a, const RigidFaces::Row &row, int j, int k) { sums.add_row(a, row, j, k); });
  scope.flops(cut_faces * (viscous_rates_flops(domain.dimension()) + 20));
  std::vector<double> total;
  PetscCall(sums.reduce(&total));
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
