// Shapes, volume fractions and placement against analytic values.
#include "bodies/fill_phase.hpp"
#include "bodies/shapes.hpp"
#include "bodies/volume_fraction.hpp"
#include "field/boundaries.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>

namespace eulastic {
namespace {

constexpr double pi = 3.14159265358979323846;

GridSpec box(const Int3 &cells, const Real3 &length, Boundary y = Boundary::periodic) {
  GridSpec spec;
  spec.cells = cells;
  spec.length = length;
  spec.boundary[1] = y;
  return spec;
}

SpeciesSpec species(Shape shape, double radius, const Real3 &centre) {
  SpeciesSpec spec;
  spec.name = "body";
  spec.shape = shape;
  spec.radius = radius;
  spec.semi_axes = {1.3 * radius, radius, 0.7 * radius};
  spec.centre = centre;
  spec.centre_given = true;
  return spec;
}

struct Scene {
  Domain domain;
  Phase phase;
  Scene(const GridSpec &box_spec, const SpeciesSpec &spec) {
    Places places;
    EXPECT_EQ(place_bodies(spec, box_spec, &places), "");
    EXPECT_EQ(domain.create(PETSC_COMM_SELF, box_spec), 0);
    EXPECT_EQ(fill_phase(domain, spec, places, 1, &phase), 0);
  }
  double phi(int i, int j, int k) const { return phase.fraction[0](i, j, k); }
  double volume() const {
    double sum = 0;
    for (const Segment &row : domain.rows())
      for (int i = row.i_begin; i < row.i_end; ++i) sum += phi(i, row.j, row.k);
    return sum * domain.cell_volume();
  }
};

std::string refusal_reason(const SpeciesSpec &spec, const GridSpec &grid) {
  Places places;
  return place_bodies(spec, grid, &places);
}

TEST(Shapes, RedCellHasThePublishedSizes) {
  SpeciesSpec cell = species(Shape::biconcave, 4, {});
  EXPECT_NEAR(shape_volume(cell, 3), 100.74, 0.005);
  const Surface surface(cell, 3);
  const auto half_thickness = [&](double r) {
    double low = 0, high = 4;
    for (int n = 0; n < 60; ++n) {
      const double middle = (low + high) / 2;
      (surface.level({r, middle, 0}) < 0 ? low : high) = middle;
    }
    return low;
  };
  double thickest = 0, volume = 0, area = 0;
  constexpr int samples = 20000;
  for (int n = 0; n < samples; ++n) {
    const double r = 4 * (n + 0.5) / samples, t = 2 * half_thickness(r);
    thickest = std::max(thickest, t);
    volume += 2 * pi * r * t * 4 / samples;
    area += 2 * t * 4 / samples;
  }
  EXPECT_NEAR(2 * half_thickness(0), 0.829, 0.0005);
  EXPECT_NEAR(thickest, 2.625, 0.0005);
  EXPECT_NEAR(shape_volume(cell, 3), volume, 1e-5 * volume);
  EXPECT_NEAR(shape_volume(cell, 2), area, 1e-5 * area);
  EXPECT_NEAR(surface.support({0, 1, 0}), thickest / 2, 2e-5);
  EXPECT_NEAR(surface.support({1, 0, 0}), 4, 2e-5);
}

TEST(Shapes, SlopeBoundsTheLevel) {
  for (Shape shape : {Shape::sphere, Shape::ellipsoid, Shape::biconcave, Shape::cylinder}) {
    const Surface surface(species(shape, 1, {}), 3);
    unsigned seed = 1;
    const auto random = [&] { return (seed = seed * 1664525u + 1013904223u) / 4294967296.0 * 2 - 1; };
    for (int n = 0; n < 20000; ++n) {
      const Real3 y{1.5 * random(), 1.5 * random(), 1.5 * random()}, e{random(), random(), random()};
      const double reach = 0.3, length = std::sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]), s = reach / length;
      const double change = surface.level({y[0] + s * e[0], y[1] + s * e[1], y[2] + s * e[2]}) - surface.level(y);
      ASSERT_LE(std::abs(change), surface.slope(y, reach) * reach * (1 + 1e-12)) << static_cast<int>(shape);
    }
  }
}

