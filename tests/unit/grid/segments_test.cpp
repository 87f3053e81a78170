// Active segments contain all required points, not too many others, and are aligned; a step does not depend on
// skipping.
#include "support/all_segments.hpp"
#include "support/polynomials.hpp"
#include "support/verbs.hpp"

#include <gtest/gtest.h>

#include <cstring>

using namespace eulastic;
using namespace eulastic::test;

namespace {

bool active(const Domain &domain, ConstView value, int low, int high, int i, int j, int k) {
  const bool flat = domain.dimension() == 2;
  for (int dk = flat ? 0 : -low; dk <= (flat ? 0 : high); ++dk)
    for (int dj = -low; dj <= high; ++dj)
      for (int di = -low; di <= high; ++di)
        if (value(i + di, j + dj, k + dk) >= 0.5) return true;
  return false;
}

// Fills a field with values above the threshold with the given probability, including ghosts.
void check(const GridSpec &spec, int low, int high, double share, Random &random) {
  SCOPED_TRACE(::testing::Message() << spec.cells[0] << " cells, reach " << low << " " << high << ", share " << share);
  Domain domain;
  ASSERT_EQ(domain.create(PETSC_COMM_SELF, spec), 0);
  Field value(domain, 1);
  fill_everywhere(domain, value[0], at_centre, [&](const Point &) { return std::fabs(random()) < share ? 0.5 : 0.49; });
  ActiveSegments segments;
  segments.build(domain, value[0], {}, 0.5, low, high);
  EXPECT_EQ(segments.rows_y(), domain.points_end(1, true));
  EXPECT_EQ(segments.rows_z(), domain.points_end(2, true));
  double points = 0;
  std::size_t count = 0;
  for (int k = 0; k < segments.rows_z(); ++k)
    for (int j = 0; j < segments.rows_y(); ++j) {
      const ConstView q = value[0];
      std::vector<char> covered(domain.points_end(0, true));
      int last_end = -8;
      for (const Segment &s : segments.row(j, k)) {
        EXPECT_EQ(&s, &segments.all()[count++]);
        EXPECT_EQ(s.j, j);
        EXPECT_EQ(s.k, k);
        EXPECT_EQ(s.i_begin % 8, 0);
        EXPECT_GE(s.i_begin - last_end, 8);
        ASSERT_GT(s.i_end, s.i_begin);
        ASSERT_LE(s.i_end, domain.points_end(0, true));
        EXPECT_TRUE(s.i_end % 8 == 0 || s.i_end == domain.points_end(0, true))
            << "whole vectors where the row has them";
        int idle = 0;  // inactive points in a row, fewer than in two vectors
        for (int i = s.i_begin; i < s.i_end; ++i) {
          covered[i] = 1;
          idle = active(domain, q, low, high, i, j, k) ? 0 : idle + 1;
          EXPECT_LT(idle, 15);
        }
        bool first = false;
        for (int i = s.i_begin; i < std::min(s.i_begin + 8, s.i_end); ++i)
          first = first || active(domain, q, low, high, i, j, k);
        EXPECT_TRUE(first) << "begins within a vector of an active point";
        points += s.size();
        last_end = s.i_end;
      }
      for (int i = 0; i < domain.points_end(0, true); ++i) {
        if (!covered[i]) {
          EXPECT_FALSE(active(domain, q, low, high, i, j, k)) << i << " " << j << " " << k;
        }
      }
    }
  EXPECT_EQ(segments.points(), points);
  EXPECT_EQ(segments.all().size(), count);
}

TEST(ActiveSegments, CoverWhatIsActiveAndLittleMore) {
  Random random(1);
  for (const Int3 &cells : {Int3{61, 4, 5}, Int3{40, 7, 1}, Int3{3, 3, 3}, Int3{8, 5, 1}})
    for (int walls = 0; walls < (cells[2] == 1 ? 4 : 8); ++walls) {
      GridSpec spec;
      spec.cells = cells;
      for (int d = 0; d < 3; ++d)
        if (walls >> d & 1) spec.boundary[d] = Boundary::wall;
      for (const auto &[low, high] : {std::array<int, 2>{1, 0}, std::array<int, 2>{1, 1}, std::array<int, 2>{0, 0}})
        for (const double share : {0.0, 0.003, 0.02, 0.3, 1.0}) check(spec, low, high, share, random);
    }
}

bool covers(const ActiveSegments &segments, int i, int j, int k) {
  for (const Segment &s : segments.row(j, k))
    if (s.i_begin <= i && i < s.i_end) return true;
  return false;
}

// The band: cells that are together with their neighbours neither all empty nor all full. Its faces: those of the cells
// and of the next ones.
TEST(ActiveSegments, BandAndItsFaces) {
  Random random(2);
  for (const Int3 &cells : {Int3{61, 4, 5}, Int3{40, 7, 1}})
    for (const int margin : {0, 2})
      for (const double share : {0.0, 0.002, 0.03, 1.0})
        for (const double rest : {0.0, 1.0, 0.4}) {
          Domain domain;
          GridSpec spec;
          spec.cells = cells;
          spec.boundary[1] = Boundary::wall;
          ASSERT_EQ(domain.create(PETSC_COMM_SELF, spec), 0);
          const bool flat = domain.dimension() == 2;
          Field value(domain, 1);
          fill_everywhere(domain, value[0], at_centre,
                          [&](const Point &) { return std::fabs(random()) < share ? 0.5 : rest; });
          ActiveSegments band, faces;
          band.build_band(domain, value[0], {}, margin);
          faces.build_faces(domain, band);
          int idle = 0, points = 0;
          const int mz = flat ? 0 : margin;
          for (int k = -mz; k < cells[2] + mz; ++k)
            for (int j = -margin; j < cells[1] + margin; ++j)
              for (int i = -margin; i < cells[0] + margin; ++i) {
                bool empty = true, full = true;
                for (int dk = flat ? 0 : -1; dk <= (flat ? 0 : 1); ++dk)
                  for (int dj = -1; dj <= 1; ++dj)
                    for (int di = -1; di <= 1; ++di) {
                      empty = empty && value[0](i + di, j + dj, k + dk) == 0;
                      full = full && value[0](i + di, j + dj, k + dk) == 1;
                    }
                const bool in_band = covers(band, i, j, k), active = !empty && !full;
                EXPECT_TRUE(in_band || !active) << i << " " << j << " " << k;
                idle += in_band && !active;
                points += in_band;
                if (!in_band) continue;
                EXPECT_TRUE(covers(faces, i, j, k));
                if (i + 1 < cells[0] + margin) {
                  EXPECT_TRUE(covers(faces, i + 1, j, k));
                }
                if (j + 1 < cells[1] + margin) {
                  EXPECT_TRUE(covers(faces, i, j + 1, k));
                }
                if (k + 1 < cells[2] + mz) {
                  EXPECT_TRUE(covers(faces, i, j, k + 1));
                }
              }
          EXPECT_EQ(band.points(), points);
          if (share == 0 && rest != 0.4) {
            EXPECT_EQ(points, 0);
          }
          if (share == 1) {
            EXPECT_EQ(idle, 0);
          }
        }
}

TEST(ActiveSegments, AllIsEveryPoint) {
  Domain domain;
  GridSpec spec;
  spec.cells = {9, 4, 5};
  spec.boundary[0] = spec.boundary[2] = Boundary::wall;
  ASSERT_EQ(domain.create(PETSC_COMM_SELF, spec), 0);
  ActiveSegments segments;
  build_all(domain, &segments);
  EXPECT_EQ(segments.points(), 10 * 4 * 6);
  EXPECT_EQ(segments.row(3, 5).begin()->size(), 10);
}

bool same_bits(const Domain &domain, ConstView a, ConstView b, const Staggering &at) {
  for (int k = 0; k < domain.points_end(2, at[2]); ++k)
    for (int j = 0; j < domain.points_end(1, at[1]); ++j)
      if (std::memcmp(a.row(j, k), b.row(j, k), sizeof(double) * domain.points_end(0, at[0])) != 0) return false;
  return true;
}

// A free body in shear, and one that a wall cuts: predictor and tensor with and without skipping.
void compare_steps(bool flat, double y) {
  SCOPED_TRACE(::testing::Message() << "flat " << flat << ", y " << y);
  Scene scene;
  GridSpec grid;
  grid.cells = {34, 19, flat ? 1 : 17};
  grid.length = {34, 19, 17};
  grid.boundary[1] = Boundary::wall;
  SolverSpec spec;
  spec.sides[1][0].motion.velocity[0] = -1.9;
  spec.sides[1][1].motion.velocity[0] = 1.9;
  spec.fluid.body_force.force = {0.001, 0, 0.0005};
  ASSERT_EQ(scene.create(PETSC_COMM_SELF, grid, spec), 0);
  scene.add_phase(0.5, [=](double x, double yy, double z) {
    const double r = std::sqrt(std::pow(x - 12.3, 2) + std::pow(yy - y, 2) + (flat ? 0 : std::pow(z - 8.9, 2)));
    return std::min(1.0, std::max(0.0, 0.5 + 4.2 - r));
  });
  set(scene.domain, scene.solver.state().velocity[0], at_face[0],
      [](double, double yy, double) { return 0.2 * (yy - 9.5); });
  ASSERT_EQ(scene.solver.prepare(), 0);
  ASSERT_EQ(scene.run(2, 20), 0);
  State &state = scene.solver.state();
  Phase &phase = state.phases[0];
  const auto &components = tensor_components(scene.domain.dimension());
  Field star[2], next[2];
  double points[2];
  for (int all = 0; all < 2; ++all) {
    if (all) {
      build_all(scene.domain, &phase.tensor.evolving);
      build_all(scene.domain, &phase.tensor.stressed);
    }
    points[all] = phase.tensor.evolving.points();
    star[all] = Field(scene.domain, scene.domain.dimension());
    next[all] = Field(scene.domain, phase.tensor.field.count());
    ASSERT_EQ(predict(scene.domain, spec.fluid, 2, 0.1, state.velocity, state.pressure, state.phases, star[all]), 0);
    ASSERT_EQ(transport(scene.domain, 0.1, state.velocity, phase, next[all]), 0);
  }
  EXPECT_LT(points[0], 0.6 * points[1]);
  EXPECT_GT(rms_error(scene.domain, next[0][0], at_centre, [](double, double, double) { return 1.0; }), 1e-2);
  for (int a = 0; a < scene.domain.dimension(); ++a)
    EXPECT_TRUE(same_bits(scene.domain, star[0][a], star[1][a], at_face[a])) << "uvw"[a];
  for (int c = 0; c < next[0].count(); ++c)
    EXPECT_TRUE(same_bits(scene.domain, next[0][c], next[1][c], components[c].at)) << "component " << c;
}

TEST(Skipping, SameBitsAsEverywhere) {
  for (const bool flat : {true, false})
    for (const double y : {8.2, 1.5, 17.9}) compare_steps(flat, y);
}

}  // namespace
