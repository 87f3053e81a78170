// Voxels and surfaces to cells: volumes kept, exact fractions, every piece size, 2-D.
#include "bodies/closed_surface.hpp"
#include "bodies/resample.hpp"
#include "field/field.hpp"
#include "grid/domain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace eulastic {
namespace {

struct Cells {
  Domain domain;
  Field phi;
  Cells(const Int3 &cells, const Real3 &length) {
    GridSpec spec;
    spec.cells = cells;
    spec.length = length;
    EXPECT_EQ(domain.create(PETSC_COMM_SELF, spec), 0);
    phi = Field(domain, 1);
  }
  double at(int i, int j, int k) { return phi[0](i, j, k); }
  double volume() {
    double sum = 0;
    for (const Segment &row : domain.rows())
      for (int i = row.i_begin; i < row.i_end; ++i) sum += at(i, row.j, row.k);
    const DomainShape &s = domain.domain_shape();
    return sum * s.length[0] / s.cells[0] * s.length[1] / s.cells[1] * s.length[2] / s.cells[2];
  }
};

using Value = std::function<double(int i, int j, int k)>;

ReadVoxels from(const Value &value) {
  return [value](const Int3 &begin, const Int3 &end, double *out) {
    for (int k = begin[2]; k < end[2]; ++k)
      for (int j = begin[1]; j < end[1]; ++j)
        for (int i = begin[0]; i < end[0]; ++i) *out++ = value(i, j, k);
    return std::string();
  };
}

double some_fraction(int i, int j, int k) { return (i * 7 + j * 13 + k * 29 + i * j * k) % 11 / 10.0; }

double total(const VoxelBox &box, const Value &value) {
  double sum = 0;
  for (int k = 0; k < box.count[2]; ++k)
    for (int j = 0; j < box.count[1]; ++j)
      for (int i = 0; i < box.count[0]; ++i) sum += value(i, j, k);
  return sum * box.spacing[0] * box.spacing[1] * box.spacing[2];
}

void add_box(const Real3 &low, const Real3 &high, std::vector<Triangle> *triangles) {
  const auto corner = [&](int n) {
    return Real3{n & 1 ? high[0] : low[0], n & 2 ? high[1] : low[1], n & 4 ? high[2] : low[2]};
  };
  const int quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto &q : quads) {
    triangles->push_back({corner(q[0]), corner(q[1]), corner(q[2])});
    triangles->push_back({corner(q[0]), corner(q[2]), corner(q[3])});
  }
}

// A ball of triangles: the corners of an octahedron's faces, divided.
std::vector<Triangle> ball(const Real3 &centre, double radius, int parts) {
  std::vector<Triangle> triangles;
  const auto point = [&](int a, int b, int c) {
    const double s = radius / std::sqrt(double(a * a + b * b + c * c));
    return Real3{centre[0] + s * a, centre[1] + s * b, centre[2] + s * c};
  };
  for (int octant = 0; octant < 8; ++octant) {
    const int x = octant & 1 ? 1 : -1, y = octant & 2 ? 1 : -1, z = octant & 4 ? 1 : -1;
    const auto add = [&](Int3 p, Int3 q, Int3 r) {
      if (x * y * z < 0) std::swap(q, r);
      const auto at = [&](const Int3 &n) { return point(x * n[0], y * n[1], z * n[2]); };
      triangles.push_back({at(p), at(q), at(r)});
    };
    for (int a = 0; a < parts; ++a)
      for (int b = 0; a + b < parts; ++b) {
        const int c = parts - a - b;
        add({a, b, c}, {a + 1, b, c - 1}, {a, b + 1, c - 1});
        if (c > 1) add({a + 1, b, c - 1}, {a + 1, b + 1, c - 2}, {a, b + 1, c - 1});
      }
  }
  return triangles;
}

}  // namespace

TEST(Resample, KeepsTheVolumeOfFinerCoarserAndOddVoxels) {
  for (const Int3 &n : {Int3{37, 11, 23}, Int3{3, 5, 2}, Int3{16, 12, 8}, Int3{1, 1, 1}, Int3{160, 7, 64}}) {
    Cells cells({16, 12, 8}, {1.7, 0.9, 0.31});
    VoxelBox box;
    box.count = n;
    for (int d = 0; d < 3; ++d) box.spacing[d] = cells.domain.domain_shape().length[d] / n[d];
    EXPECT_EQ(resample(cells.domain, box, from(some_fraction), cells.phi[0]), "");
    const double wanted = total(box, some_fraction);
    EXPECT_NEAR(cells.volume(), wanted, 2e-14 + 1e-13 * wanted) << n[0];
    EXPECT_EQ(resample(cells.domain, box, from([](int, int, int) { return 1.0; }), cells.phi[0]), "");
    for (const Segment &row : cells.domain.rows())
      for (int i = 0; i < row.i_end; ++i) ASSERT_EQ(cells.at(i, row.j, row.k), 1) << i << " " << row.j << " " << row.k;
  }
}

