// The whole step: mirrored, rotated and halved scenes.
#include "support/materials.hpp"
#include "support/polynomials.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

// A scene as plain data, so that it can be mirrored and rotated.
struct Setting {
  Int3 cells{18, 16, 14};
  Real3 length{9, 8, 7};
  std::array<Boundary, 3> boundary{Boundary::periodic, Boundary::wall, Boundary::periodic};
  std::array<std::array<Real3, 2>, 3> wall_velocity{};
  std::array<std::array<BoundaryKind, 2>, 3> side{};
  Real3 force{0.4, 0.2, -0.3};
  Real3 centre{4.1, 3.3, 3.9};
  Real3 axes{2.2, 1.7, 1.9};
  PressureKind pressure = PressureKind::acm;
  MethodKind method = MethodKind::classic;
  Material material{0.4};

  Setting() { wall_velocity[1] = {Real3{-1.5, 0, 0.8}, Real3{2, 0, -1}}; }
};

Setting mirrored(Setting s, int d) {
  s.centre[d] = s.length[d] - s.centre[d];
  s.force[d] = -s.force[d];
  std::swap(s.wall_velocity[d][0], s.wall_velocity[d][1]);
  for (auto &pair : s.wall_velocity)
    for (auto &v : pair) v[d] = -v[d];
  return s;
}

// x becomes y, y becomes z, z becomes x (2-D: x and y are exchanged).
struct Permutation {
  Int3 to;
  template <class T>
  std::array<T, 3> operator()(const std::array<T, 3> &q) const {
    std::array<T, 3> r{};
    for (int d = 0; d < 3; ++d) r[to[d]] = q[d];
    return r;
  }
};

Setting permuted(const Setting &s, const Permutation &p) {
  Setting r = s;
  r.cells = p(s.cells);
  r.length = p(s.length);
  r.boundary = p(s.boundary);
  r.force = p(s.force);
  r.centre = p(s.centre);
  r.axes = p(s.axes);
  r.wall_velocity = p(s.wall_velocity);
  for (auto &pair : r.wall_velocity)
    for (auto &v : pair) v = p(v);
  return r;
}

void run(const Setting &s, Scene &scene, int steps = 20) {  // to t = 1
  GridSpec grid;
  grid.cells = s.cells;
  grid.length = s.length;
  grid.boundary = s.boundary;
  SolverSpec spec;
  static_cast<Method &>(spec) = method_preset(s.method);
  spec.viscous_tolerance = 1e-13;  // what is left of the residual depends on the coarse levels, which no half shares
  spec.pressure = s.pressure;
  spec.fluid.viscosity = 0.5;
  spec.fluid.body_force.force = s.force;
  for (int d = 0; d < 3; ++d)
    for (int side = 0; side < 2; ++side) {
      spec.sides[d][side].kind = s.side[d][side];
      spec.sides[d][side].motion.velocity = s.wall_velocity[d][side];
    }
  ASSERT_EQ(scene.create(PETSC_COMM_SELF, grid, spec), 0);
  const int dim = scene.domain.dimension();
  Phase &phase = scene.add_phase(0, [&](double x, double y, double z) {
    const Point point{x, y, z};
    double r = 0;
    for (int d = 0; d < dim; ++d) {
      r += std::pow((point[d] - s.centre[d]) / s.axes[d], 2);
    }
    // Rounded to 1/1024, so that the number is the same in a mirrored scene.
    return std::round(1024 * std::min(1.0, std::max(0.0, 2 - 1.5 * std::sqrt(r)))) / 1024;
  });
  phase.material = s.material;
  ASSERT_EQ(scene.solver.prepare(), 0);
  ASSERT_EQ(scene.run(1, steps), 0);
}

// Largest |a - map(b)| over velocity, pressure, fraction and tensor, for given point of b and component of a.
template <class Map>
double difference(const Scene &a, const Scene &b, Map map) {
  const int dim = a.domain.dimension();
  const State &p = a.solver.state(), &q = b.solver.state();
  const auto &components = tensor_components(dim);
  double largest = 0;
  const auto compare = [&](ConstView x, const Field &y, const Staggering &at, int c, int d) {
    for (int k = 0; k < a.domain.points_end(2, at[2]); ++k)
      for (int j = 0; j < a.domain.points_end(1, at[1]); ++j)
        for (int i = 0; i < a.domain.points_end(0, at[0]); ++i)
          largest = std::max(largest, std::fabs(x(i, j, k) - map(y, at, Int3{i, j, k}, c, d)));
  };
  for (int c = 0; c < dim; ++c) compare(p.velocity[c], q.velocity, at_face[c], c, -1);
  compare(p.pressure[0], q.pressure, at_centre, -1, -1);
  compare(p.phases[0].fraction[0], q.phases[0].fraction, at_centre, -1, -1);
  for (int f = 0; f < p.phases[0].tensor.field.count(); ++f)
    compare(p.phases[0].tensor.field[f], q.phases[0].tensor.field, components[f].at, components[f].a, components[f].b);
  return largest;
}

