// The interface on 1-4 ranks: the bits of plain sweeps over whole rows on one rank, mirrored scenes, kept volume.
#include "base/rank_zero.hpp"
#include "kernels/interface_flux.hpp"
#include "support/interface_scene.hpp"
#include "support/on_one_rank.hpp"

#include <gtest/gtest.h>

#include <cstring>

using namespace eulastic;
using namespace eulastic::test;

namespace {

constexpr double pi = 3.14159265358979323846;

// A number in -1 ... 1 for each point of the half-cell lattice of a unit cell size.
double noise(const Real3 &x, int salt) {
  std::uint64_t h = 0x9e3779b97f4a7c15u * (salt + 1);
  for (const double c : x) {
    h ^= static_cast<std::uint64_t>(std::llround(2 * c) + 1000);
    h *= 0xff51afd7ed558ccdu;
    h ^= h >> 32;
  }
  return static_cast<double>(h >> 11) * 0x1p-52 - 1;
}

// Random and solenoidal; no flow through walls.
Potential random_potential(const GridSpec &spec, double amplitude) {
  const auto component = [=](int salt) {
    return [=](const Real3 &x) {
      double factor = amplitude;
      for (int d = 0; d < 3; ++d)
        if (d != salt && spec.boundary[d] == Boundary::wall && spec.cells[d] > 1)
          factor *= std::sin(pi * x[d] / spec.length[d]);
      return factor * noise(x, salt);
    };
  };
  if (spec.cells[2] == 1) return {nullptr, nullptr, component(2)};
  return {component(0), component(1), component(2)};
}

GridSpec make_spec(const Int3 &cells, int walls) {
  GridSpec spec;
  spec.cells = cells;
  for (int d = 0; d < 3; ++d) {
    spec.length[d] = cells[d];
    spec.boundary[d] = walls >> d & 1 ? Boundary::wall : Boundary::periodic;
  }
  return spec;
}

// A ball, and another one that touches the low corner.
Position two_balls(const GridSpec &spec) {
  Real3 centre{};
  for (int d = 0; d < 3; ++d) centre[d] = 0.61 * spec.cells[d];
  const double size = std::min({spec.cells[0], spec.cells[1], spec.cells[2] == 1 ? 1000 : spec.cells[2]});
  const int dimension = spec.cells[2] == 1 ? 2 : 3;
  const Position a = ball(centre, 0.27 * size, dimension), b = ball({0.4, 0.7, 0.2}, 0.31 * size, dimension);
  return [=](const Real3 &x) { return std::min(a(x), b(x)); };
}

// The method without bands, margins and shared ghosts: whole rows, an exchange before every direction.
void sweep_whole_rows(InterfaceScene &scene, GhostExchange &exchange, double dt) {
  static const char *const orders[2][6] = {{"xy", "yx", "xy", "yx", "xy", "yx"},
                                           {"xyz", "zyx", "yzx", "xzy", "zxy", "yxz"}};
  const Domain &domain = scene.domain;
  const Int3 n = domain.cells();
  const int dimension = domain.dimension(), margin = dimension == 3 ? 1 : 0;
  Field work(domain, 2);
  scene.each_owned([&](int i, int j, int k) { work[1](i, j, k) = scene.fraction[0](i, j, k) > 0.5; });
  for (const char *name = orders[dimension - 2][scene.step++ % 6]; *name; ++name) {
    const int d = *name - 'x';
    const double rate = dt / domain.spacing()[d];
    const View phi = scene.fraction[0], flux = work[0], solid = work[1];
    const ConstView velocity = scene.velocity[d];
    ASSERT_EQ(exchange.update_ghosts(scene.fraction, 2), 0);
    fill_wall_ghosts_even(domain, at_centre, phi, 2);
    std::ptrdiff_t stride[3];
    for (int e = 0; e < 3; ++e) stride[e] = phi.stride((d + e) % dimension);
    for (int k = 0; k < n[2] + margin; ++k)
      for (int j = 0; j <= n[1]; ++j)
        kernels::uniform_flux({0, n[0] + 1, j, k}, phi, velocity, stride[0], rate, flux.row(j, k));
    for (int k = -margin; k <= n[2] - 1 + margin; ++k)
      for (int j = -1; j <= n[1]; ++j)
        for (int i = -1; i <= n[0]; ++i) {  // lists of one cell
          if (!(phi(i, j, k) > 0 && phi(i, j, k) < 1)) continue;
          kernels::MixedCells cell;
          const int place = d == 0 ? i : d == 1 ? j : k;
          cell.at[0] = &phi(i, j, k) - phi.origin;
          cell.low[0] = place >= 0;
          cell.high[0] = place < n[d];
          cell.count = 1;
          const double *q = phi.origin, *u = velocity.origin;
          if (dimension == 2)
            kernels::mixed_flux<2>(cell, q, stride, u, rate, flux.origin);
          else
            kernels::mixed_flux<3>(cell, q, stride, u, rate, flux.origin);
        }
    for (int k = 0; k < n[2]; ++k)
      for (int j = 0; j < n[1]; ++j)
        kernels::apply_flux({0, n[0], j, k}, flux, velocity, solid, stride[0], rate, phi.row(j, k));
  }
}

double largest_courant_sum(const InterfaceScene &scene) {
  Real3 largest{};
  scene.each_owned([&](int i, int j, int k) {
    for (int d = 0; d < scene.domain.dimension(); ++d)
      largest[d] = std::max(largest[d], std::abs(scene.velocity[d](i, j, k)) / scene.domain.spacing()[d]);
  });
  return largest[0] + largest[1] + largest[2];
}

TEST(InterfaceOnRanks, HasTheBitsOfWholeRows) {
  int ranks = 0, visited = 0;
  MPI_Comm_size(run_communicator(), &ranks);
  for (const Int3 &cells : {Int3{13, 12, 14}, Int3{21, 9, 12}, Int3{6, 13, 7}, Int3{29, 18, 1}, Int3{12, 13, 1}})
    for (const int walls : {0, 2, cells[2] == 1 ? 1 : 5, cells[2] == 1 ? 3 : 7})
      for (int px = 1; px <= ranks; ++px)
        for (int py = 1; py <= ranks; ++py) {
          GridSpec spec = make_spec(cells, walls);
          InterfaceScene whole, part;
          ASSERT_EQ(whole.create(PETSC_COMM_SELF, spec), 0);
          spec.processors = {px, py, 0};
          if (!Domain::refusal_reason(spec, ranks).empty()) continue;
          ASSERT_EQ(part.create(run_communicator(), spec), 0);
          SCOPED_TRACE(::testing::Message() << cells[0] << " x " << cells[1] << " x " << cells[2] << " on " << px
                                            << " x " << py << ", walls " << walls);
          for (InterfaceScene *scene : {&whole, &part}) {
            scene->set_fraction(two_balls(spec));
            ASSERT_EQ(scene->set_velocity(random_potential(spec, 1)), 0);
          }
          GhostExchange exchange(whole.domain);
          const double dt = 0.45 / largest_courant_sum(whole);
          for (int step = 0; step < 6; ++step) {
            ASSERT_EQ(part.advance(dt), 0);
            sweep_whole_rows(whole, exchange, dt);
          }
          int errors = 0;
          part.each_owned([&](int i, int j, int k) {
            const Int3 &begin = part.domain.layout().begin;
            const double a = part.fraction[0](i, j, k), b = whole.fraction[0](begin[0] + i, begin[1] + j, begin[2] + k);
            errors += std::memcmp(&a, &b, sizeof a) != 0;
          });
          EXPECT_EQ(errors, 0);
          ++visited;
        }
  EXPECT_GE(visited, 20);
}

// Far from the interface nothing is computed, and what is there stays exact.
TEST(InterfaceBand, IsThinAndLeavesTheRestAlone) {
  if (!is_alone()) return;
  InterfaceScene scene;
  GridSpec spec = make_spec({64, 48, 40}, 0);
  ASSERT_EQ(scene.create(PETSC_COMM_SELF, spec), 0);
  scene.set_fraction(ball({32, 24, 20}, 10, 3));
  scene.set_velocity(Real3{0.3, -0.2, 0.1});
  for (int step = 0; step < 40; ++step) ASSERT_EQ(scene.advance(0.5), 0);
  const double area = 4 * pi * 100;
  // Segments end with a whole vector: 3.5 cells more on average, once for the half of the surface that faces +x.
  EXPECT_LT(scene.band_cells(), (13 + 3.5 / 2) * area);
  // A plane with the unit normal n cuts |n_x| + |n_y| + |n_z| cells per area, 3/2 on average: no tails.
  const double mixed = scene.sum([](double q) { return q > 0 && q < 1; });
  const double body = scene.sum([](double q) { return q > 1e-5 && q < 1 - 1e-5; });
  std::printf("  mixed cells per area: %.2f, %.2f of them not nearly pure\n", mixed / area, body / area);
  EXPECT_LT(mixed, 1.7 * area);
  EXPECT_GT(body, 1.4 * area);
  EXPECT_EQ(scene.fraction[0](38, 20, 22), 1);
  EXPECT_EQ(scene.fraction[0](5, 20, 22), 0);
}

// Mirrored in any directions: the same bits at the mirrored place.
TEST(InterfaceMirror, GivesTheMirroredBits) {
  if (!is_alone()) return;
  for (const Int3 &cells : {Int3{12, 11, 13}, Int3{17, 14, 1}})
    for (int mirror = 1; mirror < (cells[2] == 1 ? 4 : 8); ++mirror)
      for (const int walls : {0, 2}) {
        const GridSpec spec = make_spec(cells, walls);
        InterfaceScene a, b;
        for (InterfaceScene *scene : {&a, &b}) ASSERT_EQ(scene->create(PETSC_COMM_SELF, spec), 0);
        const auto mirrored = [&](Int3 p, const Staggering &at) {
          for (int d = 0; d < 3; ++d)
            if (mirror >> d & 1) p[d] = cells[d] - (at[d] ? 0 : 1) - p[d];
          return p;
        };
        a.set_fraction(two_balls(spec));
        ASSERT_EQ(a.set_velocity(random_potential(spec, 1)), 0);
        a.each_owned([&](int i, int j, int k) {
          const Int3 p = mirrored({i, j, k}, at_centre);
          b.fraction[0](p[0], p[1], p[2]) = a.fraction[0](i, j, k);
        });
        for (int c = 0; c < a.domain.dimension(); ++c)
          for (int k = 0; k < a.domain.points_end(2, c == 2); ++k)
            for (int j = 0; j < a.domain.points_end(1, c == 1); ++j)
              for (int i = 0; i < a.domain.points_end(0, c == 0); ++i) {
                const Int3 p = mirrored({i, j, k}, at_face[c]);
                const double v = a.velocity[c](i, j, k);
                b.velocity[c](p[0], p[1], p[2]) = mirror >> c & 1 ? 0.0 - v : v;
                if (!a.domain.is_wall(c) && p[c] == cells[c]) {  // the face N of a periodic direction is face 0
                  Int3 first = p;
                  first[c] = 0;
                  b.velocity[c](first[0], first[1], first[2]) = b.velocity[c](p[0], p[1], p[2]);
                }
              }
        ASSERT_EQ(b.update_velocity_ghosts(), 0);
        const double dt = 0.45 / largest_courant_sum(a);
        for (int step = 0; step < 6; ++step)
          for (InterfaceScene *scene : {&a, &b}) ASSERT_EQ(scene->advance(dt), 0);
        int errors = 0;
        a.each_owned([&](int i, int j, int k) {
          const Int3 p = mirrored({i, j, k}, at_centre);
          errors += b.fraction[0](p[0], p[1], p[2]) != a.fraction[0](i, j, k);
        });
        EXPECT_EQ(errors, 0) << cells[2] << " cells in z, mirrored in " << mirror << ", walls " << walls;
      }
}

// 0 <= phi <= 1 always, and the volume to round-off, for any discretely solenoidal velocity; with walls as well.
TEST(InterfaceVolume, IsKeptByARandomSolenoidalVelocity) {
  if (!is_alone()) return;
  for (const int walls : {0, 2, 7}) {
    InterfaceScene scene;
    const GridSpec spec = make_spec({24, 22, 20}, walls);
    ASSERT_EQ(scene.create(PETSC_COMM_SELF, spec), 0);
    scene.set_fraction(two_balls(spec));
    ASSERT_EQ(scene.set_velocity(random_potential(spec, 1)), 0);
    const double dt = 0.49 / largest_courant_sum(scene), volume = scene.sum();
    double worst = 0, outside = 0;
    for (int step = 0; step < 300; ++step) {
      ASSERT_EQ(scene.advance(step % 50 < 30 ? dt : -dt), 0);
      worst = std::max(worst, std::abs(scene.sum() / volume - 1));
      outside += scene.sum([](double q) { return !(q >= 0 && q <= 1); });
    }
    std::printf("  walls %d: volume kept to %.1e in 300 steps\n", walls, worst);
    EXPECT_LT(worst, 1e-13);
    EXPECT_EQ(outside, 0);
  }
}

// Also when it is not solenoidal: only the Courant numbers count.
TEST(InterfaceVolume, StaysBoundedInACompressibleFlow) {
  if (!is_alone()) return;
  InterfaceScene scene;
  const GridSpec spec = make_spec({16, 15, 14}, 0);
  ASSERT_EQ(scene.create(PETSC_COMM_SELF, spec), 0);
  scene.set_fraction(two_balls(spec));
  for (int d = 0; d < 3; ++d)
    for (int k = -3; k < 17; ++k)
      for (int j = -3; j < 18; ++j)
        for (int i = -3; i < 19; ++i)
          scene.velocity[d](i, j, k) = noise({double((i + 16) % 16), double((j + 15) % 15), double((k + 14) % 14)}, d);
  for (int step = 0; step < 60; ++step) ASSERT_EQ(scene.advance(1. / 6), 0);
  EXPECT_EQ(scene.sum([](double q) { return !(q >= 0 && q <= 1); }), 0);
}

}  // namespace
