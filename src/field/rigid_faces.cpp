#include "field/rigid_faces.hpp"

#include "kernels/isa.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace eulastic {
namespace {

double turn_velocity(const Real3 &w, const Real3 &r, int a) {
  const int b = (a + 1) % 3, c = (a + 2) % 3;
  return w[b] * r[c] - w[c] * r[b];
}

}  // namespace

// sum of (neighbour - u)/(length spacing); `wall`: the velocity of the surface on links that end there.
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

double RigidFaces::velocity(int a, const RigidBody &body, const Real3 &place, const Real3 &spacing, double of_velocity,
                            double of_rotation) const {
  const RigidMotion &motion = motions[body.motion];
  Real3 r{};
  for (int d = 0; d < 3; ++d) r[d] = (place[d] - body.centre[d]) * spacing[d];
  return motion.velocity[a] * of_velocity + turn_velocity(motion.angular_velocity, r, a) * of_rotation;
}

double RigidFaces::shortest_period() const {
  double frequency = 0;
  for (const RigidMotion &motion : motions)
    for (const Oscillation &o : {motion.of_velocity, motion.of_rotation})
      if (motion.moves()) frequency = std::max(frequency, std::fabs(o.frequency));
  return frequency > 0 ? 2 * M_PI / frequency : std::numeric_limits<double>::infinity();
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
