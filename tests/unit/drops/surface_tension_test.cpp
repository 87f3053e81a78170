// Heights and curvatures of exact surfaces, the areas of planes, and the force of surface tension.
#include "drops/surface_tension.hpp"
#include "base/exact_sum.hpp"
#include "kernels/height_curvature.hpp"
#include "support/interface_scene.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

TEST(PlaneArea, IsTheDerivativeOfTheVolume) {
  const double m[][3] = {{0.2, 0.3, 0.5}, {0.01, 0.09, 0.9}, {1. / 3, 1. / 3, 1. / 3}, {0.45, 0.1, 0.45}};
  for (const auto &[a, b, c] : m)
    for (double alpha = 0.0371; alpha < 1; alpha += 0.0613) {
      constexpr double step = 1e-6;
      const double slope =
          (kernels::volume_below<3>(alpha + step, a, b, c) - kernels::volume_below<3>(alpha - step, a, b, c)) /
          (2 * step);
      EXPECT_NEAR((kernels::volume_slope<3>(alpha, a, b, c)), slope, 1e-4);
      const double sum = a + b;
      const double flat = (kernels::volume_below<2>(alpha + step, a / sum, b / sum, 0) -
                           kernels::volume_below<2>(alpha - step, a / sum, b / sum, 0)) /
                          (2 * step);
      EXPECT_NEAR((kernels::volume_slope<2>(alpha, a / sum, b / sum, 0)), flat, 1e-4);
    }
}

struct LevelScene : InterfaceScene {
  LevelScene(const Int3 &cells, const Real3 &length, const Position &level) {
    GridSpec spec;
    spec.cells = cells;
    spec.length = length;
    spec.ghosts = 5;
    EXPECT_EQ(create(PETSC_COMM_SELF, spec), 0);
    set_fraction(level);
  }
};

struct Seen {
  double worst = 0, sum = 0;  // |curvature - expected| times a length
  int found = 0, missed = 0;
  double mean() const { return sum / found; }
};

// Interior cells whose columns stay inside the box.
template <int Dim>
Seen curvatures(LevelScene &box, double expected, double length) {
  Seen seen;
  const View phi = box.fraction[0];
  const std::ptrdiff_t stride[3] = {1, phi.sy, phi.sz};
  const Real3 h = box.domain.spacing();
  box.each_owned([&](int i, int j, int k) {
    for (int d = 0; d < Dim; ++d) {
      const int place = d == 0 ? i : d == 1 ? j : k;
      if (place < 5 || place >= box.domain.cells()[d] - 5) return;
    }
    const double *q = &phi(i, j, k);
    kernels::ColumnFrame frame{};
    if (!(*q > 1e-3 && *q < 1 - 1e-3) || !kernels::column_frame<Dim>(q, stride, h.data(), &frame)) return;
    const kernels::HeightCurvature c = kernels::height_curvature<Dim>(q, frame);
    c.whole ? ++seen.found : ++seen.missed;
    if (!c.whole) return;
    const double error = std::fabs(c.value - expected) * length;
    seen.worst = std::max(seen.worst, error);
    seen.sum += error;
  });
  return seen;
}

TEST(HeightCurvature, OfPlanesIsZero) {
  const auto plane = [](double a, double b, double c) -> Position {
    return [=](const Real3 &x) {
      return (a * (x[0] - 0.5) + b * (x[1] - 0.5) + c * (x[2] - 0.5)) / std::sqrt(a * a + b * b + c * c);
    };
  };
  for (const auto &[a, b, c] : {Real3{1, 0.3, 0.2}, {0.1, -1, 0.8}, {0.5, 0.7, -0.9}, {1, 1, 1}}) {
    LevelScene box({20, 20, 20}, {1, 1, 1}, plane(a, b, c));
    const Seen seen = curvatures<3>(box, 0, 0.05);
    EXPECT_GT(seen.found, 50);
    EXPECT_LT(seen.missed, seen.found / 5);
    EXPECT_LT(seen.worst, 1e-6);
    LevelScene flat({20, 20, 1}, {1, 1, 1}, plane(a, b, 0));
    EXPECT_LT(curvatures<2>(flat, 0, 0.05).worst, 1e-6);
  }
}

