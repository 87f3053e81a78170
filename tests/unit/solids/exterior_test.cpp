// Linear extrapolation of B at anchored bodies: docs/method.md, section 7.
#include "solids/exterior.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace eulastic;
using namespace eulastic::test;

TEST(Exterior, LinearWhereViscosityDampsShortWaves) {
  for (const bool flat : {true, false}) {
    GridSpec spec;
    spec.cells = {8, 16, flat ? 1 : 4};
    spec.length = {4, 4, flat ? .1 : .5};
    Domain domain;
    ASSERT_EQ(domain.create(PETSC_COMM_SELF, spec), 0);
    const double shortest = flat ? .25 : .125;  // z does not count in 2-D
    Fluid fluid;
    fluid.density = 4;
    fluid.viscosity = 2;  // nu = 1/2
    Material material;
    const double most = fluid.density * .25 / (shortest * shortest);
    for (const double share : {.99, 1., 1.01}) {
      material.shear_modulus = share * most;
      EXPECT_EQ(damps_short_waves(domain.spacing(), domain.dimension(), fluid, material), share <= 1) << share;
    }
  }
}

TEST(Exterior, OnlyAttachedBodiesAreExtendedLinearly) {
  GridSpec grid;
  grid.cells = {8, 8, 1};
  SolverSpec spec;
  spec.fluid.viscosity = 1;  // h = 1/8: up to G = 64
  spec.exterior = SolidExterior::extrapolate;
  Scene scene;
  ASSERT_EQ(scene.create(PETSC_COMM_SELF, grid, spec), 0);
  const auto slab = [](double, double y, double) { return y < .5 ? 1. : 0.; };
  scene.add_phase(60, slab, true);
  scene.add_phase(70, slab, true);
  scene.add_phase(60, slab, false);
  ASSERT_EQ(scene.solver.prepare(), 0);
  const auto &phases = scene.solver.state().phases;
  EXPECT_TRUE(phases[0].tensor.rule.linear);
  EXPECT_FALSE(phases[1].tensor.rule.linear);
  EXPECT_FALSE(phases[2].tensor.rule.linear);
}

TEST(Exterior, LinesTakeTheSmallerSlope) {
  GridSpec grid;
  grid.cells = {8, 16, 1};
  grid.boundary[1] = Boundary::wall;
  Scene scene;
  SolverSpec spec;
  spec.exterior = SolidExterior::extrapolate;
  ASSERT_EQ(scene.create(PETSC_COMM_SELF, grid, spec), 0);
  scene.add_phase(
      1, [](double, double y, double) { return y < .5 ? 1. : 0.; }, true);
  ASSERT_EQ(scene.solver.prepare(), 0);
  Phase &phase = scene.solver.state().phases[0];
  ASSERT_TRUE(phase.tensor.rule.linear);
  ExteriorLayers layers;
  ASSERT_EQ(layers.build(scene.domain, phase), 0);
  constexpr int last = 6;  // row 7 has surface edges: centres up to 6 evolve
  struct Line {
    double third, second, first, next, after;
  };
  for (const Line &line : {Line{1, 2, 3, 4, 5}, Line{1.5, 2, 3, 3.5, 4}, Line{1, 2.5, 3, 3.5, 4}, Line{3, 2, 3, 3, 3},
                           Line{5, 4, 3, 2, 1}, Line{2, 2, 3, 3, 3}}) {
    const View xx = phase.tensor.field[0];
    for (int i = -3; i < 11; ++i) {
      xx.row(last - 2, 0)[i] = line.third;
      xx.row(last - 1, 0)[i] = line.second;
      xx.row(last, 0)[i] = line.first;
    }
    ASSERT_EQ(layers.extend(scene.domain, scene.solver.spec().sides, &scene.solver.exchange(), phase.tensor.field), 0);
    EXPECT_EQ(xx.row(last + 1, 0)[3], line.next);
    EXPECT_EQ(xx.row(last + 2, 0)[3], line.after);
  }
}

// A stretched disc around cell (m, n) of a periodic box, ready to step.
void create_disc(int m, int n, Scene *scene) {
  GridSpec grid;
  grid.cells = {32, 32, 1};
  grid.length = {32, 32, 1};
  ASSERT_EQ(scene->create(PETSC_COMM_SELF, grid, {method_preset(MethodKind::fast), {}, {}}), 0);
  const auto along = [](double x, int centre) { return std::remainder(x - centre, 32.); };
  const auto distance = [&](double x, double y) { return std::hypot(along(x, m), along(y, n)); };
  scene->add_phase(1, [&](double x, double y, double) { return std::clamp(6.5 - distance(x, y), 0., 1.); });
  Field &tensor = scene->solver.state().phases[0].tensor.field;
  for (int c = 0; c < tensor.count(); ++c)
    set(scene->domain, tensor[c], tensor_components(2)[c].at, [&](double x, double y, double) {
      return (c < 2 ? 1.2 : 0) + .1 * std::sin(c + along(x, m) / 3 + along(y, n) / 5);
    });
  ASSERT_EQ(scene->solver.prepare(), 0);
}