TEST(Resample, VoxelsWithinTheBoxKeepTheirVolumeAndPlace) {
  Cells cells({20, 20, 20}, {1, 1, 1});
  const VoxelBox box{{9, 5, 3}, {0.0713, 0.11, 0.2}, {0.1234, 0.2, 0.31}};
  EXPECT_EQ(resample(cells.domain, box, from(some_fraction), cells.phi[0]), "");
  EXPECT_NEAR(cells.volume(), total(box, some_fraction), 1e-15);
  EXPECT_EQ(cells.at(1, 4, 7), 0);
  // One voxel over a corner of eight cells: what every cell has of it.
  const VoxelBox one{{1, 1, 1}, {0.05, 0.05, 0.05}, {0.04, 0.0375, 0.025}};
  EXPECT_EQ(resample(cells.domain, one, from([](int, int, int) { return 0.5; }), cells.phi[0]), "");
  EXPECT_NEAR(cells.at(0, 0, 0), 0.5 * 0.2 * 0.25 * 0.5, 1e-15);
  EXPECT_NEAR(cells.at(1, 0, 0), 0.5 * 0.8 * 0.25 * 0.5, 1e-15);
  EXPECT_NEAR(cells.at(1, 1, 1), 0.5 * 0.8 * 0.75 * 0.5, 1e-15);
}

TEST(Resample, WhatIsOutsideIsCutAndNotRead) {
  Cells cells({8, 8, 8}, {1, 1, 1});
  const VoxelBox box{{1000, 4, 4}, {0.125, 0.25, 0.25}, {-50, 0, 0}};
  int most = 0, least = 1000;
  const auto read = [&](const Int3 &begin, const Int3 &end, double *out) {
    least = std::min(least, begin[0]);
    most = std::max(most, end[0]);
    return from([](int, int, int) { return 1.0; })(begin, end, out);
  };
  EXPECT_EQ(resample(cells.domain, box, read, cells.phi[0]), "");
  EXPECT_EQ(cells.volume(), 1);
  EXPECT_EQ(least, 400);
  EXPECT_EQ(most, 408);
}

TEST(Resample, VeryLongRowsComeInPieces) {
  Cells cells({8, 4, 4}, {1, 1, 1});
  const VoxelBox box{{600000, 2, 1}, {1 / 600000.0, 0.5, 1}, {}};
  const Value every_third = [](int i, int j, int) { return j == 1 && i % 3 == 0; };
  EXPECT_EQ(resample(cells.domain, box, from(every_third), cells.phi[0]), "");
  EXPECT_NEAR(cells.at(5, 2, 2), 1 / 3.0, 1e-9);
  EXPECT_NEAR(cells.volume(), 1 / 6.0, 1e-12);
  EXPECT_EQ(resample(
                cells.domain, box, [](auto &, auto &, double *) { return "broken"; }, cells.phi[0]),
            "broken");
}

TEST(Resample, TwoDimensions) {
  Cells cells({10, 6, 1}, {1, 1, 1});
  const VoxelBox box{{4, 3, 1}, {0.25, 1 / 3.0, 1}, {}};
  EXPECT_EQ(resample(cells.domain, box, from(some_fraction), cells.phi[0]), "");
  EXPECT_NEAR(cells.volume(), total(box, some_fraction), 1e-15);
  EXPECT_EQ(cells.at(0, 3, 0), some_fraction(0, 1, 0));
}

TEST(ClosedSurface, BoxesHaveExactFractions) {
  Cells cells({10, 8, 6}, {1, 0.8, 0.6});
  std::vector<Triangle> triangles;
  add_box({0.125, 0.23, 0.1}, {0.775, 0.61, 0.5}, &triangles);
  EXPECT_EQ(why_not_closed(triangles), "");
  EXPECT_NEAR(enclosed_volume(triangles), 0.65 * 0.38 * 0.4, 1e-15);
  EXPECT_EQ(fill_surface(cells.domain, triangles, cells.phi[0]), "");
  EXPECT_NEAR(cells.volume(), 0.65 * 0.38 * 0.4, 1e-14);
  EXPECT_EQ(cells.at(3, 4, 2), 1);
  EXPECT_EQ(cells.at(3, 4, 0), 0);
  EXPECT_EQ(cells.at(0, 4, 2), 0);
  EXPECT_NEAR(cells.at(1, 4, 2), 0.75, 1e-13);
  EXPECT_NEAR(cells.at(1, 2, 2), 0.75 * 0.7, 1e-13);
  EXPECT_NEAR(cells.at(7, 6, 4), 0.75 * 0.1, 1e-13);
}

