#include "field/rigid_faces.hpp"

#include "kernels/isa.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace eulastic {
namespace {

double rotation_velocity(const Real3 &w, const Real3 &r, int a) {
  const int b = (a + 1) % 3, c = (a + 2) % 3;
  return w[b] * r[c] - w[c] * r[b];
}

Real3 cross(const Real3 &w, const Real3 &r) {
  return {rotation_velocity(w, r, 0), rotation_velocity(w, r, 1), rotation_velocity(w, r, 2)};
}

}  // namespace

// Returns the sum of (neighbour - u)/(length spacing) over the links; `wall`: the velocity of the surface on links that
// end there.
double RigidFaces::Cut::laplacian(const double *u, const std::array<std::ptrdiff_t, 3> &stride, int dimension,
                                  const double *wall) const {
  const double middle = u[0];
  double sum = 0;
  for (int d = 0; d < dimension; ++d) {
    const double low = walls >> (2 * d) & 1U ? wall[2 * d] : u[-stride[d]];
    const double high = walls >> (2 * d + 1) & 1U ? wall[2 * d + 1] : u[stride[d]];
    sum += link[2 * d] * (low - middle) + link[2 * d + 1] * (high - middle);
  }
  return sum;
}

Real3 RigidMotion::frame_velocity(const Real3 &r, double time) const {
  Real3 v{};
  for (int d = 0; d < 3; ++d) v[d] = travelling[d] ? velocity[d] * of_velocity.at(time) : 0;
  if (!turning) return v;
  const Real3 w = rotation_vector(of_rotation.at(time));
  for (int d = 0; d < 3; ++d) v[d] += rotation_velocity(w, r, d);
  return v;
}

Real3 RigidMotion::acceleration(const Real3 &r, double time) const {
  Real3 a{};
  for (int d = 0; d < 3; ++d) a[d] = travelling[d] ? velocity[d] * of_velocity.rate(time) : 0;
  if (!turning) return a;
  const Real3 w = rotation_vector(of_rotation.at(time)), euler = cross(rotation_vector(of_rotation.rate(time)), r),
              centripetal = cross(w, cross(w, r));
  for (int d = 0; d < 3; ++d) a[d] += euler[d] + centripetal[d];
  return a;
}

Real3 RigidMotion::surface_acceleration(const Real3 &r, double time) const {
  Real3 a = acceleration(r, time);
  const Real3 euler = cross(angular_velocity, r);
  for (int d = 0; d < 3; ++d) {
    if (!travelling[d]) a[d] += velocity[d] * of_velocity.rate(time);
    if (!turning) a[d] += euler[d] * of_rotation.rate(time);
  }
  return a;
}

double RigidMass::dissipation(const RigidMotion &motion, int dimension) const {
  const auto square = [](const Real3 &v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; };
  if (volume == 0) return 0;
  return 12 * square(motion.velocity) * std::pow(volume, 1 - 2. / dimension) +
         6 * square(motion.angular_velocity) * volume;
}

RigidMass RigidMass::turned(const std::array<Real3, 3> &R) const {
  const auto &[xx, yy, zz, yz, xz, xy] = second;
  const std::array<Real3, 3> S{{{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}}};
  const auto rotated = [&](int a, int b) {
    double sum = 0;
    for (int m = 0; m < 3; ++m)
      for (int n = 0; n < 3; ++n) sum += R[a][m] * S[m][n] * R[b][n];
    return sum;
  };
  RigidMass now{volume, {}, {rotated(0, 0), rotated(1, 1), rotated(2, 2), rotated(1, 2), rotated(0, 2), rotated(0, 1)}};
  for (int a = 0; a < 3; ++a)
    for (int m = 0; m < 3; ++m) now.first[a] += R[a][m] * first[m];
  return now;
}

// Integrates the acceleration over the body.
Real3 RigidMass::force(const RigidMotion &motion, double time, double density) const {
  const Real3 a = motion.acceleration({}, time), w = motion.rotation_vector(motion.of_rotation.at(time)),
              euler = cross(motion.rotation_vector(motion.of_rotation.rate(time)), first),
              centripetal = cross(w, cross(w, first));
  Real3 sum{};
  for (int d = 0; d < 3; ++d) sum[d] = density * volume * a[d] + density * (euler[d] + centripetal[d]);
  return sum;
}

// With the second moments S and J = tr S - S: first x a + J dw/dt + w x J w.
Real3 RigidMass::torque(const RigidMotion &motion, double time, double density) const {
  const auto &[xx, yy, zz, yz, xz, xy] = second;
  const auto inertia = [&, xx = xx, yy = yy, zz = zz, yz = yz, xz = xz, xy = xy](const Real3 &w) {
    return Real3{(yy + zz) * w[0] - xy * w[1] - xz * w[2], (xx + zz) * w[1] - xy * w[0] - yz * w[2],
                 (xx + yy) * w[2] - xz * w[0] - yz * w[1]};
  };
  const Real3 w = motion.rotation_vector(motion.of_rotation.at(time)),
              arms = cross(first, motion.acceleration({}, time)),
              euler = inertia(motion.rotation_vector(motion.of_rotation.rate(time))), gyration = cross(w, inertia(w));
  Real3 sum{};
  for (int d = 0; d < 3; ++d) sum[d] = density * (arms[d] + euler[d] + gyration[d]);
  return sum;
}

Real3 RigidFaces::arm(const RigidBody &body, const Real3 &place, const Real3 &spacing) {
  Real3 r{};
  for (int d = 0; d < 3; ++d) r[d] = (place[d] - body.centre[d]) * spacing[d];
  return r;
}

double RigidFaces::velocity(int a, const RigidBody &body, const Real3 &place, const Real3 &spacing, double of_velocity,
                            double of_rotation) const {
  const RigidMotion &motion = motions[body.motion];
  return motion.velocity[a] * of_velocity +
         rotation_velocity(motion.angular_velocity, arm(body, place, spacing), a) * of_rotation;
}

double RigidFaces::shortest_period() const {
  double frequency = 0;
  for (const RigidMotion &motion : motions)
    for (const Oscillation &o : {motion.of_velocity, motion.of_rotation})
      if (motion.moves()) frequency = std::max(frequency, std::fabs(o.frequency));
  return frequency > 0 ? 2 * M_PI / frequency : std::numeric_limits<double>::infinity();
}

void RigidFaces::find_bodies_beside(int d, bool high, int j, int k, std::vector<int> *found) const {
  const int shift = d == 0 && high, cells = static_cast<int>(found->size());
  const Row faces = row(d, j + (d == 1 && high), k + (d == 2 && high));
  std::fill(found->begin(), found->end(), -1);
  for (const Run &run : faces.runs)
    for (int i = std::max(run.begin - shift, 0); i < std::min(run.end - shift, cells); ++i) (*found)[i] = run.body;
}

void RigidFaces::set(const Int3 &layers, int rows, std::array<Component, 3> components) {
  layers_ = layers;
  rows_ = rows;
  components_ = std::move(components);
}

std::size_t RigidFaces::bytes() const {
  std::size_t sum = bodies.capacity() * sizeof(RigidBody);
  for (const Component &c : components_)
    sum += c.cuts.capacity() * sizeof(Cut) + c.runs.capacity() * sizeof(Run) + c.all.capacity() +
           (c.first_cut.capacity() + c.first_run.capacity()) * sizeof(std::size_t);
  return sum;
}

}  // namespace eulastic