TEST(HeightCurvature, OfCirclesAndSpheresIsOfSecondOrder) {
  Seen flat[3], round[2];
  for (int n = 0; n < 3; ++n) {
    const int cells = 40 << n;
    LevelScene box({cells, cells + cells / 4, 1}, {1, 1, 1}, ball({0.503, 0.497, 0}, 0.25, 2));  // hx != hy
    flat[n] = curvatures<2>(box, 4, 0.25);
    EXPECT_EQ(flat[n].missed, 0);
  }
  for (int n = 0; n < 2; ++n) {
    const int cells = 28 << n;
    LevelScene box({cells, cells, cells}, {1, 1, 1}, ball({0.503, 0.497, 0.5}, 0.25, 3));
    round[n] = curvatures<3>(box, 8, 0.25);
    EXPECT_LT(round[n].missed, (n == 0 ? 0.3 : 0.07) * round[n].found);  // only where a cell is cut at its corner
  }
  std::printf(
      "  curvature times radius: largest error, circle of 10, 20, 40 cells %.4f %.4f %.4f; mean, sphere of 7, 14 "
      "%.4f %.4f (largest %.3f %.3f)\n",
      flat[0].worst, flat[1].worst, flat[2].worst, round[0].mean(), round[1].mean(), round[0].worst, round[1].worst);
  EXPECT_LT(flat[0].worst, 0.01);
  EXPECT_GT(order(flat[0].worst, flat[2].worst) / 2, 1.8);
  EXPECT_LT(round[0].worst, 0.05);
  EXPECT_GT(order(round[0].mean(), round[1].mean()), 1.7);
}

TEST(HeightCurvature, MirroredIsTheSameToTheBit) {
  const Position level = [](const Real3 &x) {
    return std::hypot(x[0] - 0.47, 1.3 * (x[1] - 0.52), 0.8 * (x[2] - 0.5) + 0.3 * (x[0] - 0.5)) - 0.27;
  };
  constexpr int cells = 24;
  LevelScene box({cells, cells, cells}, {1, 1, 1}, level), mirrored({cells, cells, cells}, {1, 1, 1}, level);
  const View phi = box.fraction[0], image = mirrored.fraction[0];
  const std::ptrdiff_t stride[3] = {1, phi.sy, phi.sz};
  const Real3 h = box.domain.spacing();
  for (int d = 0; d < 3; ++d) {
    const auto at = [&](int i, int j, int k) {
      Int3 place{i, j, k};
      place[d] = cells - 1 - place[d];
      return place;
    };
    box.each_owned([&](int i, int j, int k) {
      const Int3 p = at(i, j, k);
      image(p[0], p[1], p[2]) = phi(i, j, k);
    });
    int compared = 0;
    box.each_owned([&](int i, int j, int k) {
      const double *q = &phi(i, j, k);
      kernels::ColumnFrame frame{}, other{};
      if (!(*q > 0 && *q < 1) || !kernels::column_frame<3>(q, stride, h.data(), &frame)) return;
      const Int3 p = at(i, j, k);
      EXPECT_TRUE(kernels::column_frame<3>(&image(p[0], p[1], p[2]), stride, h.data(), &other));
      EXPECT_EQ(kernels::height_curvature<3>(q, frame).value,
                kernels::height_curvature<3>(&image(p[0], p[1], p[2]), other).value);
      ++compared;
    });
    EXPECT_GT(compared, 300);
  }
}

// A drop in a periodic box: its energy, and a force that does no work on a rigid motion.
TEST(SurfaceTension, HasTheEnergyOfItsAreaAndNoNetForce) {
  for (const bool flat : {true, false}) {
    const int cells = 32;
    LevelScene box({cells, cells, flat ? 1 : cells}, {1, 1, 1}, ball({0.51, 0.49, 0.5}, 0.3, flat ? 2 : 3));
    Flow flow(box.domain, {});
    ASSERT_EQ(flow.work.reserve(SurfaceTension::fields), 0);
    std::vector<Phase> phases(1);
    phases[0].material.surface_tension = 3;
    phases[0].fraction = std::move(box.fraction);
    ASSERT_EQ(flow.exchange.update_ghosts(phases[0].fraction, 5), 0);
    ASSERT_EQ(phases[0].rows.find(box.domain, phases[0].fraction[0]), 0);
    const int dim = box.domain.dimension();
    Field force(box.domain, dim);
    flow.now.velocity = Field(box.domain, dim);
    flow.now.velocity.fill(1, 0.7);
    SurfaceTension tension(&flow);
    SurfaceEnergy seen;
    ASSERT_EQ(tension.add_surface_energy({phases, {}}, &seen, nullptr), 0);
    const double area = flat ? 2 * M_PI * 0.3 : 4 * M_PI * 0.09;
    EXPECT_NEAR(seen.energy / (3 * area), 1, 4e-3);
    ASSERT_EQ(tension.add_force(phases, 1, true, force), 0);
    double largest = 0;
    for (int d = 0; d < dim; ++d) {
      Superaccumulator net;
      box.each_owned([&](int i, int j, int k) {
        net.add(force[d](i, j, k));
        largest = std::max(largest, std::fabs(force[d](i, j, k)));
      });
      EXPECT_NEAR(net.value(), 0, 1e-11 * largest);
    }
    const double curvature = (flat ? 1 : 2) / 0.3;
    EXPECT_LT(largest, 1.02 * 3 * curvature * cells);  // where a full and an empty cell meet
    EXPECT_GT(largest, 0.85 * 3 * curvature * cells);
  }
}

}  // namespace