// Position in the field of component (c, d): a velocity, a scalar or a tensor component.
int block_position(int dim, int c, int d) {
  if (c < 0) return 0;
  if (d < 0 || c == d) return c;
  return dim == 2 ? 2 : 6 - c - d;
}

double mirror_difference(const Scene &a, const Scene &b, int m) {
  const int dim = a.domain.dimension();
  return difference(a, b, [&](const Field &y, const Staggering &at, Int3 point, int c, int d) {
    const int N = a.domain.domain_cells()[m];
    point[m] = at[m] ? (N - point[m]) % (a.domain.is_wall(m) ? N + 1 : N) : N - 1 - point[m];
    const double sign = (c == m) == (d == m) ? 1 : -1;
    return sign * y[block_position(dim, c, d)](point[0], point[1], point[2]);
  });
}

double permutation_difference(const Scene &a, const Scene &b, const Permutation &p) {
  const int dim = a.domain.dimension();
  return difference(a, b, [&](const Field &y, const Staggering &, const Int3 &point, int c, int d) {
    const Int3 x = p(point);
    return y[block_position(dim, c < 0 ? c : p.to[c], d < 0 ? d : p.to[d])](x[0], x[1], x[2]);
  });
}

Setting flat(Setting s) {
  s.cells[2] = 1;
  s.force[2] = s.wall_velocity[1][0][2] = s.wall_velocity[1][1][2] = 0;
  return s;
}

// The bits are equal, except for the sums of ACM, whose order follows x, and for the transforms of SMAC.
TEST(MirroredScene, GivesTheMirroredResult) {
  for (const bool two_d : {false, true})
    for (const PressureKind pressure : {PressureKind::acm, PressureKind::smac})
      for (const bool walls_x : {false, true}) {
        Setting setting;
        setting.pressure = pressure;
        if (walls_x) {
          setting.material = test::mooney_rivlin(0.1, 0.1, 0.2);
          setting.material.viscosity = 0.1;
          setting.boundary[0] = Boundary::wall;
          setting.wall_velocity[0][0] = {0, 1, 0.5};
        }
        if (two_d) {
          setting = flat(setting);
          setting.wall_velocity[0][0][2] = 0;
        }
        Scene original;
        run(setting, original);
        double moved = 0;
        for_points(original.domain, original.solver.state().phases[0].tensor.field[0], at_centre,
                   [&](double &q, double, double, double) { moved = std::max(moved, std::fabs(q - 1)); });
        EXPECT_GT(moved, 0.01);
        for (int d = 0; d < original.domain.dimension(); ++d) {
          Scene image;
          run(mirrored(setting, d), image);
          const double e = mirror_difference(original, image, d);
          std::printf("  mirrored in %c: %g\n", "xyz"[d], e);
          if (d > 0 && pressure == PressureKind::acm)
            EXPECT_EQ(e, 0) << "xyz"[d];
          else
            EXPECT_LT(e, 1e-12) << "xyz"[d];
          EXPECT_GT(mirror_difference(original, original, d), 1e-3) << "the scene itself is not symmetric";
        }
      }
}

TEST(RotatedScene, GivesTheRotatedResult) {
  for (const PressureKind pressure : {PressureKind::acm, PressureKind::smac})
    for (const Permutation &p : {Permutation{{1, 2, 0}}, Permutation{{2, 0, 1}}, Permutation{{0, 2, 1}}}) {
      Setting setting;
      setting.pressure = pressure;
      if (pressure == PressureKind::acm) setting.material = test::mooney_rivlin(0.1, 0.1, 0.2);
      if (p.to[0] == 1) setting.material.viscosity = 0.1;
      Scene original, rotated;
      run(setting, original);
      run(permuted(setting, p), rotated);
      const double e = permutation_difference(original, rotated, p);
      std::printf("  rotated: %g\n", e);
      EXPECT_LT(e, 1e-12) << p.to[0] << p.to[1] << p.to[2];
    }
  const Setting setting = flat(Setting());
  const Permutation swap{{1, 0, 2}};
  Scene original, rotated;
  run(setting, original);
  run(permuted(setting, swap), rotated);
  EXPECT_LT(permutation_difference(original, rotated, swap), 1e-12);
}

