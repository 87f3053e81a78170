// What verbs of rigid bodies in the momentum equation share: rows with faces inside or cut, and what cut faces see.
#pragma once

#include "field/field.hpp"
#include "field/rigid_faces.hpp"
#include "kernels/momentum.hpp"

namespace eulastic {

using Strides = std::array<std::ptrdiff_t, 3>;

inline Strides strides(ConstView q) { return {1, q.sy, q.sz}; }

// The velocity of the surface on the links of a cut face that end there.
inline void surface_velocity(const RigidFaces &faces, const RigidFaces::Cut &cut, int a, double of_velocity,
                             double of_rotation, double *wall) {
  const double along = faces.motions[faces.bodies[cut.body].motion].velocity[a] * of_velocity;
  for (int link = 0; link < 6; ++link) wall[link] = along + cut.turn[link] * of_rotation;
}

// Component d of the velocity at a face of component a.
inline double carrying_velocity(const Field &velocity, int a, int d, int i, int j, int k) {
  const double *v = velocity[d].row(j, k) + i;
  const std::ptrdiff_t next = velocity[d].stride(d), back = velocity[d].stride(a);
  return d == a ? v[0] : 0.25 * ((v[0] + v[next]) + (v[-back] + v[next - back]));
}

inline double regular_laplacian(const Box &box, const double *u, const Strides &s) {
  const InverseSquares h = box.inverse_squares();
  return box.dimension() == 2 ? kernels::laplacian<2>(u, s[1], s[2], h) : kernels::laplacian<3>(u, s[1], s[2], h);
}

// visit(component, row, j, k) for all owned rows that a body is in or beside; returns how many cut faces they have.
template <class Visit>
double for_rigid_rows(const Box &box, const RigidFaces &faces, const Visit &visit) {
  double cut_faces = 0;
  for (int a = 0; a < box.dimension(); ++a)
    for (int k = 0; k < box.points_end(2, a == 2); ++k)
      for (int j = 0; j < box.points_end(1, a == 1); ++j) {
        const RigidFaces::Row row = faces.row(a, j, k);
        if (row.empty()) continue;
        visit(a, row, j, k);
        cut_faces += double(row.cuts_end - row.cuts);
      }
  return cut_faces;
}

// -1 on the low side of the box that is normal to a, 1 on the high one, else 0.
inline int side_of_face(const Box &box, int a, int i, int j, int k) {
  if (!box.is_wall(a)) return 0;
  const int at = box.layout().begin[a] + std::array{i, j, k}[a];
  return at == 0 ? -1 : at == box.domain_cells()[a] ? 1 : 0;
}

// In cells: a face on an open side has half of one, on others the side gives the velocity.
inline double volume_of_face(const Box &box, int a, int side) {
  return side == 0 ? 1 : box.is_open(a, side > 0) ? 0.5 : 0;
}

// Laplacian of u in what sides of the box give to the tangential velocity of a face beside them.
inline double laplacian_of_sides(const Box &box, int a, int i, int j, int k, ConstView u) {
  double sum = 0;
  for (int d = 0; d < box.dimension(); ++d) {
    if (d == a || !box.is_wall(d)) continue;
    const int at = box.layout().begin[d] + std::array{i, j, k}[d];
    const double *here = &u(i, j, k), square = box.spacing()[d] * box.spacing()[d];
    if (at == 0) sum += (here[-u.stride(d)] - here[0]) / square;
    if (at == box.domain_cells()[d] - 1) sum += (here[u.stride(d)] - here[0]) / square;
  }
  return sum;
}

inline bool owned(const Box &box, int a, int i) { return i >= 0 && i < box.points_end(0, a == 0); }

inline double viscous_rates_flops(int dimension) { return 12 + 10 * dimension; }

// The viscous rate at a cut face, and how much of it a regular face has.
struct Viscous {
  double cut, regular;
};
inline Viscous viscous_rates(const Box &box, const RigidFaces &faces, const RigidFaces::Cut &cut, int a, double time,
                             const double *u, const Strides &s) {
  const RigidMotion &motion = faces.motions[faces.bodies[cut.body].motion];
  double wall[6];
  surface_velocity(faces, cut, a, motion.of_velocity.at(time), motion.of_rotation.at(time), wall);
  return {cut.laplacian(u, s, box.dimension(), wall), regular_laplacian(box, u, s)};
}

// dV/dt - V.grad u beside a body that travels, V its velocity at `place`: what a face sees of a flow that does not
// change about the body. Upwind and half implicit: where the surface comes, u - u_s falls in a step as the distance to
// it does.
inline double rate_of_what_rests(const Box &box, const RigidFaces &faces, const RigidFaces::Cut &cut, int a,
                                 Real3 place, double time, double dt, const double *u, const Strides &s) {
  const RigidBody &body = faces.bodies[cut.body];
  const RigidMotion &motion = faces.motions[body.motion];
  const double middle = time + 0.5 * dt;
  for (int d = 0; d < box.dimension(); ++d) place[d] += faces.ahead[body.motion][d];
  const Real3 r = RigidFaces::arm(body, place, box.spacing()), frame = motion.frame_velocity(r, middle);
  double wall[6], sum = 0, stiffness = 0;
  surface_velocity(faces, cut, a, motion.of_velocity.at(time), motion.of_rotation.at(time), wall);
  for (int d = 0; d < box.dimension(); ++d) {
    const double V = frame[d];
    const int link = 2 * d + (V < 0);
    const double rate = std::fabs(V) * cut.link[link] * box.spacing()[d];
    const double upwind = cut.walls >> link & 1U ? wall[link] : u[V < 0 ? s[d] : -s[d]];
    sum += rate * (upwind - u[0]);
    stiffness += rate;
  }
  return motion.acceleration(r, middle)[a] + sum / (1 + 0.5 * dt * stiffness);
}

}  // namespace eulastic