TEST(Shapes, RotationsAreAboutXThenYThenZ) {
  const Rotation q = rotation({90, 0, 90});  // e_y -> e_z -> e_z, e_z -> -e_y -> e_x
  EXPECT_EQ(q[2][1], 1.0);
  EXPECT_EQ(q[0][2], 1.0);
  EXPECT_EQ(q[1][0], 1.0);
  const Rotation r = rotation({31, -47, 112}), back = rotation({-31, 0, 0});
  EXPECT_NEAR(r[2][0], std::sin(47 * pi / 180), 1e-15);
  EXPECT_EQ(back[2][1], -rotation({31, 0, 0})[2][1]);
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) EXPECT_NEAR(r[a][0] * r[b][0] + r[a][1] * r[b][1] + r[a][2] * r[b][2], a == b, 1e-15);
}

TEST(VolumeFraction, HalfSpacesAreCutExactly) {
  EXPECT_DOUBLE_EQ(half_space_fraction(0, {1, -2, 3}), 0.5);
  EXPECT_DOUBLE_EQ(half_space_fraction(0.25, {0, 0, -1}), 0.25);
  EXPECT_DOUBLE_EQ(half_space_fraction(-0.75, {1, 1, 0}), 1 - 0.25 * 0.25 / 2);
  EXPECT_NEAR(half_space_fraction(1.25, {1, 1, 1}), 0.25 * 0.25 * 0.25 / 6, 1e-15);
  EXPECT_EQ(half_space_fraction(-2, {1, 1, 1}), 1.0);
  EXPECT_EQ(half_space_fraction(2, {1, 1, 1}), 0.0);
  // Every branch against the integral over z of 2-D cuts, itself checked above.
  for (const Real3 &m : {Real3{1, 2, 8}, Real3{3, 4, 5}, Real3{0.1, 3, 3.05}})
    for (double level = -6; level < 6; level += 0.37) {
      double sum = 0;
      constexpr int n = 2000;
      for (int s = 0; s < n; ++s) sum += half_space_fraction(level + m[2] * ((s + 0.5) / n - 0.5), {m[0], m[1], 0}) / n;
      EXPECT_NEAR(half_space_fraction(level, m), sum, 1e-6) << level;
    }
}

TEST(VolumeFraction, BodiesHaveTheirVolumes) {
  // Relative errors at n cells per radius; they fall at order 2 at least, with scatter.
  struct Case {
    Shape shape;
    int dimension, n;
    double tolerance;
  };
  const Case cases[] = {{Shape::sphere, 3, 4, 5e-6},    {Shape::sphere, 3, 8, 3e-7},    {Shape::sphere, 3, 16, 2e-8},
                        {Shape::ellipsoid, 3, 8, 3e-7}, {Shape::biconcave, 3, 8, 5e-5}, {Shape::biconcave, 3, 24, 1e-6},
                        {Shape::sphere, 2, 8, 2e-6},    {Shape::sphere, 2, 32, 2e-7},   {Shape::ellipsoid, 2, 8, 2e-6},
                        {Shape::biconcave, 2, 8, 1e-4}, {Shape::biconcave, 2, 24, 3e-6}};
  for (const Case &c : cases)
    for (int shift = 0; shift < 3; ++shift) {
      SpeciesSpec spec = species(c.shape, 1, {1.5 + 0.0371 * shift, 1.47, 0.02 * shift});  // across the z seam
      spec.orientation = {0, 0, 35};
      if (c.dimension == 3) spec.orientation = {20, 15, 35};
      const Scene scene(box({3 * c.n, 3 * c.n, c.dimension == 3 ? 3 * c.n : 1}, {3, 3, 3}), spec);
      EXPECT_NEAR(scene.volume() / shape_volume(spec, c.dimension), 1, c.tolerance)
          << static_cast<int>(c.shape) << ' ' << c.dimension << "-D " << c.n;
    }
}