// The results agree to round-off where the V-cycle can pair all cells down to the coarsest grids; elsewhere they agree
// to the tolerance of ACM.
TEST(MirroredScene, GivesTheMirroredResultWithFast) {
  for (const bool two_d : {false, true})
    for (const PressureKind pressure : {PressureKind::acm, PressureKind::smac}) {
      Setting setting;
      setting.method = MethodKind::fast;
      setting.pressure = pressure;
      if (pressure == PressureKind::acm) setting.cells = {16, 16, 16};
      if (two_d) setting = flat(setting);
      if (two_d) setting.material.viscosity = 2.5;
      Scene original;
      run(setting, original);
      for (int d = 0; d < original.domain.dimension(); ++d) {
        Scene image;
        run(mirrored(setting, d), image);
        const double e = mirror_difference(original, image, d);
        std::printf("  fast, mirrored in %c: %g\n", "xyz"[d], e);
        EXPECT_LT(e, 1e-12) << "xyz"[d];
        EXPECT_GT(mirror_difference(original, original, d), 1e-3) << "the scene itself is not symmetric";
      }
    }
}

// The lower half of a scene that is its own mirror image along d, which is either periodic or between walls.
Setting half(Setting s, int d) {
  s.side[d] = {s.boundary[d] == Boundary::wall ? BoundaryKind::wall : BoundaryKind::symmetry, BoundaryKind::symmetry};
  s.boundary[d] = Boundary::wall;
  s.cells[d] /= 2;
  s.length[d] /= 2;
  return s;
}

// With planes of symmetry, a body on such a plane and its shear are as in the whole box, to round-off except for that
// of the mirror image.
TEST(HalfOfASymmetricScene, IsTheWholeOne) {
  for (const MethodKind method : {MethodKind::classic, MethodKind::fast})
    for (const bool two_d : {true, false})
      for (int d = 0; d < (two_d ? 2 : 3); ++d) {
        Setting setting;
        setting.cells = {16, 16, 12};
        setting.method = method;
        setting.pressure = PressureKind::smac;
        if (d == 2) setting.material = test::mooney_rivlin(0.1, 0.1, 0.2);
        if (d != 1) setting.material.viscosity = method == MethodKind::fast ? 2.5 : 0.1;
        setting.wall_velocity[1] = {Real3{-1.5, 0, 0.8}, Real3{2, 0, 0.8}};
        if (d == 1) setting.wall_velocity[1][1] = setting.wall_velocity[1][0];
        setting.centre[d] = setting.length[d] / 2;
        setting.force[d] = 0;
        for (Real3 &v : setting.wall_velocity[1]) v[d] = 0;
        if (two_d) setting = flat(setting);
        Scene whole, part;
        run(setting, whole);
        run(half(setting, d), part);
        const double e = difference(part, whole, [&](const Field &y, const Staggering &, const Int3 &x, int a, int b) {
          return y[block_position(two_d ? 2 : 3, a, b)](x[0], x[1], x[2]);
        });
        std::printf("  half along %c: %g\n", "xyz"[d], e);
        EXPECT_LT(e, 1e-11) << "xyz"[d] << (method == MethodKind::fast ? ", fast" : ", classic");
        EXPECT_GT(mirror_difference(whole, whole, (d + 1) % 2), 1e-3) << "nothing happens";
      }
}

// The fast method treats the directions one after the other, so that rotated scenes differ by the splitting error
// alone, which is at least of first order in the step.
TEST(RotatedScene, GivesTheRotatedResultWithinTheSplittingErrorWithFast) {
  Setting setting;
  setting.method = MethodKind::fast;
  setting.pressure = PressureKind::smac;
  for (const Permutation &p : {Permutation{{1, 2, 0}}, Permutation{{0, 2, 1}}}) {
    double e[2];
    for (const int small : {0, 1}) {
      Scene original, rotated;
      run(setting, original, small ? 160 : 20);
      run(permuted(setting, p), rotated, small ? 160 : 20);
      e[small] = permutation_difference(original, rotated, p);
    }
    std::printf("  fast, rotated: %g, in steps of an eighth %g\n", e[0], e[1]);
    EXPECT_LT(e[1], 1e-4);  // of B up to a few per cent from I, velocities about 1
    EXPECT_LT(e[1], e[0] / 8);
    EXPECT_GT(e[1], 1e-12) << "no splitting: expect round-off";
  }
}

}  // namespace
