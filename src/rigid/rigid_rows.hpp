// Functions that the routines of rigid bodies share: rows with faces inside or cut, and friction on cut faces.
#pragma once

#include "field/field.hpp"
#include "field/rigid_faces.hpp"
#include "kernels/momentum.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace eulastic {

using Strides = std::array<std::ptrdiff_t, 3>;

inline Strides strides(ConstView q) { return {1, q.sy, q.sz}; }

// Sets `wall` to component a of the surface velocity at the end of each link that ends at a surface. factors(motion)
// returns the factors of velocity and rotation of a motion of `faces`; bodies on both sides of a face may differ in it.
template <class Factors>
void surface_velocity(const RigidFaces &faces, const RigidFaces::Cut &cut, int a, const Factors &factors,
                      double *wall) {
  int known = -1;
  std::array<double, 2> of{};
  for (int link = 0; link < 6; ++link) {
    if (!(cut.walls >> link & 1U)) continue;
    const int motion = faces.bodies[cut.of_link[link]].motion;
    if (std::exchange(known, motion) != motion) of = factors(motion);
    wall[link] = faces.motions[motion].velocity[a] * of[0] + cut.turn[link] * of[1];
  }
}

inline void surface_velocity(const RigidFaces &faces, const RigidFaces::Cut &cut, int a, double time, double *wall) {
  const auto at_time = [&](int motion) {
    return std::array{faces.motions[motion].of_velocity.at(time), faces.motions[motion].of_rotation.at(time)};
  };
  surface_velocity(faces, cut, a, at_time, wall);
}

// Component d of the velocity, averaged to a face of component a.
inline double carrying_velocity(const Field &velocity, int a, int d, int i, int j, int k) {
  const double *v = velocity[d].row(j, k) + i;
  const std::ptrdiff_t next = velocity[d].stride(d), below = velocity[d].stride(a);
  return d == a ? v[0] : 0.25 * ((v[0] + v[next]) + (v[-below] + v[next - below]));
}

// Laplacian without bodies.
inline double regular_laplacian(const Box &box, const double *u, const Strides &s) {
  const InverseSquares h = box.inverse_squares();
  return box.dimension() == 2 ? kernels::laplacian<2>(u, s[1], s[2], h) : kernels::laplacian<3>(u, s[1], s[2], h);
}

inline bool owned(const Box &box, int a, int i) { return i >= 0 && i < box.points_end(0, a == 0); }

// Calls visit(component, row, j, k) for all owned rows in or beside a body; returns the number of cut faces in them.
template <class Visit>
double for_rigid_rows(const Box &box, const RigidFaces &faces, const Visit &visit) {
  double cut_faces = 0;
  for (int a = 0; a < box.dimension(); ++a)
    for (int k = 0; k < box.points_end(2, a == 2); ++k)
      for (int j = 0; j < box.points_end(1, a == 1); ++j) {
        const RigidFaces::Row row = faces.row(a, j, k);
        if (row.empty()) continue;
        visit(a, row, j, k);
        cut_faces += double(row.cuts.size());
      }
  return cut_faces;
}

// Calls visit(component, cut, j, k) for all owned cut faces; returns their number.
template <class Visit>
double for_cut_faces(const Box &box, const RigidFaces &faces, const Visit &visit) {
  return for_rigid_rows(box, faces, [&](int a, const RigidFaces::Row &row, int j, int k) {
    for (const RigidFaces::Cut &cut : row.cuts)
      if (owned(box, a, cut.i)) visit(a, cut, j, k);
  });
}

// Calls visit(i, body) for the owned faces of component a inside bodies in a row.
template <class Visit>
void for_faces_inside(const Box &box, int a, const RigidFaces::Row &row, const Visit &visit) {
  for (const RigidFaces::Run &run : row.runs)
    for (int i = std::max(run.begin, 0); i < std::min(run.end, box.points_end(0, a == 0)); ++i) visit(i, run.body);
}

// -1 for a face on the low boundary normal to a, 1 on the high one, else 0.
inline int side_of_face(const Box &box, int a, int i, int j, int k) {
  if (!box.is_wall(a)) return 0;
  const int at = box.layout().begin[a] + std::array{i, j, k}[a];
  return at == 0 ? -1 : at == box.domain_cells()[a] ? 1 : 0;
}

// Control volume of a face in cells: half of one on an open boundary; none on other boundaries, which prescribe the
// velocity.
inline double volume_of_face(const Box &box, int a, int side) {
  return side == 0 ? 1 : box.is_open(a, side > 0) ? 0.5 : 0;
}

