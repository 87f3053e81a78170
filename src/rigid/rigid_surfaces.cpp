#include "rigid/rigid_surfaces.hpp"

#include "base/events.hpp"
#include "base/exact_sum.hpp"
#include "kernels/super_time_stepping.hpp"
#include "kernels/weno5.hpp"
#include "rigid/rigid_rows.hpp"

#include <algorithm>

namespace eulastic {
void apply_rigid_surfaces(const Box &box, const RigidFaces &faces, double viscosity, double included, double time,
                          double dt, const Field &velocity, Field &rate, Field *slope) {
  EventScope scope(Event::rigid);
  const double cut_faces = for_rigid_rows(box, faces, [&](int a, const RigidFaces::Row &row, int j, int k) {
    const double *u = velocity[a].row(j, k);
    double *out = rate[a].row(j, k), *m = slope ? (*slope)[a].row(j, k) : nullptr;
    for (const RigidFaces::Cut &cut : row.cuts) {
      if (!owned(box, a, cut.i)) continue;
      const Viscous rates = viscous_rates(box, faces, cut, a, time, u + cut.i, strides(velocity[a]));
      out[cut.i] = cut.share * (out[cut.i] + (viscosity * rates.cut - included * rates.regular));
      if (changes_frame(faces, cut))
        out[cut.i] += (1 - cut.share) * rate_in_frame(box, faces, cut, a, {cut.i, j, k}, time, dt, velocity);
      if (m) m[cut.i] *= cut.share;
    }
    for_faces_inside(box, a, row, [&](int i, int) {
      out[i] = 0;
      if (m) m[i] = 0;
    });
  });
  scope.flops(cut_faces * (viscous_rates_flops(box.dimension()) + (faces.travels ? 70 : 5)));
}

// With WENO5 a cut face downstream of a body would take its difference from inside, across the kink of the velocity.
void advect_from_surfaces(const Box &box, const RigidFaces &faces, double time, double epsilon, double scale,
                          const Field &velocity, Field *advection, Field &rate) {
  EventScope scope(Event::rigid);
  const double cut_faces = for_cut_faces(box, faces, [&](int a, const RigidFaces::Cut &cut, int j, int k) {
    const Strides s = strides(velocity[a]);
    const double *u = velocity[a].row(j, k) + cut.i;
    double wall[6], correction = 0;
    surface_velocity(faces, cut, a, time, wall);
    for (int d = 0; d < box.dimension(); ++d) {
      const double along = carrying_velocity(velocity, a, d, cut.i, j, k), inverse = 1 / box.spacing()[d];
      const int behind = 2 * d + (along < 0), ahead = 2 * d + (along > 0);
      if (!(cut.walls >> behind & 1U)) continue;
      const bool between = cut.walls >> ahead & 1U;
      const double last = between ? wall[ahead] : u[along > 0 ? s[d] : -s[d]];
      const double length = (1 / cut.link[behind] + 1 / cut.link[ahead]) * inverse;
      correction += inverse * along * kernels::weno5_difference(u, s[d], along, epsilon) -
                    std::fabs(along) * (last - wall[behind]) / length;
    }
    if (advection) (*advection)[a](cut.i, j, k) += correction;
    rate[a](cut.i, j, k) += scale * correction;
  });
  scope.flops(cut_faces * (12 + box.dimension() * 8));
}

void apply_rigid_surfaces_euler(const Box &box, const RigidFaces &faces, double viscosity, double included, double time,
                                double dt, const Field &velocity, Field &velocity_star) {
  EventScope scope(Event::rigid);
  const double cut_faces = for_cut_faces(box, faces, [&](int a, const RigidFaces::Cut &cut, int j, int k) {
    const double &u = velocity[a](cut.i, j, k);
    double &out = velocity_star[a](cut.i, j, k);
    const Viscous rates = viscous_rates(box, faces, cut, a, time, &u, strides(velocity[a]));
    const double change = (out - u) + dt * (viscosity * rates.cut - included * rates.regular);
    out = u + cut.share * change;
    if (changes_frame(faces, cut))
      out += (1 - cut.share) * dt * rate_in_frame(box, faces, cut, a, {cut.i, j, k}, time, dt, velocity);
  });
  scope.flops(cut_faces * (viscous_rates_flops(box.dimension()) + 7));
}

std::vector<double> cut_face_values(const Box &box, const RigidFaces &faces, const Field &field) {
  std::vector<double> values;
  for_cut_faces(box, faces,
                [&](int a, const RigidFaces::Cut &cut, int j, int k) { values.push_back(field[a](cut.i, j, k)); });
  return values;
}

void set_cut_face_values(const Box &box, const RigidFaces &faces, const std::vector<double> &values, Field &field) {
  std::size_t at = 0;
  for_cut_faces(box, faces,
                [&](int a, const RigidFaces::Cut &cut, int j, int k) { field[a](cut.i, j, k) = values[at++]; });
}

void impose_rigid_motion(const Box &box, const RigidFaces &faces, double time, Field &velocity) {
  EventScope scope(Event::rigid);
  for_rigid_rows(box, faces, [&](int a, const RigidFaces::Row &row, int j, int k) {
    double *out = velocity[a].row(j, k);
    for (const RigidFaces::Run &run : row.runs) {
      const RigidBody &body = faces.bodies[run.body];
      const RigidMotion &motion = faces.motions[body.motion];
      const double of_velocity = motion.of_velocity.at(time), of_rotation = motion.of_rotation.at(time);
      for (int i = std::max(run.begin, 0); i < std::min(run.end, box.points_end(0, a == 0)); ++i)
        out[i] = motion.moves()
                     ? faces.velocity(a, body, face_position(box, a, i, j, k), box.spacing(), of_velocity, of_rotation)
                     : 0;
    }
  });
}

void scale_open_faces(const Box &box, const RigidFaces &faces, Field &field) {
  for_cut_faces(box, faces,
                [&](int a, const RigidFaces::Cut &cut, int j, int k) { field[a](cut.i, j, k) *= cut.open; });
  clear_rigid_faces(box, faces, field);
}

void clear_rigid_faces(const Box &box, const RigidFaces &faces, Field &field) {
  for_rigid_rows(box, faces, [&](int a, const RigidFaces::Row &row, int j, int k) {
    for_faces_inside(box, a, row, [out = field[a].row(j, k)](int i, int) { out[i] = 0; });
  });
}

void correct_cut_faces(const Box &box, const RigidFaces &faces, double dt_over_density, const Field &increment,
                       Field &velocity) {
  EventScope scope(Event::rigid);
  const double cut_faces = for_rigid_rows(box, faces, [&](int a, const RigidFaces::Row &row, int j, int k) {
    const double *q = increment[0].row(j, k), factor = dt_over_density / box.spacing()[a];
    double *u = velocity[a].row(j, k);
    const std::ptrdiff_t step = increment[0].stride(a);
    for (const RigidFaces::Cut &cut : row.cuts)
      if (const int i = cut.i; owned(box, a, i)) u[i] += (1 - cut.open) * factor * (q[i] - q[i - step]);
  });
  scope.flops(cut_faces * 5);
}

RigidStage::RigidStage(const RigidFaces &faces, double viscosity, double time, double reached, double weight,
                       RigidMeans *means)
    : faces_(faces), viscosity_(viscosity), weight_(weight), means_(means) {
  for (const RigidMotion &motion : faces.motions)
    moved_.push_back({motion.of_velocity.at(reached) - motion.of_velocity.at(time),
                      motion.of_rotation.at(reached) - motion.of_rotation.at(time)});
  for (std::size_t m = 0; means && m < moved_.size(); ++m)
    for (int of = 0; of < 2; ++of) means->factors[m][of] += weight * moved_[m][of];
}

void RigidStage::hold(const RigidFaces::Row &row, int dimension, int a, int begin, int end, const kernels::RklStage &c,
                      const double *now, const std::array<std::ptrdiff_t, 3> &stride, const double *rate,
                      const double *slope, const double *before, std::vector<double> *held) const {
  held->clear();
  for (const RigidFaces::Cut &cut : row.cuts) {
    const int i = cut.i;
    if (i < begin || i >= end) continue;
    double wall[6] = {};
    if (faces_.moves)
      surface_velocity(
          faces_, cut, a, [this](int motion) { return moved_[motion]; }, wall);
    double sum = c.nu * before[i];
    sum += c.mu * now[i];
    sum += c.rate * rate[i];
    if (slope) sum += c.slope * slope[i];
    sum += c.viscous * viscosity_ * cut.share * cut.laplacian(now + i, stride, dimension, wall);
    held->push_back(sum);
    if (means_) means_->velocity[a][&cut - faces_.cuts(a).data()] += weight_ * now[i];
  }
}

void RigidStage::release(const RigidFaces::Row &row, int begin, int end, const std::vector<double> &held, double *out) {
  std::size_t at = 0;
  for (const RigidFaces::Cut &cut : row.cuts)
    if (cut.i >= begin && cut.i < end) out[cut.i] = held[at++];
}

// Viscous dissipation beside rigid bodies.

namespace {

// The sum over links that end at a surface of (u - V) ((u_inside - u) / h^2 - (u_surface - u) / (theta h^2)), with V
// the velocity of the link's body at the face: what the stress of the whole grid has too much, per viscosity and
// volume.
double excess_at_cut(const Domain &domain, const RigidFaces &faces, const RigidFaces::Cut &cut, int a, const Int3 &face,
                     double time, const Field &velocity) {
  const Real3 &h = domain.spacing();
  const Strides s = strides(velocity[a]);
  const double *u = velocity[a].row(face[1], face[2]) + face[0];
  double wall[6], sum = 0;
  surface_velocity(faces, cut, a, time, wall);
  for (int link = 0; link < 2 * domain.dimension(); ++link) {
    if (!(cut.walls >> link & 1U)) continue;
    const RigidBody &body = faces.bodies[cut.of_link[link]];
    const RigidMotion &motion = faces.motions[body.motion];
    const double V = faces.velocity(a, body, position_at_link(domain, a, face, link), h, motion.of_velocity.at(time),
                                    motion.of_rotation.at(time));
    const int d = link / 2;
    const double inside = u[link % 2 ? s[d] : -s[d]];
    sum += (*u - V) * ((inside - *u) / (h[d] * h[d]) - cut.link[link] * (wall[link] - *u));
  }
  return sum;
}

// Half of the sum of ((u - u_beside) / h)^2 over neighbours of a face inside a body that are inside another one: there
// is no fluid between the two that the difference would shear. The other half belongs to the neighbours.
double shear_between_bodies(const Domain &domain, const RigidFaces &faces, int a, int body, const Int3 &face,
                            const Field &velocity) {
  const Strides s = strides(velocity[a]);
  const double *u = &velocity[a](face[0], face[1], face[2]);
  double sum = 0;
  for (int link = 0; link < 2 * domain.dimension(); ++link) {
    const int d = link / 2, step = link % 2 ? 1 : -1;
    const double difference = (u[step * s[d]] - *u) / domain.spacing()[d];
    if (difference == 0) continue;
    Int3 beside = face;
    beside[d] += step;
    const RigidFaces::Row row = faces.row(a, beside[1], beside[2]);
    for (const RigidFaces::Run &other : row.runs)
      if (other.begin <= beside[0] && beside[0] < other.end &&
          faces.bodies[other.body].index != faces.bodies[body].index)
        sum += 0.5 * difference * difference;
  }
  return sum;
}

}  // namespace

PetscErrorCode measure_rigid_dissipation(const Domain &domain, const RigidFaces &faces, const Fluid &fluid, double time,
                                         const Field &velocity, double *dissipation) {
  PetscFunctionBeginUser;
  EventScope scope(Event::rigid);
  ExactSums sums(1);
  const bool several = faces.moves && faces.count > 1;
  const double cut_faces = for_rigid_rows(domain, faces, [&](int a, const RigidFaces::Row &row, int j, int k) {
    for (const RigidFaces::Cut &cut : row.cuts) {
      const int i = cut.i;
      if (!owned(domain, a, i)) continue;
      const double volume = volume_of_face(domain, a, side_of_face(domain, a, i, j, k));
      if (volume == 0) continue;
      sums.add(0, volume * excess_at_cut(domain, faces, cut, a, {i, j, k}, time, velocity));
    }
    // Subtract the friction of faces inside on boundaries of the box, where a body has no surface.
    for_faces_inside(domain, a, row, [&](int i, int body) {
      const double of_body = velocity[a](i, j, k);
      const double volume = volume_of_face(domain, a, side_of_face(domain, a, i, j, k));
      if (of_body != 0) sums.add(0, volume * of_body * laplacian_of_sides(domain, a, i, j, k, velocity[a]));
      if (several) sums.add(0, -volume * shear_between_bodies(domain, faces, a, body, {i, j, k}, velocity));
    });
  });
  scope.flops(cut_faces * 40);
  PetscCall(sums.reduce(domain.comm(), dissipation));
  *dissipation *= fluid.viscosity * domain.cell_volume();
  PetscFunctionReturn(0);
}

}  // namespace eulastic
