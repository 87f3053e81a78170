// CapillaryForce: a drop in a box of its own has the force and the sums of the same drop on the grid, with the same
// bits.
#include "drops/capillary_force.hpp"
#include "drops/surface_tension.hpp"
#include "grid/occupied_rows.hpp"
#include "grid/threads.hpp"
#include "support/interface_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

using namespace eulastic;
using namespace eulastic::test;

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr double scale = 0.7, slope_factor = 0.3, sigma = 2.5;

struct Case {
  const char *name;
  Int3 cells;
  bool bounded;  // walls in y and, in 3-D, in z
  Real3 centre, axes;
  bool crosses_x = false;  // a row of the grid has two pieces of it, which are added up in another order
  // The last two drops have no cut cells; a rod along y has no heights at its rims.
  enum Shape { smooth, stepped, rod };
  Shape shape = smooth;
};

void PrintTo(const Case &c, std::ostream *out) { *out << c.name; }

// A discrete drop with a velocity on the grid of one rank.
struct OnGrid : InterfaceScene {
  std::vector<Phase> phases{1};
  Int3 begin{}, end{1, 1, 1};  // of the cells with phi != 0; across periodic sides they go on
  std::unique_ptr<GhostExchange> exchange;

  explicit OnGrid(const Case &c) {
    GridSpec spec;
    spec.cells = c.cells;
    spec.length = {1.2, 1, 0.9};
    spec.ghosts = CapillaryForce::phi_ghosts;
    for (int d = 1; d < 3; ++d)
      if (c.bounded && c.cells[d] > 1) spec.boundary[d] = Boundary::wall;
    EXPECT_EQ(create(PETSC_COMM_SELF, spec), 0);
    const int dim = domain.dimension();
    const Position drop = ellipsoid(c.centre, c.axes, dim);
    set_fraction([&](Real3 x) {
      for (int d = 0; d < dim; ++d)
        if (!domain.is_wall(d)) x[d] -= spec.length[d] * std::round((x[d] - c.centre[d]) / spec.length[d]);
      if (c.shape != Case::rod) return drop(x);
      const double along = x[1] - c.centre[1];
      x[1] = c.centre[1];
      return std::max(drop(x), std::fabs(along) - c.axes[1]);
    });
    if (c.shape != Case::smooth)
      each_owned([&](int i, int j, int k) { fraction[0](i, j, k) = std::round(fraction[0](i, j, k)); });
    find_extent(c);
    phases[0].material.surface_tension = sigma;
    phases[0].fraction = std::move(fraction);
    exchange = std::make_unique<GhostExchange>(domain);
    EXPECT_EQ(exchange->update_ghosts(phases[0].fraction, spec.ghosts), 0);
    fill_wall_ghosts_even(domain, at_centre, phases[0].fraction[0], spec.ghosts);
    EXPECT_EQ(phases[0].rows.find(domain, std::as_const(phases[0]).fraction[0]), 0);
    for (int d = 0; d < dim; ++d)
      each_owned([&](int i, int j, int k) { velocity[d](i, j, k) = std::sin(1 + i + 1.7 * j + 2.9 * k + 5 * d); });
  }

  // A box with `margin` cells around the drop, except at walls.
  Box box(int margin) const {
    Int3 first = begin, cells{1, 1, 1};
    for (int d = 0; d < domain.dimension(); ++d) {
      int last = end[d] + margin;
      first[d] -= margin;
      if (domain.is_wall(d)) {
        first[d] = std::max(first[d], 0);
        last = std::min(last, domain.domain_cells()[d]);
      }
      cells[d] = last - first[d];
    }
    return Box(domain.domain_shape(), first, cells, CapillaryForce::phi_ghosts);
  }
  // The cell of the grid that corresponds to a cell of a box.
  Int3 image(const Box &box, int i, int j, int k) const {
    const Int3 &first = box.layout().begin;
    return {box.image(0, first[0] + i), box.image(1, first[1] + j), box.image(2, first[2] + k)};
  }

private:
  void find_extent(const Case &c) {
    Int3 from{}, to{1, 1, 1};
    for (int d = 0; d < domain.dimension(); ++d) {
      const double h = domain.spacing()[d];
      from[d] = static_cast<int>(std::floor((c.centre[d] - c.axes[d]) / h)) - 3;
      to[d] = static_cast<int>(std::ceil((c.centre[d] + c.axes[d]) / h)) + 3;
      if (domain.is_wall(d)) {
        from[d] = std::max(from[d], 0);
        to[d] = std::min(to[d], domain.domain_cells()[d]);
      }
    }
    begin = to;
    end = from;
    for (int k = from[2]; k < to[2]; ++k)
      for (int j = from[1]; j < to[1]; ++j)
        for (int i = from[0]; i < to[0]; ++i) {
          if (fraction[0](domain.image(0, i), domain.image(1, j), domain.image(2, k)) == 0) continue;
          const Int3 at{i, j, k};
          for (int d = 0; d < 3; ++d) {
            begin[d] = std::min(begin[d], at[d]);
            end[d] = std::max(end[d], at[d] + 1);
          }
        }
  }
};

