// The faces of the velocity that rigid bodies contain or cut.
#include "rigid/rigid_surfaces.hpp"
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
    phase.empty(scene->domain, false);
    set(scene->domain, phase.fraction[0], at_centre, phi);
  } else {
    EXPECT_EQ(fill_phase(scene->domain, spec, {{spec.centre, {}}}, 1, &phase), 0);
  }
  RigidBodies bodies(scene->domain, scene->solver.exchange());
  std::string wrong;
  EXPECT_EQ(bodies.add(spec, {{spec.centre, {}}}, 1, &phase, &wrong), 0);
  EXPECT_EQ(bodies.find_faces(0, 0), 0);
  return std::make_unique<RigidFaces>(bodies.faces());
}

// For a ball across two periodic boundaries, every link that ends at the surface ends on it, runs contain exactly the
// faces inside, and no cut face is stiffer than a regular one.
TEST(RigidFaces, LinksEndAtTheSurface) {
  Scene scene;
  GridSpec spec;
  spec.cells = {14, 12, 10};
  spec.length = {1.4, 1.08, 1};
  const Real3 centre{0.03, 1.02, 0.47};
  const double radius = 0.31;
  const auto faces = faces_of(&scene, spec, rigid_body(Shape::sphere, radius, centre));
  const Domain &domain = scene.domain;
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
  for (int d = 0; d < 3; ++d) regular += 2 / (domain.spacing()[d] * domain.spacing()[d]);
  int links = 0;
  for (int a = 0; a < 3; ++a)
    for (int k = -2; k < domain.cells()[2] + 2; ++k)
      for (int j = -2; j < domain.cells()[1] + 2; ++j) {
        const RigidFaces::Row row = faces->row(a, j, k);
        std::vector<char> inside(domain.cells()[0]);
        for (const RigidFaces::Run &run : row.runs)
          for (int i = std::max(run.begin, 0); i < std::min(run.end, domain.cells()[0]); ++i) inside[i] = 1;
        const auto place = [&](int i) {
          return Real3{position(domain, 0, a == 0, i), position(domain, 1, a == 1, j), position(domain, 2, a == 2, k)};
        };
        for (int i = 0; i < domain.cells()[0]; ++i) EXPECT_EQ(inside[i] != 0, distance(place(i)) < 0);
        for (const RigidFaces::Cut &cut : row.cuts) {
          EXPECT_GT(distance(place(cut.i)), 0);
          double diagonal = 0;
          for (int link = 0; link < 6; ++link) {
            const int d = link / 2;
            const double h = domain.spacing()[d];
            diagonal += cut.link[link];
            if (!(cut.walls >> link & 1U)) {
              EXPECT_EQ(cut.link[link], 1 / (h * h));
              continue;
            }
            Real3 end = place(cut.i);
            end[d] += (link % 2 ? 1 : -1) / (cut.link[link] * h);
            EXPECT_NEAR(distance(end), 0, 1.01e-3 * h);  // no link is shorter than that
            ++links;
          }
          EXPECT_NE(cut.walls, 0u);
          EXPECT_LE(cut.share * diagonal, regular * (1 + 1e-14));
        }
      }
  EXPECT_GT(links, 300);
}

// The surface of a body from a file is where interpolated phi is 1/2, which is exact for a plane along the grid.
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
  ASSERT_FALSE(row.cuts.empty());
  bool found = false;
  for (const RigidFaces::Cut &cut : row.cuts)
    if (cut.i == 2) {
      EXPECT_EQ(cut.walls, 2u);
      EXPECT_NEAR(0.25 + 1 / (cut.link[1] * 0.125), 0.3625, 0.02);
      found = true;
    }
  EXPECT_TRUE(found);
}

// A body that moves with the fluid around it, across all boundaries of the box, has no load and disturbs nothing.
TEST(TravellingBodies, FluidThatGoesAlongFeelsNothing) {
  Scene scene;
  GridSpec spec;
  spec.cells = {18, 16, 14};
  spec.length = {1.8, 1.6, 1.4};
  SolverSpec solver;
  static_cast<Method &>(solver) = method_preset(MethodKind::fast);
  solver.fluid.viscosity = 0.1;
  ASSERT_EQ(scene.create(PETSC_COMM_SELF, spec, solver), 0);
  const Real3 V{1, -0.7, 0.4};
  for (int d = 0; d < 3; ++d)
    set(scene.domain, scene.solver.state().velocity[d], at_face[d], [&](double, double, double) { return V[d]; });
  SpeciesSpec ball = rigid_body(Shape::sphere, 0.42, {0.1, 0.2, 1.3});
  ball.motion.velocity = V;
  add_rigid(&scene, {ball});
  ASSERT_EQ(scene.solver.prepare(), 0);
  ASSERT_EQ(scene.run(0.4, 12), 0);
  for (int d = 0; d < 3; ++d)
    EXPECT_LT(rms_error(scene.domain, scene.solver.state().velocity[d], at_face[d],
                        [&](double, double, double) { return V[d]; }),
              1e-13);
  std::vector<RigidLoad> loads;
  ASSERT_EQ(scene.solver.rigid_loads(&loads), 0);
  for (int d = 0; d < 3; ++d) {
    EXPECT_NEAR(loads[0].force[d], 0, 1e-12);
    EXPECT_NEAR(loads[0].torque[d], 0, 1e-12);
  }
}

