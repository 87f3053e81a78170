// Ghosts behind walls: every boundary combination, every staggering, edges and corners, moving walls.
#include "field/boundaries.hpp"

#include "field/carried_tensor.hpp"
#include "field/ghost_exchange.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace eulastic {
namespace {

constexpr double poison = std::numeric_limits<double>::quiet_NaN();
using Point = std::function<double(const Int3 &)>;

GridSpec box(const Int3 &cells, int walls) {
  GridSpec spec;
  spec.cells = cells;
  for (int d = 0; d < 3; ++d) spec.boundary[d] = walls >> d & 1 ? Boundary::wall : Boundary::periodic;
  return spec;
}

void for_each_grid(const std::function<void(const Domain &)> &visit) {
  for (const Int3 &cells : {Int3{5, 9, 7}, Int3{3, 3, 3}, Int3{6, 4, 1}, Int3{3, 3, 1}})
    for (int walls = 0; walls < (cells[2] == 1 ? 4 : 8); ++walls) {
      SCOPED_TRACE(::testing::Message() << cells[0] << " x " << cells[1] << " x " << cells[2] << ", walls " << walls);
      Domain domain;
      ASSERT_EQ(domain.create(PETSC_COMM_SELF, box(cells, walls)), 0);
      visit(domain);
    }
}

// Visits all points up to `width` ghosts, and the additional layer behind a high wall.
template <class Visit>
void for_each_point(const Domain &domain, const Staggering &staggering, int width, const Visit &visit) {
  Int3 low{}, high{}, more{};
  for (int d = 0; d < 3; ++d) {
    const int w = d < domain.dimension() ? width : 0;
    low[d] = -w;
    high[d] = domain.domain_cells()[d] + w;
    more[d] = staggering[d] && domain.is_wall(d);
  }
  for (int k = low[2]; k < high[2] + more[2]; ++k)
    for (int j = low[1]; j < high[1] + more[1]; ++j)
      for (int i = low[0]; i < high[0] + more[0]; ++i)
        // no stencil reads behind two of them
        if ((i == high[0]) + (j == high[1]) + (k == high[2]) <= 1) visit(Int3{i, j, k});
}

bool is_owned(const Domain &domain, const Int3 &p, const Staggering &staggering) {
  for (int d = 0; d < 3; ++d)
    if (p[d] < 0 || p[d] >= domain.points_end(d, staggering[d])) return false;
  return true;
}

// Returns some value of field f at a point inside the box.
double inner(int f, const Int3 &p) { return std::sin(1 + f + 1.3 * p[0] + 2.7 * p[1] + 4.1 * p[2]); }

// Poisons all values, sets the points of the field, then exchanges ghosts.
void prepare(const Domain &domain, Field &block, const std::function<Staggering(int)> &staggering, int width) {
  for (int f = 0; f < block.count(); ++f) {
    block.fill(f, poison);
    for_each_point(domain, staggering(f), 3, [&](const Int3 &p) {
      if (is_owned(domain, p, staggering(f))) block[f](p[0], p[1], p[2]) = inner(f, p);
    });
  }
  GhostExchange exchange(domain);
  ASSERT_EQ(exchange.update_ghosts(block, width), 0);
}

// Returns the value of a ghost: the point is unfolded direction by direction, in the reverse order of the reflections.
// `sign` is -1 for the velocity and +1 for even fields.
double unfolded(const Domain &domain, Int3 p, const Staggering &staggering, double sign, const std::vector<int> &order,
                const std::function<double(int, int)> &twice_wall, const Point &inside) {
  for (auto d = order.rbegin(); d != order.rend(); ++d) {
    const int n = domain.domain_cells()[*d], last = n - (staggering[*d] ? 0 : 1);
    if (!domain.is_wall(*d) || (p[*d] >= 0 && p[*d] <= last)) continue;
    const int side = p[*d] > last;
    p[*d] = side ? 2 * n - p[*d] - (staggering[*d] ? 0 : 1) : -p[*d] - (staggering[*d] ? 0 : 1);
    const std::vector<int> before(order.begin(), d.base() - 1);
    return twice_wall(*d, side) + sign * unfolded(domain, p, staggering, sign, before, twice_wall, inside);
  }
  for (int d = 0; d < 3; ++d)
    if (!domain.is_wall(d)) p[d] = (p[d] + domain.domain_cells()[d]) % domain.domain_cells()[d];
  return inside(p);
}

TEST(WallGhosts, VelocityIsOddAboutTheMovingWallAndStopsAtTheFace) {
  BoundaryConditions walls{};
  for (int d = 0; d < 3; ++d)
    for (int side = 0; side < 2; ++side) walls[d][side].motion = {{.1 + d, .2 - side, .3 * d}, 1.5 + d, .4 * side};
  const double time = .7;
  for_each_grid([&](const Domain &domain) {
    for (const int width : {1, 2, 3}) {
      Field velocity(domain, domain.dimension());
      prepare(
          domain, velocity, [](int c) { return at_face[c]; }, width);
      fill_wall_ghosts_velocity(domain, walls, time, velocity, width);
      int wrong = 0, faces = 0;
      for (int c = 0; c < domain.dimension(); ++c) {
        std::vector<int> order;
        for (int e = 0; e < domain.dimension(); ++e) order.push_back((c + e) % domain.dimension());
        const auto twice_wall = [&](int d, int side) {
          const WallMotion &motion = walls[d][side].motion;
          return c == d ? 0 : 2 * (motion.velocity[c] * std::cos(motion.frequency * time + motion.phase));
        };
        const auto inside = [&](const Int3 &p) {
          const bool on_face = domain.is_wall(c) && (p[c] == 0 || p[c] == domain.domain_cells()[c]);
          faces += on_face;
          return on_face ? 0.0 : inner(c, p);
        };
        for_each_point(domain, at_face[c], width, [&](const Int3 &p) {
          wrong += velocity[c](p[0], p[1], p[2]) != unfolded(domain, p, at_face[c], -1, order, twice_wall, inside);
        });
      }
      EXPECT_EQ(wrong, 0) << "width " << width;
      EXPECT_EQ(faces > 0, domain.is_wall(0) || domain.is_wall(1) || domain.is_wall(2));
    }
  });
}

TEST(WallGhosts, EveryStaggeringIsEvenAndKeepsItsPoints) {
  for_each_grid([](const Domain &domain) {
    for (int s = 0; s < (domain.dimension() == 2 ? 4 : 8); ++s)
      for (const int width : {1, 2, 3}) {
        const Staggering staggering{bool(s & 1), bool(s & 2), bool(s & 4)};
        Field block(domain, 1);
        prepare(
            domain, block, [&](int) { return staggering; }, width);
        fill_wall_ghosts_even(domain, staggering, block[0], width);
        int wrong = 0;
        for_each_point(domain, staggering, width, [&](const Int3 &p) {
          wrong += block[0](p[0], p[1], p[2]) != unfolded(
                                                     domain, p, staggering, 1, {0, 1, 2}, [](int, int) { return 0.; },
                                                     [](const Int3 &q) { return inner(0, q); });
        });
        EXPECT_EQ(wrong, 0) << "staggering " << s << ", width " << width;
      }
  });
}

TEST(WallGhosts, EachTensorComponentReflectsWhereItLives) {
  for_each_grid([](const Domain &domain) {
    const auto &components = tensor_components(domain.dimension());
    Field tensor(domain, static_cast<int>(components.size()));
    prepare(
        domain, tensor, [&](int f) { return components[f].at; }, 3);
    fill_wall_ghosts_tensor(domain, BoundaryConditions{}, tensor, 3);
    int wrong = 0;
    for (int f = 0; f < tensor.count(); ++f)
      for_each_point(domain, components[f].at, 3, [&](const Int3 &p) {
        wrong +=
            tensor[f](p[0], p[1], p[2]) != unfolded(
                                               domain, p, components[f].at, 1, {0, 1, 2}, [](int, int) { return 0.; },
                                               [&](const Int3 &q) { return inner(f, q); });
      });
    EXPECT_EQ(wrong, 0);
  });
}

// The mirror image lies behind a plane of symmetry: the tangential velocity is even, normal velocity and shear are odd
// and 0 on the plane.
TEST(SymmetryGhosts, AreTheMirrorImage) {
  Domain domain;
  ASSERT_EQ(domain.create(PETSC_COMM_SELF, box({3, 4, 1}, 2)), 0);
  BoundaryConditions sides{};
  sides[1][1].kind = BoundaryKind::symmetry;
  Field velocity(domain, 2), tensor(domain, 3);
  for (int j = 0; j < 5; ++j)
    for (int i = 0; i < 3; ++i) {
      for (int c = 0; c < 2; ++c) velocity[c](i, j, 0) = 1 + j + 10 * c;
      for (int c = 0; c < 3; ++c) tensor[c](i, j, 0) = 1 + j + 10 * c;
    }
  GhostExchange exchange(domain);
  ASSERT_EQ(exchange.update_ghosts(velocity, 3), 0);
  ASSERT_EQ(exchange.update_ghosts(tensor, 3), 0);
  fill_wall_ghosts_velocity(domain, sides, 0, velocity, 3);
  fill_wall_ghosts_tensor(domain, sides, tensor, 3);
  const double even[3] = {4, 3, 2}, normal[3] = {-14, -13, -12}, shear[3] = {-24, -23, -22};
  for (int m = 0; m < 3; ++m)
    for (int i = -3; i < 6; ++i) {
      EXPECT_EQ(velocity[0](i, 4 + m, 0), even[m]);
      EXPECT_EQ(tensor[0](i, 4 + m, 0), even[m]);
      EXPECT_EQ(tensor[1](i, 4 + m, 0), 10 + even[m]);
      EXPECT_EQ(velocity[1](i, 5 + m, 0), normal[m]);
      EXPECT_EQ(tensor[2](i, 5 + m, 0), shear[m]);
      EXPECT_EQ(velocity[0](i, -1 - m, 0), -(1 + m));  // the low boundary is still a wall
      EXPECT_EQ(tensor[2](i, -1 - m, 0), 22 + m);
    }
  for (int i = -3; i < 6; ++i) {
    EXPECT_EQ(velocity[1](i, 4, 0), 0);
    EXPECT_EQ(tensor[2](i, 4, 0), 0);
    EXPECT_EQ(tensor[2](i, 0, 0), 21);
  }
}

TEST(WallGhosts, TensorComponentsAreInTheirOrder) {
  const auto &full = tensor_components(3);
  ASSERT_EQ(full.size(), 6u);
  for (int d = 0; d < 3; ++d) EXPECT_EQ(full[d].at, at_centre);
  EXPECT_EQ(full[3].at, (Staggering{false, true, true}));  // yz
  EXPECT_EQ(full[4].at, (Staggering{true, false, true}));  // xz
  EXPECT_EQ(full[5].at, (Staggering{true, true, false}));  // xy
  const auto &flat = tensor_components(2);
  ASSERT_EQ(flat.size(), 3u);
  EXPECT_EQ(flat[2].at, (Staggering{true, true, false}));
}

// Hand-written values: Couette flow between walls with the velocities -1 and 3 over four cells is linear through the
// ghosts; u_i is -0.5, 0.5, 1.5, 2.5. The normal velocity y (4 - y) continues oddly, -5 at y = -1.
TEST(WallGhosts, CouetteStaysLinearThroughTheWalls) {
  Domain domain;
  ASSERT_EQ(domain.create(PETSC_COMM_SELF, box({3, 4, 1}, 2)), 0);
  BoundaryConditions walls{};
  walls[1][0].motion.velocity = {-1, 9, 0};  // the normal component is ignored
  walls[1][1].motion.velocity = {3, 9, 0};
  Field velocity(domain, 2);
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 3; ++i) {
      velocity[0](i, j, 0) = j - .5;
      velocity[1](i, j, 0) = j * (4 - j);
    }
  GhostExchange exchange(domain);
  ASSERT_EQ(exchange.update_ghosts(velocity, 3), 0);
  fill_wall_ghosts_velocity(domain, walls, 0, velocity, 3);
  for (int i = -3; i < 6; ++i) {
    for (int j = -3; j < 7; ++j) EXPECT_EQ(velocity[0](i, j, 0), j - .5);
    const double v[10] = {-3, -4, -3, 0, 3, 4, 3, 0, -3, -4};
    for (int j = -3; j < 7; ++j) EXPECT_EQ(velocity[1](i, j, 0), v[j + 3]);
  }
}