// Force and sums of surface tension on a block.
struct Result {
  Field force, slope;
  double sum[CapillaryForce::sums] = {};
  Real3 mean_force{};
  int outside = 0;  // faces that feel the force and are not in faces()
};

Result find(const OnGrid &grid, const Box &box, GhostExchange *exchange, const Phase &phase, const Field &velocity) {
  const int dim = box.dimension();
  Result result;
  result.force = Field(box, dim);
  result.slope = Field(box, dim);
  Field work(box, CapillaryForce::work_fields);
  for (int f = 0; f < work.count(); ++f) work.fill(f, nothing);
  CapillaryForce capillary(box, exchange);
  EXPECT_EQ(capillary.find(phase, work), 0);
  NetForce net(grid.domain, true);
  std::vector<ExactSums> sums(row_parts(box), ExactSums(CapillaryForce::sums));
  capillary.add_force(scale, result.force, {&result.slope, slope_factor}, &net);
  capillary.measure(velocity, 0, &sums);
  EXPECT_EQ(reduce_parts(PETSC_COMM_SELF, sums, result.sum), 0);
  EXPECT_EQ(net.compute_mean(&result.mean_force), 0);
  const auto is_held = [&](int i, int j, int k) {
    for (const Segment &s : capillary.faces().row(j, k))
      if (i >= s.i_begin && i < s.i_end) return true;
    return false;
  };
  for (int d = 0; d < dim; ++d)
    for_points(box.rows(),
               [&](int i, int j, int k) { result.outside += result.force[d](i, j, k) != 0 && !is_held(i, j, k); });
  return result;
}

Result find_in_box(const OnGrid &grid, const Box &box) {
  const int dim = box.dimension();
  Phase phase;
  phase.material = grid.phases[0].material;
  phase.fraction = Field(box, 1);
  Field velocity(box, dim);
  for (int d = 0; d < dim; ++d) velocity.fill(d, nothing);
  const ConstView phi = grid.phases[0].fraction[0];
  for_points(box.rows(), [&](int i, int j, int k) {
    const Int3 at = grid.image(box, i, j, k);
    phase.fraction[0](i, j, k) = phi(at[0], at[1], at[2]);
    for (int d = 0; d < dim; ++d) velocity[d](i, j, k) = grid.velocity[d](at[0], at[1], at[2]);
  });
  fill_wall_ghosts_even(box, at_centre, phase.fraction[0], CapillaryForce::phi_ghosts);
  phase.rows.find_in_box(box, std::as_const(phase).fraction[0], CapillaryForce::span_reach);
  return find(grid, box, nullptr, phase, velocity);
}

int count_faces(const Box &box, const Field &force) {
  int felt = 0;
  for (int d = 0; d < force.count(); ++d)
    for_points(box.rows(), [&](int i, int j, int k) { felt += force[d](i, j, k) != 0; });
  return felt;
}

int count_differences(const OnGrid &grid, const Box &box, const Field &on_grid, const Field &in_box) {
  int wrong = 0;
  for (int d = 0; d < in_box.count(); ++d)
    for_points(box.rows(), [&](int i, int j, int k) {
      const Int3 at = grid.image(box, i, j, k);
      wrong += !(in_box[d](i, j, k) == on_grid[d](at[0], at[1], at[2]));
    });
  return wrong;
}

class CapillaryForceInBox : public testing::TestWithParam<Case> {};

TEST_P(CapillaryForceInBox, HasTheBitsOfTheGrid) {
  OnGrid grid(GetParam());
  const Domain &domain = grid.domain;
  const Result expected = find(grid, domain, grid.exchange.get(), grid.phases[0], grid.velocity);
  const int felt = count_faces(domain, expected.force);
  EXPECT_GT(felt, domain.dimension() == 2 ? 30 : 200);
  EXPECT_EQ(expected.outside, 0);
  EXPECT_GT(expected.sum[CapillaryForce::area], 0);
  double magnitude = 0;
  for (int d = 0; d < domain.dimension(); ++d)
    for_points(domain.rows(), [&](int i, int j, int k) { magnitude += std::fabs(expected.force[d](i, j, k)); });
  Result narrow;
  for (const int margin : {CapillaryForce::reach, CapillaryForce::reach + 3, CapillaryForce::reach + 2})
    for (const bool all : {false, true}) {
      SCOPED_TRACE("margin " + std::to_string(margin) + (all ? ", everywhere" : ""));
      const Box box = grid.box(margin);
      set_skip_nothing(all);
      Result found = find_in_box(grid, box);
      set_skip_nothing(false);
      EXPECT_EQ(count_differences(grid, box, expected.force, found.force), 0);
      EXPECT_EQ(count_differences(grid, box, expected.slope, found.slope), 0);
      EXPECT_EQ(count_faces(box, found.force), felt);
      EXPECT_EQ(found.outside, 0);
      for (int s = 0; s < CapillaryForce::sums; ++s) {
        if (GetParam().crosses_x)
          EXPECT_NEAR(found.sum[s], expected.sum[s], 1e-13 * (s == CapillaryForce::area ? expected.sum[s] : magnitude));
        else
          EXPECT_EQ(found.sum[s], expected.sum[s]);
      }
      const double per_cell = magnitude / domain.domain_cell_count();
      for (int d = 0; d < 3; ++d) {
        if (GetParam().crosses_x)
          EXPECT_NEAR(found.mean_force[d], expected.mean_force[d], 1e-13 * per_cell);
        else
          EXPECT_EQ(found.mean_force[d], expected.mean_force[d]);
      }
      if (!narrow.force) {
        narrow = std::move(found);
        continue;
      }
      for (int s = 0; s < CapillaryForce::sums; ++s) EXPECT_EQ(narrow.sum[s], found.sum[s]);
      EXPECT_EQ(narrow.mean_force, found.mean_force);
    }
}

