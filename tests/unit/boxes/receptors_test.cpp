// Receptors: their attachment to solids and membranes, and their motion.
#include "boxes/receptors.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace eulastic {
namespace {

constexpr int ghosts = 5;
constexpr Real3 centre{0.52, 0.47, 0.49}, axes{0.33, 0.26, 0.3};

DomainShape shape() {
  DomainShape domain;
  domain.cells = {20, 24, 22};
  return domain;
}

// An ellipsoid in a periodic box, and a velocity on its faces.
struct Scene {
  Box box{shape(), {0, 0, 0}, shape().cells, ghosts};
  Phase phase;
  Field velocity{box, 3};

  explicit Scene(const Material &material) {
    phase.material = material;
    phase.fraction = Field(box, 1);
    each(at_centre, [this](int i, int j, int k, const Real3 &x) {
      phase.fraction[0](i, j, k) = std::clamp(0.5 - depth(x) / box.spacing()[0], 0.0, 1.0);
    });
  }
  // Returns roughly the distance from the surface, negative inside.
  static double depth(const Real3 &x) {
    double squares = 0;
    for (int d = 0; d < 3; ++d) squares += std::pow((x[d] - centre[d]) / axes[d], 2);
    return (std::sqrt(squares) - 1) * axes[1];
  }
  template <class Visit>
  void each(const Staggering &at, const Visit &visit) {
    Extent all{};
    for (int d = 0; d < 3; ++d) all.begin[d] = -ghosts, all.end[d] = box.cells()[d] + ghosts;
    for_points(all, [&](int i, int j, int k) {
      const int n[3] = {i, j, k};
      Real3 x;
      for (int d = 0; d < 3; ++d) x[d] = (n[d] + (at[d] ? 0 : 0.5)) * box.spacing()[d];
      visit(i, j, k, x);
    });
  }
  template <class Function>
  void set_velocity(const Function &function) {
    for (int a = 0; a < 3; ++a)
      each(at_face[a], [&](int i, int j, int k, const Real3 &x) { velocity[a](i, j, k) = function(x)[a]; });
  }
  std::vector<Receptor> receptors() const {
    std::vector<Receptor> placed;
    place_receptors({7, 0, &box, &phase, nullptr}, 300, 1, &placed);
    return placed;
  }
  std::vector<Receptor> moved(double dt) const {
    std::vector<Receptor> all = receptors();
    move_receptors(box, dt, velocity, phase, &all);
    return all;
  }
};

Material solid() {
  Material material;
  material.shear_modulus = 1;
  return material;
}
Material membrane() {
  Material material;
  material.law = Law::membrane;
  return material;
}

// Weights add up to 1 and the weighted mean of the points is the receptor: force and torque are those of a force there.
TEST(Receptors, AttachmentInASolid) {
  const Scene scene(solid());
  const std::vector<Receptor> receptors = scene.receptors();
  const double h = 1. / 24;  // the shortest spacing
  ASSERT_GT(receptors.size(), 200u);
  for (const Receptor &receptor : receptors) {
    const Attachment attachment = attachment_of(scene.box, scene.phase, receptor.place);
    ASSERT_EQ(attachment.count, 2);
    double weights = 0, squares = 0, last = Scene::depth(receptor.place);
    Real3 mean{};
    for (const auto &[place, weight] : attachment) {
      weights += weight;
      squares = 0;
      for (int d = 0; d < 3; ++d) mean[d] += weight * place[d], squares += std::pow(place[d] - receptor.place[d], 2);
      EXPECT_LT(Scene::depth(place), last - 0.6 * h);
      last = Scene::depth(place);
    }
    EXPECT_NEAR(std::sqrt(squares), 2 * h, 1e-14);
    EXPECT_NEAR(weights, 1, 1e-14);
    for (int d = 0; d < 3; ++d) EXPECT_NEAR(mean[d], receptor.place[d], 1e-14);
  }
}

TEST(Receptors, AttachmentToAMembraneIsTheReceptor) {
  const Scene scene(membrane());
  for (const Receptor &receptor : scene.receptors()) {
    const Attachment attachment = attachment_of(scene.box, scene.phase, receptor.place);
    ASSERT_EQ(attachment.count, 1);
    EXPECT_EQ(attachment.points[0].place, receptor.place);
    EXPECT_EQ(attachment.points[0].weight, 1);
  }
}

// In a velocity that is linear in space both kinds of receptors move as the material does.
TEST(Receptors, LinearVelocity) {
  const auto linear = [](const Real3 &x) {
    return Real3{0.1 + 0.3 * x[1] - 0.2 * x[2], -0.2 + 0.4 * x[0] + 0.1 * x[1], 0.3 * x[0] - 0.5 * x[1] + 0.2 * x[2]};
  };
  Scene one(solid()), other(membrane());
  one.set_velocity(linear);
  other.set_velocity(linear);
  constexpr double dt = 0.01;
  const std::vector<Receptor> before = one.receptors(), solids = one.moved(dt), membranes = other.moved(dt);
  ASSERT_EQ(solids.size(), membranes.size());
  for (std::size_t n = 0; n < solids.size(); ++n) {
    Real3 half = before[n].place, after = before[n].place;
    for (int d = 0; d < 3; ++d) half[d] += 0.5 * dt * linear(before[n].place)[d];
    for (int d = 0; d < 3; ++d) after[d] += dt * linear(half)[d];
    const Real3 way = way_to_surface(one.box, one.phase, after);
    for (int d = 0; d < 3; ++d) {
      EXPECT_NEAR(solids[n].place[d], after[d] + way[d], 1e-12);
      EXPECT_NEAR(membranes[n].place[d], after[d] + way[d], 1e-12);
    }
  }
}

// A body at rest holds its receptors while the fluid beside it moves, to the little that interpolation below the
// surface sees of that.
TEST(Receptors, OfASolidDoNotFollowTheFluid) {
  const auto beside = [](const Real3 &x) { return Real3{Scene::depth(x) > 0 ? 1. : 0., 0, 0}; };
  Scene one(solid()), other(membrane());
  one.set_velocity(beside);
  other.set_velocity(beside);
  constexpr double dt = 0.01;
  const std::vector<Receptor> still = one.moved(0), solids = one.moved(dt), membranes = other.moved(dt);
  double slip = 0;
  for (std::size_t n = 0; n < still.size(); ++n) {
    for (int d = 0; d < 3; ++d) EXPECT_NEAR(solids[n].place[d], still[n].place[d], 0.15 * dt);
    slip = std::max(slip, std::fabs(membranes[n].place[0] - still[n].place[0]));
  }
  EXPECT_GT(slip, 0.4 * dt);
}

}  // namespace
}  // namespace eulastic