TEST(ClosedSurface, PolyhedraKeepTheirVolumeEitherWayRound) {
  for (const Int3 &n : {Int3{12, 10, 14}, Int3{3, 3, 3}, Int3{40, 31, 35}}) {
    Cells cells(n, {1, 1.1, 1.2});
    std::vector<Triangle> triangles = ball({0.51, 0.543, 0.61}, 0.4377, 6);
    EXPECT_EQ(why_not_closed(triangles), "");
    const double volume = enclosed_volume(triangles);
    EXPECT_GT(volume, 0.95 * 4 / 3 * M_PI * std::pow(0.4377, 3));
    EXPECT_EQ(fill_surface(cells.domain, triangles, cells.phi[0]), "");
    EXPECT_NEAR(cells.volume(), volume, 1e-13);
    const double middle = cells.at(n[0] / 2, n[1] / 2, n[2] / 2);
    if (n[0] > 3) {
      EXPECT_EQ(middle, 1);
    }
    for (Triangle &t : triangles) std::swap(t[1], t[2]);
    EXPECT_EQ(fill_surface(cells.domain, triangles, cells.phi[0]), "");
    EXPECT_NEAR(cells.volume(), volume, 1e-13);
  }
}

TEST(ClosedSurface, FinerBallsConvergeToTheBall) {
  Cells cells({16, 16, 16}, {1, 1, 1});
  double before = 0;
  for (int parts : {4, 8, 16}) {
    EXPECT_EQ(fill_surface(cells.domain, ball({0.5, 0.5, 0.5}, 0.4, parts), cells.phi[0]), "");
    const double error = std::abs(cells.volume() - 4 / 3.0 * M_PI * 0.064);
    if (before > 0) {
      EXPECT_NEAR(before / error, 4, 0.5);
    }
    before = error;
  }
}

TEST(ClosedSurface, HollowCutAndTwoDimensionalBodies) {
  Cells cells({10, 10, 10}, {1, 1, 1});
  std::vector<Triangle> triangles, hole;
  add_box({-3, 0.2, 0.2}, {0.85, 0.8, 0.8}, &triangles);
  add_box({0.4, 0.4, 0.4}, {0.55, 0.6, 0.6}, &hole);
  for (Triangle &t : hole) std::swap(t[0], t[1]);
  triangles.insert(triangles.end(), hole.begin(), hole.end());
  EXPECT_EQ(why_not_closed(triangles), "");
  EXPECT_EQ(fill_surface(cells.domain, triangles, cells.phi[0]), "");
  EXPECT_NEAR(cells.volume(), 0.85 * 0.36 - 0.15 * 0.04, 1e-14);
  EXPECT_EQ(cells.at(4, 4, 4), 0);
  EXPECT_NEAR(cells.at(5, 4, 4), 0.5, 1e-14);
  EXPECT_EQ(cells.at(7, 4, 4), 1);
  Cells flat({10, 10, 1}, {1, 1, 1});
  std::vector<Triangle> half;
  add_box({0.25, 0.2, -1}, {0.75, 0.8, 0.5}, &half);
  EXPECT_EQ(fill_surface(flat.domain, half, flat.phi[0]), "");
  EXPECT_NEAR(flat.at(4, 4, 0), 0.5, 1e-14);
}

TEST(ClosedSurface, OpenAndCrossingSurfacesAreRefused) {
  std::vector<Triangle> triangles;
  add_box({0.2, 0.2, 0.2}, {0.6, 0.6, 0.6}, &triangles);
  std::vector<Triangle> open = triangles, turned = triangles;
  open.pop_back();
  EXPECT_NE(why_not_closed(open).find("3 of its 33"), std::string::npos) << why_not_closed(open);
  std::swap(turned[3][0], turned[3][1]);
  EXPECT_NE(why_not_closed(turned).find("6 of its 36"), std::string::npos) << why_not_closed(turned);
  std::vector<Triangle> moved = triangles;
  moved[0][0][1] += 1e-9;
  EXPECT_NE(why_not_closed(moved).find("of its 36"), std::string::npos);
  add_box({0.4, 0.4, 0.4}, {0.8, 0.8, 0.8}, &triangles);
  EXPECT_EQ(why_not_closed(triangles), "");
  Cells cells({10, 10, 10}, {1, 1, 1});
  EXPECT_NE(fill_surface(cells.domain, triangles, cells.phi[0]).find("crosses itself"), std::string::npos);
  for (Triangle &t : triangles) t[0][2] += 1e300;
  EXPECT_NE(fill_surface(cells.domain, triangles, cells.phi[0]).find("away from the box"), std::string::npos);
}

}  // namespace eulastic
