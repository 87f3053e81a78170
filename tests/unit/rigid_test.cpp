// Where rigid bodies cut the faces of the velocity.
#include "support/rigid_scene.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

std::unique_ptr<RigidFaces> faces_of(Scene *scene, const GridSpec &grid, SpeciesSpec spec, const Function &phi = {}) {
  SolverSpec solver;
  static_cast<Method &>(solver) = method_preset(MethodKind::fast);
  EXPECT_EQ(scene->create(PETSC_COMM_SELF, grid, solver), 0);
  spec.law = Law::rigid;
  Phase phase;
  if (phi) {
    phase.empty(scene->grid, false);
    set(scene->grid, phase.fraction[0], at_centre, phi);
  } else {
    EXPECT_EQ(fill_phase(scene->grid, spec, {{spec.centre, {}}}, 1, &phase), 0);
  }
  RigidBodies bodies(scene->grid, scene->solver.exchange());
  EXPECT_EQ(bodies.add(spec, {{spec.centre, {}}}, 1, &phase), 0);
  EXPECT_EQ(bodies.place(0), 0);
  return std::make_unique<RigidFaces>(bodies.faces());
}

// Every link that ends at the surface of a ball across two periodic sides ends on it; every face inside is in a run, no
// other; and no cut face is stiffer than a regular one.
TEST(RigidFaces, LinksEndAtTheSurface) {
  Scene scene;
  GridSpec spec;
  spec.cells = {14, 12, 10};
  spec.length = {1.4, 1.08, 1};
  const Real3 centre{0.03, 1.02, 0.47};
  const double radius = 0.31;
  const auto faces = faces_of(&scene, spec, rigid_body(Shape::sphere, radius, centre));
  const Grid &grid = scene.grid;
  const auto distance = [&](Real3 x) {
    double square = 0;
    for (int d = 0; d < 3; ++d) {
      x[d] -= centre[d];
      x[d] -= spec.length[d] * std::round(x[d] / spec.length[d]);
      square += x[d] * x[d];
    }
    return std::sqrt(square) - radius;
  };
  double regular = 0;
  for (int d = 0; d < 3; ++d) regular += 2 / (grid.spacing()[d] * grid.spacing()[d]);
  int links = 0;
  for (int a = 0; a < 3; ++a)
    for (int k = -2; k < grid.owned()[2] + 2; ++k)
      for (int j = -2; j < grid.owned()[1] + 2; ++j) {
        const RigidFaces::Row row = faces->row(a, j, k);
        std::vector<char> inside(grid.owned()[0]);
        for (const auto *run = row.runs; run != row.runs_end; ++run)
          for (int i = std::max(run->begin, 0); i < std::min(run->end, grid.owned()[0]); ++i) inside[i] = 1;
        const auto place = [&](int i) {
          return Real3{position(grid, 0, a == 0, i), position(grid, 1, a == 1, j), position(grid, 2, a == 2, k)};
        };
        for (int i = 0; i < grid.owned()[0]; ++i) EXPECT_EQ(inside[i] != 0, distance(place(i)) < 0);
        for (const auto *cut = row.cuts; cut != row.cuts_end; ++cut) {
          EXPECT_GT(distance(place(cut->i)), 0);
          double diagonal = 0;
          for (int link = 0; link < 6; ++link) {
            const int d = link / 2;
            const double h = grid.spacing()[d];
            diagonal += cut->link[link];
            if (!(cut->walls >> link & 1U)) {
              EXPECT_EQ(cut->link[link], 1 / (h * h));
              continue;
            }
            Real3 end = place(cut->i);
            end[d] += (link % 2 ? 1 : -1) / (cut->link[link] * h);
            EXPECT_NEAR(distance(end), 0, 1.01e-3 * h);  // no link is shorter than that
            ++links;
          }
          EXPECT_NE(cut->walls, 0u);
          EXPECT_LE(cut->share * diagonal, regular * (1 + 1e-14));
        }
      }
  EXPECT_GT(links, 300);
}

// Of a body from a file the surface is where phi, interpolated, is 1/2: exact of a plane along the grid.
TEST(RigidFaces, SurfaceOfAFile) {
  Scene scene;
  GridSpec spec;
  spec.cells = {8, 6, 1};
  SpeciesSpec file;
  file.shape = Shape::voxels;
  const auto faces = faces_of(&scene, spec, file, [](double x, double, double) {
    return std::min(1.0, std::max(0.0, (x - 0.3) * 8));  // 1/2 at x = .3625: a slope of phi one cell wide
  });
  const RigidFaces::Row row = faces->row(0, 2, 0);
  ASSERT_NE(row.cuts, row.cuts_end);
  bool found = false;
  for (const auto *cut = row.cuts; cut != row.cuts_end; ++cut)
    if (cut->i == 2) {
      EXPECT_EQ(cut->walls, 2u);
      EXPECT_NEAR(0.25 + 1 / (cut->link[1] * 0.125), 0.3625, 0.02);
      found = true;
    }
  EXPECT_TRUE(found);
}

}  // namespace