// If walls and flow are rotated, x -> y -> z -> x, so are the ghosts, including corners.
TEST(WallGhosts, RotatedScenesHaveRotatedGhosts) {
  for (int dimension = 2; dimension <= 3; ++dimension) {
    Int3 cells{4, 5, dimension == 3 ? 6 : 1}, turned_cells = cells;
    const auto turn = [&](auto vector) {  // component c becomes component c + 1
      auto result = vector;
      for (int c = 0; c < dimension; ++c) result[(c + 1) % dimension] = vector[c];
      return result;
    };
    turned_cells = turn(cells);
    Domain domain, turned;
    ASSERT_EQ(domain.create(PETSC_COMM_SELF, box(cells, 7)), 0);
    ASSERT_EQ(turned.create(PETSC_COMM_SELF, box(turned_cells, 7)), 0);
    BoundaryConditions walls{}, turned_walls{};
    for (int d = 0; d < dimension; ++d)
      for (int side = 0; side < 2; ++side) {
        WallMotion motion{{.7 + d, 1.1 - d + side, dimension == 3 ? 1.9 + side : 0}, .3, .1 * d};
        walls[d][side].motion = motion;
        motion.velocity = turn(motion.velocity);
        turned_walls[(d + 1) % dimension][side].motion = motion;
      }
    Field velocity(domain, dimension), turned_velocity(turned, dimension);
    for (int c = 0; c < dimension; ++c)
      for_each_point(domain, at_face[c], 3, [&](const Int3 &p) {
        if (!is_owned(domain, p, at_face[c])) return;
        const Int3 q = turn(p);
        velocity[c](p[0], p[1], p[2]) = turned_velocity[(c + 1) % dimension](q[0], q[1], q[2]) = inner(c, p);
      });
    fill_wall_ghosts_velocity(domain, walls, .5, velocity, 3);
    fill_wall_ghosts_velocity(turned, turned_walls, .5, turned_velocity, 3);
    int wrong = 0;
    for (int c = 0; c < dimension; ++c)
      for_each_point(domain, at_face[c], 3, [&](const Int3 &p) {
        const Int3 q = turn(p);
        wrong += velocity[c](p[0], p[1], p[2]) != turned_velocity[(c + 1) % dimension](q[0], q[1], q[2]);
      });
    EXPECT_EQ(wrong, 0) << dimension << "-D";
  }
}