TEST(VolumeFraction, IsZeroOutsideAndOneInside) {
  const Scene scene(box({24, 24, 24}, {3, 3, 3}), species(Shape::sphere, 1, {1.5, 1.5, 1.5}));
  int full = 0, cut = 0;
  for (int k = 0; k < 24; ++k)
    for (int j = 0; j < 24; ++j)
      for (int i = 0; i < 24; ++i) {
        // Farthest and nearest point of the cell.
        double far = 0, near = 0;
        for (int c : {i, j, k}) {
          const double x = std::abs((c + 0.5) / 8 - 1.5);
          far += (x + 0.0625) * (x + 0.0625);
          near += (x - 0.0625) * (x - 0.0625);
        }
        if (far < 1) {
          EXPECT_EQ(scene.phi(i, j, k), 1.0);
          ++full;
        } else if (near > 1) {
          EXPECT_EQ(scene.phi(i, j, k), 0.0);
        } else {
          ++cut;
        }
        EXPECT_EQ(scene.phase.label[0](i, j, k), scene.phi(i, j, k) > 0 ? 1.0 : 0.0);
      }
  EXPECT_GT(full, 1000);
  EXPECT_GT(cut, 500);
}

TEST(VolumeFraction, SlabsAndCylindersAreExact) {
  for (int axis = 0; axis < 3; ++axis) {
    SpeciesSpec slab = species(Shape::slab, 0, {});
    slab.axis = axis;
    slab.interval = {0.3, 0.7};  // on faces
    const Scene aligned(box({10, 10, 10}, {1, 1, 1}), slab);
    slab.interval = {0.0, 0.4321};
    const Scene between(box({10, 10, 10}, {1, 1, 1}, Boundary::wall), slab);
    for (int c = 0; c < 10; ++c) {
      Int3 cell{4, 5, 6};
      cell[axis] = c;
      EXPECT_EQ(aligned.phi(cell[0], cell[1], cell[2]), c >= 3 && c < 7 ? 1.0 : 0.0);
      EXPECT_NEAR(between.phi(cell[0], cell[1], cell[2]), c < 4 ? 1 : c == 4 ? 0.321 : 0, 1e-9);
    }
    SpeciesSpec cylinder = species(Shape::cylinder, 0.3, {0.51, 0.48, 0.5});
    cylinder.axis = axis;
    EXPECT_NEAR(Scene(box({16, 20, 24}, {1, 1, 1}), cylinder).volume(), shape_volume(cylinder, 3), 3e-5);
    const Scene flat(box({16, 20, 1}, {1, 1, 1}), cylinder);
    EXPECT_NEAR(flat.volume(), axis == 2 ? pi * 0.09 : 0.6, axis == 2 ? 3e-5 : 1e-9);
  }
}

TEST(VolumeFraction, MirroredAndShiftedScenesGiveTheSameBits) {
  const Int3 n{22, 18, 20};
  const Real3 length{21.12, 17.3, 18.9};
  for (Shape shape : {Shape::sphere, Shape::ellipsoid, Shape::biconcave}) {
    SpeciesSpec spec = species(shape, 4, {7.31, 9.87, 6.543});
    spec.orientation = {23, -41, 67};
    const GridSpec periodic = box(n, length);
    const Scene original(periodic, spec);
    for (int d = 0; d < 3; ++d) {
      SpeciesSpec image = spec;
      image.centre[d] = length[d] - spec.centre[d];
      for (int e = 0; e < 3; ++e)
        if (e != d) image.orientation[e] = -spec.orientation[e];
      SpeciesSpec moved = spec;
      moved.centre[d] = std::fmod(spec.centre[d] + 11 * length[d] / n[d], length[d]);
      const Scene mirrored(periodic, image), shifted(periodic, moved);
      for (int k = 0; k < n[2]; ++k)
        for (int j = 0; j < n[1]; ++j)
          for (int i = 0; i < n[0]; ++i) {
            Int3 m{i, j, k}, s{i, j, k};
            m[d] = n[d] - 1 - m[d];
            s[d] = (s[d] + 11) % n[d];
            ASSERT_EQ(original.phi(i, j, k), mirrored.phi(m[0], m[1], m[2])) << static_cast<int>(shape) << ' ' << d;
            ASSERT_EQ(original.phi(i, j, k), shifted.phi(s[0], s[1], s[2])) << static_cast<int>(shape) << ' ' << d;
          }
    }
  }
}