// The position of a body depends on the time alone, not on earlier calls; the same holds for phi.
TEST(TravellingBodies, PlaceIsAFunctionOfTime) {
  Scene scene;
  GridSpec spec;
  spec.cells = {16, 14, 1};
  spec.length = {1.6, 1.4, 1};
  SolverSpec solver;
  static_cast<Method &>(solver) = method_preset(MethodKind::fast);
  ASSERT_EQ(scene.create(PETSC_COMM_SELF, spec, solver), 0);
  SpeciesSpec ball = rigid_body(Shape::sphere, 0.31, {0.3, 0.7, 0.5});
  ball.name = "ball";
  ball.law = Law::rigid;
  ball.motion.velocity = {0.8, -0.3, 0};
  ball.motion.of_velocity = {2, 0.5};
  const double time = 0.37, way = (std::sin(2 * time + 0.5) - std::sin(0.5)) / 2;
  std::vector<Phase> phases(2);
  std::array<std::unique_ptr<RigidBodies>, 2> bodies;
  for (int n = 0; n < 2; ++n) {
    ASSERT_EQ(fill_phase(scene.domain, ball, {{ball.centre, {}}}, 1, &phases[n]), 0);
    bodies[n] = std::make_unique<RigidBodies>(scene.domain, scene.solver.exchange());
    std::string wrong;
    ASSERT_EQ(bodies[n]->add(ball, {{ball.centre, {}}}, 1, &phases[n], &wrong), 0);
  }
  for (const double before : {0., 0.1, 1.3, time}) ASSERT_EQ(bodies[0]->find_faces(before, before - 0.1), 0);
  ASSERT_EQ(bodies[1]->find_faces(time, time - 0.1), 0);
  EXPECT_NEAR(bodies[0]->faces().bodies[13].centre[0], (0.3 + 0.8 * way - 0.8) / 0.1, 1e-9);
  int cuts = 0, runs = 0;
  for (int a = 0; a < 2; ++a)
    for (int j = -2; j < 16; ++j) {
      const RigidFaces::Row one = bodies[0]->faces().row(a, j, 0), two = bodies[1]->faces().row(a, j, 0);
      ASSERT_EQ(one.cuts.size(), two.cuts.size());
      ASSERT_EQ(one.runs.size(), two.runs.size());
      for (std::size_t c = 0; c < one.cuts.size(); ++c, ++cuts)
        for (int link = 0; link < 4; ++link) EXPECT_EQ(one.cuts[c].link[link], two.cuts[c].link[link]);
      for (std::size_t r = 0; r < one.runs.size(); ++r, ++runs) {
        EXPECT_EQ(one.runs[r].begin, two.runs[r].begin);
        EXPECT_EQ(one.runs[r].end, two.runs[r].end);
      }
    }
  EXPECT_GT(cuts, 20);
  EXPECT_GT(runs, 8);
  std::vector<Phase> moved(1);
  moved[0].copy_from(phases[0]);
  ASSERT_EQ(bodies[0]->fill(time, &moved), 0);
  double sum = 0, moment = 0;
  for_points(scene.domain, moved[0].fraction[0], at_centre, [&](double &phi, double x, double, double) {
    sum += phi;
    moment += phi * x;
  });
  EXPECT_NEAR(sum * 0.01, M_PI * 0.31 * 0.31, 1e-5);
  EXPECT_NEAR(moment / sum, 0.3 + 0.8 * way, 1e-4);
}

// Two bodies, one of which approaches the other.
TEST(TravellingBodies, TouchingIsFound) {
  Scene scene;
  GridSpec spec;
  spec.cells = {20, 12, 1};
  spec.length = {2, 1.2, 1};
  SolverSpec solver;
  static_cast<Method &>(solver) = method_preset(MethodKind::fast);
  ASSERT_EQ(scene.create(PETSC_COMM_SELF, spec, solver), 0);
  SpeciesSpec ball = rigid_body(Shape::ellipsoid, 0, {0.5, 0.6, 0.5}),
              post = rigid_body(Shape::sphere, 0.2, {1.4, 0.6, 0.5});
  ball.semi_axes = {0.3, 0.2, 0.2};
  ball.motion.velocity = {1, 0, 0};
  ball.name = "ball";
  post.name = "post";
  RigidBodies bodies(scene.domain, scene.solver.exchange());
  for (SpeciesSpec *species : {&post, &ball}) {
    species->law = Law::rigid;
    Phase phase;
    ASSERT_EQ(fill_phase(scene.domain, *species, {{species->centre, {}}}, 1, &phase), 0);
    std::string wrong;
    ASSERT_EQ(bodies.add(*species, {{species->centre, {}}}, 1, &phase, &wrong), 0);
  }
  ASSERT_EQ(bodies.find_faces(0.1, 0.1), 0);  // .3 apart
  EXPECT_EQ(bodies.contact_message(), "");
  for (const double time : {0.39, 0.5}) {
    ASSERT_EQ(bodies.find_faces(time, time - 0.02), 0);
    for (const char *piece : {"-ball_velocity", "post and ball", "accepted: paths with fluid between"})
      EXPECT_NE(bodies.contact_message().find(piece), std::string::npos) << bodies.contact_message();
  }
  ASSERT_EQ(bodies.find_faces(0.1, 0.1), 0);
  EXPECT_EQ(bodies.contact_message(), "");
}

}  // namespace