TEST(WallGhosts, OfTheTensorOnlyWhereABodyIsNear) {
  for (int d = 0; d < 3; ++d) {
    Domain domain;
    ASSERT_EQ(domain.create(PETSC_COMM_SELF, box({24, 26, 28}, 1 << d)), 0);
    Field phi(domain, 1), tensor(domain, 6);
    Int3 body{12, 12, 12};
    body[d] = 5;
    phi[0](body[0], body[1], body[2]) = 1;
    OccupiedRows rows;
    ASSERT_EQ(rows.find(domain, phi[0]), 0);
    for (const Segment &s : domain.rows())
      for (int f = 0; f < 6; ++f)
        for (int i = 0; i < s.i_end; ++i) tensor[f](i, s.j, s.k) = 1 + f;
    fill_wall_ghosts_tensor(domain, BoundaryConditions{}, tensor, 3, &rows);
    const auto ghost = [&](int f, Int3 at, int index) {
      at[d] = index;
      return tensor[f](at[0], at[1], at[2]);
    };
    const int high = domain.domain_cells()[d] + 1;  // behind the wall for any staggering
    Int3 away = body;
    away[(d + 1) % 3] = 22;
    for (int f = 0; f < 6; ++f) {
      EXPECT_EQ(ghost(f, body, -1), 1 + f) << d;
      if (d == 0) continue;  // rows are processed as one piece along x
      EXPECT_EQ(ghost(f, body, high), 0) << d;
      if (d == 2) continue;
      EXPECT_EQ(ghost(f, away, -1), 0) << d;
    }
  }
}

TEST(WallMotion, OscillatesAsACosine) {
  const WallMotion motion{{3, 0, -4}, 2, .5};
  const Real3 now = motion.at(.25);
  EXPECT_DOUBLE_EQ(now[0], 3 * 0.54030230586813972);  // cos 1
  EXPECT_EQ(now[1], 0);
  EXPECT_DOUBLE_EQ(now[2], -4 * 0.54030230586813972);
  EXPECT_EQ(motion.speed(), 5);
  const WallMotion steady{{1, 0, 0}, 0, 0};
  EXPECT_EQ(steady.at(1e9)[0], 1);
}

}  // namespace
}  // namespace eulastic
