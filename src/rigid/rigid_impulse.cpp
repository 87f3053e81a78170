#include "rigid/rigid_impulse.hpp"

#include "base/events.hpp"
#include "base/exact_sum.hpp"
#include "rigid/rigid_rows.hpp"

#include <algorithm>

namespace eulastic {

RigidImpulse::RigidImpulse(const Domain &domain, const RigidFaces &faces, const Fluid &fluid)
    : domain_(domain), faces_(faces), fluid_(fluid) {
  find_contacts();
}

void RigidImpulse::find_contacts() {
  const int cells = domain_.cells()[0];
  contacts_.clear();
  std::array<std::vector<int>, 2> beside{std::vector<int>(cells), std::vector<int>(cells)};
  for (const Segment &row : domain_.rows())
    for (int d = 0; d < domain_.dimension(); ++d) {
      for (const int high : {0, 1}) faces_.find_bodies_beside(d, high > 0, row.j, row.k, &beside[high]);
      for (int i = 0; i < cells; ++i)
        for (const int high : {0, 1})
          if (beside[0][i] != beside[1][i] && beside[high][i] >= 0)
            contacts_.push_back({d, i, row.j, row.k, beside[high][i], high ? 1. : -1.});
    }
  for (const RigidFootprint &at : faces_.footprints)
    contacts_.push_back({at.direction, at.cell[0], at.cell[1], at.cell[2], at.body, at.high ? at.more : -at.more});
  pressure_.resize(contacts_.size());
}

std::size_t RigidImpulse::bytes() const {
  std::size_t sum =
      contacts_.capacity() * sizeof(Contact) + (pressure_.capacity() + covered_rate_.capacity()) * sizeof(double);
  for (int a = 0; a < 3; ++a) sum += (missing_rate_[a].capacity() + means_.velocity[a].capacity()) * sizeof(double);
  return sum;
}

void RigidImpulse::begin(double time, double dt, double force_time, const Field &velocity) {
  if (faces_.travels) find_contacts();
  time_ = time;
  dt_ = dt;
  force_ = fluid_.body_force.at(force_time);
  for (int a = 0; a < domain_.dimension(); ++a) {
    missing_rate_[a].assign(faces_.cuts(a).size(), 0);
    means_.velocity[a].resize(faces_.cuts(a).size());
  }
  for_cut_faces(domain_, faces_, [&](int a, const RigidFaces::Cut &cut, int j, int k) {
    means_.velocity[a][index(a, cut)] = velocity[a](cut.i, j, k);
  });
  means_.factors.clear();
  for (const RigidMotion &motion : faces_.motions)
    means_.factors.push_back({motion.of_velocity.at(time), motion.of_rotation.at(time)});
  covered_rate_.clear();
  for_moving_faces([&](int a, int i, int j, int k, int body) {
    covered_rate_.push_back(
        dt > 0 && motion_of(body).travels() ? (velocity_before(a, body, {i, j, k}) - velocity[a](i, j, k)) / dt : 0);
  });
}

// Component a of the velocity that a travelling body had at the start of the step, at a face that it covers at the end.
double RigidImpulse::velocity_before(int a, int image, const Int3 &face) const {
  const RigidBody &body = faces_.bodies[image];
  const RigidMotion &motion = faces_.motions[body.motion];
  const Real3 then = motion.shift(time_), now = motion.shift(time_ + dt_);
  Real3 place = face_position(domain_, a, face[0], face[1], face[2]);
  for (int d = 0; d < domain_.dimension(); ++d) place[d] += (now[d] - then[d]) / domain_.spacing()[d];
  return faces_.velocity(a, body, place, domain_.spacing(), motion.of_velocity.at(time_), motion.of_rotation.at(time_));
}

// Calls visit(a, i, j, k, image) for owned faces inside bodies that move.
template <class Visit>
void RigidImpulse::for_moving_faces(const Visit &visit) const {
  if (!faces_.moves) return;
  for_rigid_rows(domain_, faces_, [&](int a, const RigidFaces::Row &row, int j, int k) {
    for_faces_inside(domain_, a, row, [&](int i, int body) {
      if (motion_of(body).moves()) visit(a, i, j, k, body);
    });
  });
}

// The term C of (28e): difference between advection of second order and (28a), which takes the slope half way to the
// face ahead.
double RigidImpulse::curved_advection(int a, const RigidFaces::Cut &cut, int j, int k, const Field &velocity) const {
  const Strides s = strides(velocity[a]);
  const double *u = velocity[a].row(j, k) + cut.i;
  double wall[6], correction = 0;
  surface_velocity(faces_, cut, a, time_, wall);
  for (int d = 0; d < domain_.dimension(); ++d) {
    const double along = carrying_velocity(velocity, a, d, cut.i, j, k), h = domain_.spacing()[d];
    const int behind = 2 * d + (along < 0), ahead = 2 * d + (along > 0);
    if (!(cut.walls >> behind & 1U) || cut.walls >> ahead & 1U) continue;
    const std::ptrdiff_t step = along > 0 ? s[d] : -s[d];
    const double theta = 1 / (cut.link[behind] * h * h), slope = (u[step] - wall[behind]) / (1 + theta);
    const double curvature = 2 * ((u[2 * step] - u[step]) - slope) / (2 + theta);
    correction += std::fabs(along) / h * 0.5 * (1 - theta) * curvature;
  }
  return correction;
}

// Sets the rate that cut faces miss because they get only their share of it, in the frame of (28b).
void RigidImpulse::add_prediction(const Field &velocity, const Field &velocity_star) {
  for_cut_faces(domain_, faces_, [&](int a, const RigidFaces::Cut &cut, int j, int k) {
    const int i = cut.i;
    double rate = (velocity_star[a](i, j, k) - velocity[a](i, j, k)) / dt_;
    double &missing = missing_rate_[a][index(a, cut)];
    if (changes_frame(faces_, cut)) rate -= rate_in_frame(domain_, faces_, cut, a, {i, j, k}, time_, dt_, velocity);
    if (fluid_.inertia && motion_of(cut.body).travels()) missing = curved_advection(a, cut, j, k, velocity);
    missing += (1 / cut.share - 1) * rate;
  });
}

void RigidImpulse::set_pressure(const Field &pressure) {
  for (std::size_t n = 0; n < contacts_.size(); ++n)
    pressure_[n] = pressure[0](contacts_[n].i, contacts_[n].j, contacts_[n].k);
}

void RigidImpulse::add_increment(const Field &increment, bool partly) {
  for (std::size_t n = 0; n < contacts_.size(); ++n)
    pressure_[n] += increment[0](contacts_[n].i, contacts_[n].j, contacts_[n].k);
  if (!partly) return;
  for_rigid_rows(domain_, faces_, [&](int a, const RigidFaces::Row &row, int j, int k) {
    const double *q = increment[0].row(j, k), factor = 1 / (fluid_.density * domain_.spacing()[a]);
    const std::ptrdiff_t step = increment[0].stride(a);
    for (const RigidFaces::Cut &cut : row.cuts)
      if (const int i = cut.i; owned(domain_, a, i))
        missing_rate_[a][index(a, cut)] -= (1 - cut.open) * factor * (q[i] - q[i - step]);
  });
}

// Adds a force `push` along a that acts at `place` (in cells), and its torque.
void RigidImpulse::add(int body, int a, const Real3 &place, double push, ExactSums *sums) const {
  const Real3 r = RigidFaces::arm(faces_.bodies[body], place, domain_.spacing());
  const int at = 6 * faces_.bodies[body].index;
  Real3 f{};
  f[a] = push;
  sums->add(at + a, push);
  for (int d = 0; d < 3; ++d) {
    const int e = (d + 1) % 3, g = (d + 2) % 3;
    if (e == a || g == a) sums->add(at + 3 + d, r[e] * f[g] - r[g] * f[e]);
  }
}

// Adds the viscous terms of a cut face and of its neighbours inside, as if all were fluid, less the friction that the
// cut face has. The velocity inside is linear, so that the neighbour's Laplacian is that of u less the velocity of the
// body at the cut face, along the link.
void RigidImpulse::add_cut(int a, const RigidFaces::Cut &cut, int j, int k, ExactSums *sums) const {
  const double volume = volume_of_face(domain_, a, side_of_face(domain_, a, cut.i, j, k));
  if (volume == 0) return;
  const double mass = fluid_.density * domain_.cell_volume() * volume, nu = fluid_.kinematic_viscosity(),
               u = means_.velocity[a][index(a, cut)];
  double wall[6], missing = missing_rate_[a][index(a, cut)];
  surface_velocity(
      faces_, cut, a, [this](int motion) { return means_.factors[motion]; }, wall);
  for (int link = 0; link < 2 * domain_.dimension(); ++link) {
    if (!(cut.walls >> link & 1U)) continue;
    const int body = cut.of_link[link];
    const Real3 place = position_at_link(domain_, a, {cut.i, j, k}, link);
    Real3 neighbour = place;
    neighbour[link / 2] += link % 2 ? 1 : -1;
    const auto body_velocity = [&](const Real3 &at) {
      const auto &[along, turning] = means_.factors[faces_.bodies[body].motion];
      return faces_.velocity(a, faces_.bodies[body], at, domain_.spacing(), along, turning);
    };
    const double h = domain_.spacing()[link / 2], rate = nu / (h * h);
    missing += rate * (body_velocity(neighbour) - u) - nu * cut.link[link] * (wall[link] - u);
    add(body, a, neighbour, mass * rate * (u - body_velocity(place)), sums);
    add(body, a, place, mass * missing, sums);
    missing = 0;  // the body of the first link gets all of it
  }
}

// Sums force and torque of every body and, for bodies that move along their own surface, the power of the body force
// less the acceleration on the faces inside; for travelling bodies the force contains it.
PetscErrorCode RigidImpulse::sum(std::vector<double> *total) const {
  PetscFunctionBeginUser;
  ExactSums sums(7 * faces_.count);
  for (std::size_t n = 0; n < contacts_.size(); ++n) {
    // Forces along d have no torque from arms along d, so the place of the low face suffices.
    const Contact &at = contacts_[n];
    add(at.body, at.d, face_position(domain_, at.d, at.i, at.j, at.k),
        at.weight * pressure_[n] * domain_.cell_volume() / domain_.spacing()[at.d], &sums);
  }
  for_cut_faces(domain_, faces_,
                [&](int a, const RigidFaces::Cut &cut, int j, int k) { add_cut(a, cut, j, k, &sums); });
  const double mass = fluid_.density * domain_.cell_volume();
  std::size_t at = 0;
  for_moving_faces([&](int a, int i, int j, int k, int image) {
    const RigidBody &body = faces_.bodies[image];
    const RigidMotion &motion = motion_of(image);
    const Real3 place = face_position(domain_, a, i, j, k), r = RigidFaces::arm(body, place, domain_.spacing());
    const double fluid = mass * volume_of_face(domain_, a, side_of_face(domain_, a, i, j, k)),
                 rate = covered_rate_[at++];
    const auto body_velocity = [&](double along, double turning) {
      return faces_.velocity(a, body, place, domain_.spacing(), along, turning);
    };
    if (motion.travels())
      add(image, a, place, fluid * (force_[a] - motion.acceleration(r, middle())[a] - rate), &sums);
    else
      sums.add(6 * faces_.count + body.index,
               fluid *
                   (force_[a] - body_velocity(motion.of_velocity.rate(middle()), motion.of_rotation.rate(middle()))) *
                   body_velocity(motion.of_velocity.at(middle()), motion.of_rotation.at(middle())));
  });
  total->assign(7 * faces_.count, 0);
  PetscCall(sums.reduce(domain_.comm(), total->data()));
  PetscFunctionReturn(0);
}

// Adds the contribution of the gap between the surface and the faces inside, where the stress balances the body force
// and the acceleration of the body; (28d), (28e).
PetscErrorCode RigidImpulse::measure(std::vector<RigidLoad> *loads) const {
  PetscFunctionBeginUser;
  EventScope scope(Event::rigid);
  std::vector<double> total;
  PetscCall(sum(&total));
  loads->assign(faces_.count, {});
  for (int index = 0; index < faces_.count; ++index) {
    const RigidMotion &motion = faces_.motion_of(index);
    const RigidMass &own = faces_.masses[index];
    const RigidGap &gap = faces_.gaps[index];
    const double rho = fluid_.density, along = motion.of_velocity.at(middle()), turn = motion.of_rotation.at(middle()),
                 *force = &total[6 * index], *torque = force + 3;
    RigidLoad &load = (*loads)[index];
    load.power = -total[6 * faces_.count + index];
    const Real3 by_force = own.force(motion, middle(), rho), by_torque = own.torque(motion, middle(), rho);
    for (int d = 0; d < 3; ++d) {
      load.power -= force[d] * motion.velocity[d] * along + torque[d] * motion.angular_velocity[d] * turn;
      const int e = (d + 1) % 3, g = (d + 2) % 3;
      const bool travels = motion.travels();
      const double volume = travels ? own.volume : gap.volume[d];
      load.force[d] = force[d] - rho * force_[d] * volume + by_force[d];
      const double arm_e = travels ? own.first[e] : gap.first[g][e], arm_g = travels ? own.first[g] : gap.first[e][g];
      load.torque[d] = torque[d] - rho * (arm_e * force_[g] - arm_g * force_[e]) + by_torque[d];
    }
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