INSTANTIATE_TEST_SUITE_P(
    Drops, CapillaryForceInBox,
    testing::Values(
        Case{"inside", {44, 32, 30}, false, {0.61, 0.47, 0.43}, {0.3, 0.21, 0.17}},
        Case{"across_y_and_z", {44, 32, 30}, false, {0.57, 0.03, 0.88}, {0.3, 0.17, 0.21}},
        Case{"across_x", {44, 32, 30}, false, {0.02, 0.96, 0.5}, {0.27, 0.21, 0.17}, true},
        Case{"at_walls", {44, 32, 30}, true, {0.61, 0.13, 0.8}, {0.3, 0.21, 0.17}},
        Case{"thin", {44, 32, 30}, false, {0.6, 0.5, 0.43}, {0.3, 0.05, 0.2}},
        Case{"stepped", {44, 32, 30}, false, {0.6, 0.5, 0.43}, {0.3, 0.17, 0.2}, false, Case::stepped},
        Case{"rod", {44, 32, 30}, false, {0.6, 0.5, 0.43}, {0.3, 0.14, 0.2}, false, Case::rod},
        Case{"stepped_at_walls", {44, 32, 30}, true, {0.6, 0.1, 0.8}, {0.3, 0.17, 0.2}, false, Case::stepped},
        Case{"block_of_sums", {280, 30, 28}, false, {1.095, 0.5, 0.43}, {0.09, 0.3, 0.3}},
        Case{"flat_stepped", {52, 40, 1}, false, {0.63, 0.5, 0}, {0.3, 0.2, 0}, false, Case::stepped},
        Case{"flat", {52, 40, 1}, false, {0.63, 0.02, 0}, {0.3, 0.2, 0}},
        Case{"flat_across_x", {52, 40, 1}, false, {1.19, 0.5, 0}, {0.3, 0.2, 0}, true},
        Case{"flat_at_wall", {52, 40, 1}, true, {0.63, 0.9, 0}, {0.3, 0.2, 0}}),
    [](const auto &test) { return test.param.name; });

// The force that the solver adds for a phase is that of CapillaryForce less its mean.
TEST(SurfaceTension, AddsTheForcesOfItsPhases) {
  OnGrid grid({"drop", {40, 32, 1}, false, {0.61, 0.47, 0}, {0.3, 0.2, 0}});
  const Domain &domain = grid.domain;
  const Result one = find(grid, domain, grid.exchange.get(), grid.phases[0], grid.velocity);
  Flow flow(domain, {});
  ASSERT_EQ(flow.work.reserve(SurfaceTension::fields), 0);
  flow.now.velocity = std::move(grid.velocity);
  SurfaceTension tension(&flow);
  const SynchronisedBodies look{grid.phases, {}};
  SurfaceEnergy seen;
  ASSERT_EQ(tension.add_surface_energy(look, &seen, nullptr), 0);
  EXPECT_EQ(seen.energy, sigma * one.sum[CapillaryForce::area]);
  SurfaceEnergy both = seen;  // with that of others
  ASSERT_EQ(tension.add_surface_energy(look, &both, nullptr), 0);
  EXPECT_EQ(both.energy, 2 * seen.energy);
  EXPECT_EQ(both.power, 2 * seen.power);
  EXPECT_EQ(seen.power, one.sum[CapillaryForce::power] * domain.cell_volume());
  for (const bool balanced : {false, true}) {
    Field force(domain, 2);
    ASSERT_EQ(tension.add_force(grid.phases, scale, balanced, force), 0);
    int wrong = 0;
    for (int d = 0; d < 2; ++d)
      for_points(domain.rows(), [&](int i, int j, int k) {
        wrong += force[d](i, j, k) != one.force[d](i, j, k) - (balanced ? one.mean_force[d] : 0);
      });
    EXPECT_EQ(wrong, 0);
    EXPECT_NE(one.mean_force[0], 0);
  }
}

}  // namespace