// Contribution of the boundaries of the box to the Laplacian of a tangential velocity beside them.
inline double laplacian_of_sides(const Box &box, int a, int i, int j, int k, ConstView u) {
  double sum = 0;
  for (int d = 0; d < box.dimension(); ++d) {
    if (d == a || !box.is_wall(d)) continue;
    const int at = box.layout().begin[d] + std::array{i, j, k}[d];
    const double *value = &u(i, j, k), square = box.spacing()[d] * box.spacing()[d];
    if (at == 0) sum += (value[-u.stride(d)] - value[0]) / square;
    if (at == box.domain_cells()[d] - 1) sum += (value[u.stride(d)] - value[0]) / square;
  }
  return sum;
}

inline double viscous_rates_flops(int dimension) { return 12 + 10 * dimension; }

// Laplacian at a cut face by (28), and without bodies.
struct Viscous {
  double cut, regular;
};
inline Viscous viscous_rates(const Box &box, const RigidFaces &faces, const RigidFaces::Cut &cut, int a, double time,
                             const double *u, const Strides &s) {
  double wall[6];
  surface_velocity(faces, cut, a, time, wall);
  return {cut.laplacian(u, s, box.dimension(), wall), regular_laplacian(box, u, s)};
}

// Position of a cut face as the body at the end of a link sees it: beside the neighbour inside, whose position is
// wrapped into the box.
inline Real3 position_at_link(const Box &box, int a, const Int3 &face, int link) {
  const int d = link / 2, N = box.domain_cells()[d];
  Real3 place = face_position(box, a, face[0], face[1], face[2]);
  const double least = (d == a ? 0 : 0.5) - 0.5 * N, neighbour = place[d] + (link % 2 ? 1 : -1);
  if (!box.is_wall(d) && neighbour < least) place[d] += N;
  if (!box.is_wall(d) && neighbour > least + N - 1) place[d] -= N;
  return place;
}

// Whether (28b) of a cut face differs from its share of the rate.
inline bool changes_frame(const RigidFaces &faces, const RigidFaces::Cut &cut) {
  for (int link = 0; link < 6; ++link)
    if (cut.walls >> link & 1U && faces.motions[faces.bodies[cut.of_link[link]].motion].changes_frame()) return true;
  return false;
}

// The rate Z = a - V_b.grad u of (28b) for the body at the end of a link: that of a flow at rest in the frame of the
// body. Upwind and half implicit: where the surface approaches, u - u_s decreases with the distance.
inline double rate_in_body_frame(const Box &box, const RigidFaces &faces, const RigidFaces::Cut &cut, int a,
                                 const Int3 &face, int of_link, double time, double dt, const Field &velocity) {
  const RigidBody &body = faces.bodies[cut.of_link[of_link]];
  const RigidMotion &motion = faces.motions[body.motion];
  const double middle = time + 0.5 * dt, *u = velocity[a].row(face[1], face[2]) + face[0];
  const Strides s = strides(velocity[a]);
  Real3 place = position_at_link(box, a, face, of_link);
  for (int d = 0; d < box.dimension(); ++d) place[d] += faces.ahead[body.motion][d];
  const Real3 r = RigidFaces::arm(body, place, box.spacing()), frame = motion.frame_velocity(r, middle);
  double wall[6], sum = 0, stiffness = 0;
  surface_velocity(faces, cut, a, time, wall);
  for (int d = 0; d < box.dimension(); ++d) {
    const double V = frame[d];
    const int link = 2 * d + (V < 0);
    const double rate = std::fabs(V) * cut.link[link] * box.spacing()[d];
    const double upwind = cut.walls >> link & 1U ? wall[link] : u[V < 0 ? s[d] : -s[d]];
    sum += rate * (upwind - u[0]);
    stiffness += rate;
  }
  return motion.surface_acceleration(r, middle)[a] + sum / (1 + 0.5 * dt * stiffness);
}

// The rate Z of a cut face. Where its links end at several bodies, their rates are weighted with 1 / (theta h^2), so
// that a surface that is very close prevails: u follows it, as its friction in (28) demands.
inline double rate_in_frame(const Box &box, const RigidFaces &faces, const RigidFaces::Cut &cut, int a,
                            const Int3 &face, double time, double dt, const Field &velocity) {
  int known = -1;
  double first = 0, rate = 0, differences = 0, weights = 0;
  for (int link = 0; link < 6; ++link) {
    if (!(cut.walls >> link & 1U)) continue;
    const int body = cut.of_link[link];
    if (body != known) rate = rate_in_body_frame(box, faces, cut, a, face, link, time, dt, velocity);
    if (known < 0) first = rate;
    known = body;
    differences += cut.link[link] * (rate - first);  // exactly 0 for a single body
    weights += cut.link[link];
  }
  return first + differences / weights;
}

}  // namespace eulastic