TEST(Placement, RefusesWhatDoesNotFit) {
  const GridSpec open = box({16, 16, 16}, {4, 4, 4}), walls = box({16, 16, 16}, {4, 4, 4}, Boundary::wall);
  EXPECT_EQ(refusal_reason(species(Shape::sphere, 1, {2, 0.5, 2}), open), "");
  EXPECT_NE(refusal_reason(species(Shape::sphere, 1, {2, 0.5, 2}), walls).find("reaches into the wall: y"),
            std::string::npos);
  EXPECT_EQ(refusal_reason(species(Shape::sphere, 1, {2, 1, 2}), walls), "");
  EXPECT_EQ(refusal_reason(species(Shape::sphere, 2, {2, 2, 2}), walls), "");
  EXPECT_NE(refusal_reason(species(Shape::sphere, 2.1, {2, 2, 2}), open).find("long in x"), std::string::npos);
  EXPECT_EQ(refusal_reason(species(Shape::sphere, 1, {2, 2, 4.5}), open),
            "-body_centre: z = 4.5 is outside the box; accepted: within 0 ... 4");
  // A flat cell fits where its bounding sphere does not, until it is turned.
  SpeciesSpec cell = species(Shape::biconcave, 1.5, {2, 0.6, 2});
  EXPECT_EQ(refusal_reason(cell, walls), "");
  cell.orientation = {90, 0, 0};
  EXPECT_NE(refusal_reason(cell, walls), "");
  SpeciesSpec tube = species(Shape::cylinder, 1, {2, 0.5, 2});
  tube.axis = 0;
  EXPECT_EQ(refusal_reason(tube, walls), "");
  tube.orientation = {0, 0, 1};
  EXPECT_NE(refusal_reason(tube, walls), "");
  SpeciesSpec disc = species(Shape::sphere, 1, {2, 2, 99});
  EXPECT_EQ(refusal_reason(disc, box({16, 16, 1}, {4, 4, 4})), "");
  disc.orientation = {10, 0, 0};
  EXPECT_NE(refusal_reason(disc, box({16, 16, 1}, {4, 4, 4})).find("about z"), std::string::npos);
  disc = species(Shape::sphere, 1, {});
  disc.placement = Placement::lattice;
  disc.count = {3, 1, 1};
  EXPECT_EQ(refusal_reason(disc, open), "");  // overlap is allowed
}

TEST(Placement, ReadsListsAndNamesBadLines) {
  const std::string path = ::testing::TempDir() + "eulastic_positions.csv";
  SpeciesSpec spec = species(Shape::sphere, 0.5, {});
  spec.placement = Placement::list;
  spec.positions_file = path;
  spec.orientation = {0, 0, 5};
  const GridSpec grid = box({16, 16, 16}, {4, 4, 4}, Boundary::wall);
  const auto with = [&](const char *content) {
    std::ofstream(path) << content;
    return refusal_reason(spec, grid);
  };
  EXPECT_EQ(with("x, y, z\r\n1,2,3\r\n\n 2 , 2 ,1, 10, 20, 30"), "");
  Places places;
  ASSERT_EQ(place_bodies(spec, grid, &places), "");
  ASSERT_EQ(places.known.size(), 2u);
  EXPECT_EQ(places.known[0].centre, (Real3{1, 2, 3}));
  EXPECT_EQ(places.known[0].orientation, (Real3{0, 0, 5}));
  EXPECT_EQ(places.known[1].orientation, (Real3{10, 20, 30}));
  for (const char *bad : {"x,y,z\n1,2,3\n1,2\n", "1,1,1\n1,2,3\n1,2,3x\n", "1,1,1\n\n1,,3", "1,1,1\n1,1,2\n1,2,nan",
                          "1,1,1\n1,1,2\nx,y,z\n", "# c\nx y z\n1;1 1;1", "1,1,1\n1,1,2\n1,2,3,\n"})
    EXPECT_NE(with(bad).find("line 3"), std::string::npos) << bad;
  // As others write them: their number first, blanks, angles in degrees about x, y and z.
  EXPECT_EQ(with("2\n1 2 3 0 0 0\n2 2 1 10 20 30\n"), "");
  ASSERT_EQ(place_bodies(spec, grid, &places), "");
  ASSERT_EQ(places.known.size(), 2u);
  EXPECT_EQ(places.known[1].centre, (Real3{2, 2, 1}));
  EXPECT_EQ(places.known[1].orientation, (Real3{10, 20, 30}));
  EXPECT_NE(with("1,2,3\n1,0.2,3\n").find("body 2"), std::string::npos);
  EXPECT_NE(with("x,y,z\n").find("holds no numbers"), std::string::npos);
  std::remove(path.c_str());
  EXPECT_NE(refusal_reason(spec, grid).find("cannot read"), std::string::npos);
}

}  // namespace
}  // namespace eulastic
