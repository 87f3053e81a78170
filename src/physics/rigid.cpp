#include "physics/rigid.hpp"

#include "base/events.hpp"
#include "field/exact_sum.hpp"
#include "kernels/momentum.hpp"

#include <algorithm>

namespace eulastic {
namespace {

using Strides = std::array<std::ptrdiff_t, 3>;

Strides strides(ConstView q) { return {1, q.sy, q.sz}; }

// The velocity of the surface on the links of a cut face that end there.
void surface_velocity(const RigidFaces &faces, const RigidFaces::Cut &cut, int a, double of_velocity,
                      double of_rotation, double *wall) {
  const double along = faces.motions[faces.bodies[cut.body].motion].velocity[a] * of_velocity;
  for (int link = 0; link < 6; ++link) wall[link] = along + cut.turn[link] * of_rotation;
}

double regular_laplacian(const Grid &grid, const double *u, const Strides &s) {
  const InverseSquares h = grid.inverse_squares();
  return grid.dimension() == 2 ? kernels::laplacian<2>(u, s[1], s[2], h) : kernels::laplacian<3>(u, s[1], s[2], h);
}

// visit(component, row, j, k) for all owned rows that a body is in or beside.
template <class Visit>
void for_rigid_rows(const Grid &grid, const RigidFaces &faces, const Visit &visit) {
  for (int a = 0; a < grid.dimension(); ++a)
    for (int k = 0; k < grid.faces_end(a, 2); ++k)
      for (int j = 0; j < grid.faces_end(a, 1); ++j)
        if (const RigidFaces::Row row = faces.row(a, j, k); !row.empty()) visit(a, row, j, k);
}

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

bool owned(const Grid &grid, int a, int i) { return i >= 0 && i < grid.faces_end(a, 0); }

// The viscous rate at a cut face, and how much of it a regular face has.
struct Viscous {
  double cut, regular;
};
Viscous viscous_rates(const Grid &grid, const RigidFaces &faces, const RigidFaces::Cut &cut, int a, double time,
                      const double *u, const Strides &s) {
  const RigidMotion &motion = faces.motions[faces.bodies[cut.body].motion];
  double wall[6];
  surface_velocity(faces, cut, a, motion.of_velocity.at(time), motion.of_rotation.at(time), wall);
  return {cut.laplacian(u, s, grid.dimension(), wall), regular_laplacian(grid, u, s)};
}

// dV/dt - V.grad u beside a body that travels, V its velocity at `place`: what a face sees of a flow that does not
// change about the body. Upwind and half implicit: where the surface comes, u - u_s falls in a step as the distance to
// it does.
double rate_of_what_rests(const Grid &grid, const RigidFaces &faces, const RigidFaces::Cut &cut, int a, Real3 place,
                          double time, double dt, const double *u, const Strides &s) {
  const RigidBody &body = faces.bodies[cut.body];
  const RigidMotion &motion = faces.motions[body.motion];
  const double middle = time + 0.5 * dt;
  for (int d = 0; d < grid.dimension(); ++d) place[d] += faces.ahead[body.motion][d];
  const Real3 r = RigidFaces::arm(body, place, grid.spacing()), frame = motion.frame_velocity(r, middle);
  double wall[6], sum = 0, stiffness = 0;
  surface_velocity(faces, cut, a, motion.of_velocity.at(time), motion.of_rotation.at(time), wall);
  for (int d = 0; d < grid.dimension(); ++d) {
    const double V = frame[d];
    const int link = 2 * d + (V < 0);
    const double rate = std::fabs(V) * cut.link[link] * grid.spacing()[d];
    const double upwind = cut.walls >> link & 1U ? wall[link] : u[V < 0 ? s[d] : -s[d]];
    sum += rate * (upwind - u[0]);
    stiffness += rate;
  }
  return motion.acceleration(r, middle)[a] + sum / (1 + 0.5 * dt * stiffness);
}

}  // namespace

void see_rigid_surfaces(const Grid &grid, const RigidFaces &faces, double viscosity, double included, double time,
                        double dt, const FieldBlock &velocity, FieldBlock &rate, FieldBlock *slope) {
  VerbScope scope(Verb::rigid);
  for_rigid_rows(grid, faces, [&](int a, const RigidFaces::Row &row, int j, int k) {
    const double *u = velocity[a].row(j, k);
    double *out = rate[a].row(j, k), *m = slope ? (*slope)[a].row(j, k) : nullptr;
    for (const RigidFaces::Cut *cut = row.cuts; cut != row.cuts_end; ++cut) {
      if (!owned(grid, a, cut->i)) continue;
      const Viscous rates = viscous_rates(grid, faces, *cut, a, time, u + cut->i, strides(velocity[a]));
      out[cut->i] = cut->share * (out[cut->i] + (viscosity * rates.cut - included * rates.regular));
      if (faces.motions[faces.bodies[cut->body].motion].travels())
        out[cut->i] += (1 - cut->share) * rate_of_what_rests(grid, faces, *cut, a, place_of_face(grid, a, cut->i, j, k),
                                                             time, dt, u + cut->i, strides(velocity[a]));
      if (m) m[cut->i] *= cut->share;
    }
    for (const RigidFaces::Run *run = row.runs; run != row.runs_end; ++run)
      for (int i = std::max(run->begin, 0); i < std::min(run->end, grid.faces_end(a, 0)); ++i) {
        out[i] = 0;
        if (m) m[i] = 0;
      }
  });
}

void see_rigid_surfaces_at_once(const Grid &grid, const RigidFaces &faces, double viscosity, double included,
                                double time, double dt, const FieldBlock &velocity, FieldBlock &velocity_star) {
  VerbScope scope(Verb::rigid);
  for_rigid_rows(grid, faces, [&](int a, const RigidFaces::Row &row, int j, int k) {
    const double *u = velocity[a].row(j, k);
    double *out = velocity_star[a].row(j, k);
    for (const RigidFaces::Cut *cut = row.cuts; cut != row.cuts_end; ++cut) {
      if (!owned(grid, a, cut->i)) continue;
      const Viscous rates = viscous_rates(grid, faces, *cut, a, time, u + cut->i, strides(velocity[a]));
      const double change = (out[cut->i] - u[cut->i]) + dt * (viscosity * rates.cut - included * rates.regular);
      out[cut->i] = u[cut->i] + cut->share * change;
    }
  });
}

std::vector<double> cut_face_values(const Grid &grid, const RigidFaces &faces, const FieldBlock &field) {
  std::vector<double> values;
  for_rigid_rows(grid, faces, [&](int a, const RigidFaces::Row &row, int j, int k) {
    for (const RigidFaces::Cut *cut = row.cuts; cut != row.cuts_end; ++cut)
      if (owned(grid, a, cut->i)) values.push_back(field[a].row(j, k)[cut->i]);
  });
  return values;
}

void set_cut_face_values(const Grid &grid, const RigidFaces &faces, const std::vector<double> &values,
                         FieldBlock &field) {
  std::size_t at = 0;
  for_rigid_rows(grid, faces, [&](int a, const RigidFaces::Row &row, int j, int k) {
    for (const RigidFaces::Cut *cut = row.cuts; cut != row.cuts_end; ++cut)
      if (owned(grid, a, cut->i)) field[a].row(j, k)[cut->i] = values[at++];
  });
}

void impose_rigid_motion(const Grid &grid, const RigidFaces &faces, double time, FieldBlock &velocity) {
  VerbScope scope(Verb::rigid);
  for_rigid_rows(grid, faces, [&](int a, const RigidFaces::Row &row, int j, int k) {
    double *out = velocity[a].row(j, k);
    for (const RigidFaces::Run *run = row.runs; run != row.runs_end; ++run) {
      const RigidBody &body = faces.bodies[run->body];
      const RigidMotion &motion = faces.motions[body.motion];
      const double of_velocity = motion.of_velocity.at(time), of_rotation = motion.of_rotation.at(time);
      for (int i = std::max(run->begin, 0); i < std::min(run->end, grid.faces_end(a, 0)); ++i)
        out[i] = motion.moves() ? faces.velocity(a, body, place_of_face(grid, a, i, j, k), grid.spacing(), of_velocity,
                                                 of_rotation)
                                : 0;
    }
  });
}

void open_faces(const Grid &grid, const RigidFaces &faces, FieldBlock &field) {
  for_rigid_rows(grid, faces, [&](int a, const RigidFaces::Row &row, int j, int k) {
    for (const RigidFaces::Cut *cut = row.cuts; cut != row.cuts_end; ++cut)
      if (owned(grid, a, cut->i)) field[a].row(j, k)[cut->i] *= cut->open;
  });
  clear_rigid_faces(grid, faces, field);
}

void clear_rigid_faces(const Grid &grid, const RigidFaces &faces, FieldBlock &field) {
  for_rigid_rows(grid, faces, [&](int a, const RigidFaces::Row &row, int j, int k) {
    double *out = field[a].row(j, k);
    for (const RigidFaces::Run *run = row.runs; run != row.runs_end; ++run)
      for (int i = std::max(run->begin, 0); i < std::min(run->end, grid.faces_end(a, 0)); ++i) out[i] = 0;
  });
}

void correct_cut_faces(const Grid &grid, const RigidFaces &faces, double dt_over_density, const FieldBlock &increment,
                       FieldBlock &velocity) {
  VerbScope scope(Verb::rigid);
  for_rigid_rows(grid, faces, [&](int a, const RigidFaces::Row &row, int j, int k) {
    const double *q = increment[0].row(j, k), factor = dt_over_density / grid.spacing()[a];
    double *u = velocity[a].row(j, k);
    const std::ptrdiff_t step = increment[0].stride(a);
    for (const RigidFaces::Cut *cut = row.cuts; cut != row.cuts_end; ++cut)
      if (const int i = cut->i; owned(grid, a, i)) u[i] += (1 - cut->open) * factor * (q[i] - q[i - step]);
  });
}

RigidStage::RigidStage(const RigidFaces &faces, double viscosity, double time, double reached)
    : faces_(faces), viscosity_(viscosity) {
  for (const RigidMotion &motion : faces.motions)
    moved_.push_back({motion.of_velocity.at(reached) - motion.of_velocity.at(time),
                      motion.of_rotation.at(reached) - motion.of_rotation.at(time)});
}

void RigidStage::hold(const RigidFaces::Row &row, int dimension, int a, int begin, int end, const kernels::RklStage &c,
                      const double *now, const std::array<std::ptrdiff_t, 3> &stride, const double *rate,
                      const double *slope, const double *before, std::vector<double> *held) const {
  held->clear();
  for (const RigidFaces::Cut *cut = row.cuts; cut != row.cuts_end; ++cut) {
    const int i = cut->i;
    if (i < begin || i >= end) continue;
    double wall[6] = {};
    if (faces_.moves) {
      const std::array<double, 2> &moved = moved_[faces_.bodies[cut->body].motion];
      surface_velocity(faces_, *cut, a, moved[0], moved[1], wall);
    }
    double sum = c.nu * before[i];
    sum += c.mu * now[i];
    sum += c.rate * rate[i];
    if (slope) sum += c.slope * slope[i];
    sum += c.viscous * viscosity_ * cut->share * cut->laplacian(now + i, stride, dimension, wall);
    held->push_back(sum);
  }
}

void RigidStage::release(const RigidFaces::Row &row, int begin, int end, const std::vector<double> &held, double *out) {
  std::size_t at = 0;
  for (const RigidFaces::Cut *cut = row.cuts; cut != row.cuts_end; ++cut)
    if (cut->i >= begin && cut->i < end) out[cut->i] = held[at++];
}

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
  for_rigid_rows(grid, faces, [&](int a, const RigidFaces::Row &row, int j, int k) {
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