TEST(Exterior, IsTheSameAcrossPeriodicSides) {
  Scene inside;
  create_disc(16, 16, &inside);
  const Phase &expected = inside.solver.state().phases[0];
  EXPECT_NE(expected.tensor.field[0](16 + 8, 16, 0), 1);  // extended
  for (int shift = 0; shift < 64; ++shift) {              // along x, along the diagonal
    const int m = shift % 32, n = shift < 32 ? 16 : m;
    Scene across;
    create_disc(m, n, &across);
    const Phase &phase = across.solver.state().phases[0];
    for (int c = 0; c < phase.tensor.field.count(); ++c)
      for (int j = 0; j < 32; ++j)
        for (int i = 0; i < 32; ++i)
          ASSERT_NEAR(phase.tensor.field[c]((i + m) % 32, (j + n) % 32, 0),
                      expected.tensor.field[c]((i + 16) % 32, (j + 16) % 32, 0), 1e-13)
              << "B " << c << " at " << i << ", " << j << " of a disc at " << m << ", " << n;
  }
}

// The layer of every point of a periodic grid by the definition: 0 where B evolves, 1 to 4, or 99.
std::vector<int> layers_of(const Domain &domain, ConstView phi, const Staggering &at) {
  const Int3 &n = domain.cells();
  const auto index = [&n](int i, int j, int k) {
    return ((i + n[0]) % n[0]) + n[0] * (((j + n[1]) % n[1]) + n[1] * ((k + n[2]) % n[2]));
  };
  std::vector<int> layer(n[0] * n[1] * n[2], 99);
  const int edge = at[0] + at[1] + at[2];
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        double sum = 0;
        for (int corner = 0; corner < 8; ++corner)
          sum += phi(i - (at[0] && corner & 1), j - (at[1] && corner & 2), k - (at[2] && corner & 4)) / 8;
        if (sum >= (edge ? evolve_above_half.edge : evolve_above_half.centre)) layer[index(i, j, k)] = 0;
      }
  for (int L = 1; L <= ExteriorLayers::layers; ++L)
    for (int k = 0; k < n[2]; ++k)
      for (int j = 0; j < n[1]; ++j)
        for (int i = 0; i < n[0]; ++i) {
          int least = 99;
          for (const int side : {-1, 1}) {
            least = std::min({least, layer[index(i + side, j, k)], layer[index(i, j + side, k)]});
            if (n[2] > 1) least = std::min(least, layer[index(i, j, k + side)]);
          }
          if (layer[index(i, j, k)] == 99 && least < L) layer[index(i, j, k)] = L;
        }
  return layer;
}

// Bodies in rows of more than 64 points: every point of a layer gets the mean of its neighbours in lower layers, and no
// other point changes.
TEST(Exterior, LayersFollowTheDefinition) {
  for (const Int3 &cells : {Int3{150, 24, 1}, Int3{90, 18, 20}}) {
    GridSpec grid;
    grid.cells = cells;
    for (int d = 0; d < 3; ++d) grid.length[d] = cells[d];
    Scene scene;
    ASSERT_EQ(scene.create(PETSC_COMM_SELF, grid, {method_preset(MethodKind::fast), {}, {}}), 0);
    const auto blobs = [&](double x, double y, double z) {
      double phi = 0;
      for (const double centre : {3., 60., 66., 88.})
        phi = std::max(phi, 4.2 - std::hypot(std::remainder(x - centre, cells[0]), y - 9, cells[2] > 1 ? z - 9 : 0));
      return std::clamp(phi, 0., 1.);
    };
    scene.add_phase(1, blobs);
    ASSERT_EQ(scene.solver.prepare(), 0);
    Phase &phase = scene.solver.state().phases[0];
    Field &B = phase.tensor.field;
    const auto components = tensor_components(scene.domain.dimension());
    for (int c = 0; c < B.count(); ++c)
      set(scene.domain, B[c], components[c].at,
          [c](double x, double y, double z) { return std::sin(1 + c + 7 * x + 3 * y + 5 * z); });
    ASSERT_EQ(scene.solver.exchange().update_ghosts(B, ExteriorLayers::layers), 0);
    Field before;
    before.copy_from(B);
    ExteriorLayers layers;
    ASSERT_EQ(layers.build(scene.domain, phase), 0);
    ASSERT_EQ(layers.extend(scene.domain, scene.solver.spec().sides, &scene.solver.exchange(), B), 0);
    for (int c = 0; c < B.count(); ++c) {
      const std::vector<int> layer = layers_of(scene.domain, phase.fraction[0], components[c].at);
      const auto wrapped = [&](int i, int j, int k) {
        return Int3{(i + cells[0]) % cells[0], (j + cells[1]) % cells[1], (k + cells[2]) % cells[2]};
      };
      const auto layer_at = [&](const Int3 &p) { return layer[p[0] + cells[0] * (p[1] + cells[1] * p[2])]; };
      int found = 0;
      for (int k = 0; k < cells[2]; ++k)
        for (int j = 0; j < cells[1]; ++j)
          for (int i = 0; i < cells[0]; ++i) {
            const int L = layer_at({i, j, k});
            if (L == 0 || L == 99) {
              ASSERT_EQ(B[c](i, j, k), before[c](i, j, k)) << c << " at " << i << " " << j << " " << k;
              continue;
            }
            double sum = 0, count = 0;
            for (const auto &[x, y, z] : {Int3{1, 0, 0}, Int3{0, 1, 0}, Int3{0, 0, cells[2] > 1}}) {
              if (x + y + z == 0) continue;
              double pair = 0;
              for (const int side : {-1, 1}) {
                const Int3 p = wrapped(i + side * x, j + side * y, k + side * z);
                if (layer_at(p) >= L) continue;
                pair += B[c](p[0], p[1], p[2]);
                ++count;
              }
              sum += pair;
            }
            ASSERT_EQ(B[c](i, j, k), sum / count) << c << " at " << i << " " << j << " " << k;
            ++found;
          }
      EXPECT_GT(found, 400);
    }
  }
}
