// FreeBodies: bodies in boxes of their own have the bits of the same bodies on the grid, whoever owns them.
#include "boxes/free_bodies.hpp"
#include "base/rank_zero.hpp"
#include "membranes/membrane_transport.hpp"
#include "solids/elastic_force.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <set>

using namespace eulastic;
using namespace eulastic::test;

namespace {

struct Ball {
  Real3 centre;
  double radius;
};

struct Place {
  Int3 cells;
  Ball ball;
  int split_x;            ///< ranks along x, 0: as the program chooses
  bool membrane = false;  ///< that bends, beside walls a film
};

// The body crosses the periodic sides, presses against the wall in y, or lies free; in 2-D and 3-D. Places at rest of
// markers are rounded differently where cells are wrapped: membranes do not cross periodic sides.
const std::vector<Place> places{
    {{40, 32, 1}, {{0.05, 0.5, 0}, 0.2}, 0},       {{40, 32, 1}, {{0.6, 0.19, 0}, 0.17}, 0},
    {{32, 28, 30}, {{0.98, 0.45, 0.02}, 0.17}, 0}, {{32, 28, 30}, {{0.5, 0.8, 0.4}, 0.17}, -1},
    {{40, 32, 1}, {{0.6, 0.5, 0}, 0.2}, 0, true},  {{24, 22, 20}, {{0.6, 0.78, 0.4}, 0.17}, 0, true}};

class FreeBodiesTest : public ::testing::TestWithParam<std::size_t> {
protected:
  // A stirred channel with one soft ball, by the fast method.
  void SetUp() override {
    scene = std::make_unique<Scene>();
    const Place &place = places[GetParam()];
    GridSpec grid;
    grid.cells = place.cells;
    grid.length = {1.2, 1, 0.9};
    grid.boundary[1] = Boundary::wall;
    if (place.split_x < 0) MPI_Comm_size(run_communicator(), &grid.processors[0]);
    SolverSpec spec;
    static_cast<Method &>(spec) = method_preset(MethodKind::fast);
    spec.sides[1][1].motion.velocity = {3, 0, 1};
    spec.fluid.density = 0.8;
    spec.fluid.viscosity = 0.05;
    spec.fluid.body_force.force = {8, 3, 0};
    ASSERT_EQ(scene->create(run_communicator(), grid, spec), 0);
    const double h = scene->domain.spacing()[1];
    const auto fraction = [this, h](double x, double y, double z) {
      const Ball &ball = places[GetParam()].ball;
      const auto periodic = [](double d, double length) { return d - length * std::round(d / length); };
      const double dz = scene->domain.dimension() == 2 ? 0 : periodic(z - ball.centre[2], 0.9);
      const double r = std::hypot(periodic(x - ball.centre[0], 1.2), y - ball.centre[1], dz);
      return std::min(1.0, std::max(0.0, 0.5 - (r - ball.radius) / h));
    };
    Phase &added = scene->add_phase(2, fraction);
    if (place.membrane) {
      added.material.law = Law::membrane;
      added.material.shear_modulus = 0;
      added.material.membrane = {kernels::MembraneLaw::skalak, 0.2, 1.5, 1.1, 0.001, 0.5};
      added.tensor.centred = true;
    }
    ASSERT_EQ(scene->solver.prepare(), 0);
  }
  Phase &phase() { return scene->solver.state().phases[0]; }

  // A box around the ball as it is placed, cut at walls.
  Box box_of_ball() const {
    const Ball &ball = places[GetParam()].ball;
    Int3 begin{}, cells{1, 1, 1};
    for (int d = 0; d < scene->domain.dimension(); ++d) {
      const double h = scene->domain.spacing()[d];
      begin[d] = static_cast<int>(std::floor((ball.centre[d] - ball.radius) / h)) - 2;
      int end = static_cast<int>(std::ceil((ball.centre[d] + ball.radius) / h)) + 2;
      if (scene->domain.is_wall(d)) {
        begin[d] = std::max(begin[d], 0);
        end = std::min(end, scene->domain.domain_cells()[d]);
      }
      cells[d] = end - begin[d];
    }
    return Box(scene->domain.domain_shape(), begin, cells, scene->domain.spec().ghosts);
  }
  // phi and B of the grid's phase in the box of a body, if this rank has one. Collective.
  void bring_phase(const FreeBodies::Body *body, Field *fraction, Field *tensor) {
    const auto bring = [&](const Field &from, Field *to) {
      BoxExchange exchange(scene->domain, from.count());
      std::vector<BoxExchange::NumberedBox> boxes;
      if (body) boxes.push_back({&body->box, 1});
      ASSERT_EQ(exchange.connect(boxes), 0);
      ASSERT_EQ(exchange.fetch(from), 0);
      if (!body) return;
      *to = Field(body->box, from.count());
      exchange.copy_to_box(0, from, *to);
    };
    bring(phase().fraction, fraction);
    bring(phase().tensor.field, tensor);
  }
  // Values that differ at points of a box, ghosts excluded.
  static int differences(const Box &box, const Field &a, const Field &b,
                         const std::vector<TensorComponent> *components) {
    int wrong = 0;
    for (int f = 0; f < a.count(); ++f) {
      const Staggering at = components ? (*components)[f].at : at_centre;
      for (int k = 0; k < box.points_end(2, at[2]); ++k)
        for (int j = 0; j < box.points_end(1, at[1]); ++j)
          for (int i = 0; i < box.points_end(0, at[0]); ++i) wrong += a[f](i, j, k) != b[f](i, j, k);
    }
    return wrong;
  }

  // Of the phases of the grid, per mass.
  PetscErrorCode find_force_on_grid(Field *force) {
    PetscFunctionBeginUser;
    Solver &solver = scene->solver;
    const double scale = 1 / solver.spec().fluid.density;
    if (places[GetParam()].membrane) {
      MembraneTransport membranes(&solver.flow());
      PetscCall(membranes.find_walls({}));
      PetscCall(membranes.add_force(solver.state().phases, scale, false, *force));
    } else {
      PetscCall(compute_elastic_force(scene->domain, scale, solver.state().phases, *force));
    }
    PetscFunctionReturn(0);
  }

  std::unique_ptr<Scene> scene;
};

TEST_P(FreeBodiesTest, HaveTheBitsOfBodiesOnTheGrid) {
  const int ranks = scene->domain.ranks();
  for (const int owner : std::set<int>{0, ranks - 1}) {
    SetUp();
    const Place &place = places[GetParam()];
    const Domain &domain = scene->domain;
    const Solver &solver = scene->solver;
    FreeBodies solids(domain, solver.spec().fluid, solver.spec().sides);
    {
      const FreeBodies::Body placed{1, 0, box_of_ball(), {}, {}};
      Phase one;
      one.material = phase().material;
      one.tensor.rule = phase().tensor.rule;
      one.tensor.centred = phase().tensor.centred;
      bring_phase(domain.rank() == owner ? &placed : nullptr, &one.fraction, &one.tensor.field);
      if (domain.rank() == owner) {
        ASSERT_EQ(solids.add(1, 0, placed.box, std::move(one)), 0);
      }
    }
    if (place.membrane) solids.set_surroundings(false, {});
    ASSERT_EQ(solids.place_markers(), 0);
    ASSERT_EQ(solids.follow(), 0);
    const int steps = place.membrane && domain.dimension() == 2 ? 120 : 60;
    Int3 first_box{};
    int moved = 0;
    for (int step = 0; step < steps; ++step) {
      FlowExtremes extremes;
      ASSERT_EQ(scene->solver.measure(&extremes), 0);
      const double dt = scene->solver.limits(extremes).automatic();
      const State &state = scene->solver.state();
      long unresolved = 0;
      ASSERT_EQ(solids.advance({state.time, 0.5 * (state.dt + dt), state.step}, state.velocity, &unresolved), 0);
      ASSERT_EQ(scene->solver.step(dt), 0);
      if (step % 5 != 4) continue;
      Field fraction, tensor, rate(domain, domain.dimension()), expected(domain, domain.dimension());
      const FreeBodies::Body *body = solids.bodies().empty() ? nullptr : &solids.bodies()[0];
      EXPECT_EQ(body != nullptr, domain.rank() == owner);
      bring_phase(body, &fraction, &tensor);
      if (body) {
        EXPECT_EQ(differences(body->box, body->phase.fraction, fraction, nullptr), 0) << "step " << step;
        EXPECT_EQ(differences(body->box, body->phase.tensor.field, tensor, &body->phase.tensor.components()), 0)
            << "step " << step;
        if (step == 4) first_box = body->box.layout().begin;
        moved += body->box.layout().begin != first_box;
      }
      ASSERT_EQ(solids.add_forces({{&rate, 1}}), 0);
      ASSERT_EQ(find_force_on_grid(&expected), 0);
      int wrong = 0, forced = 0;
      for (int a = 0; a < domain.dimension(); ++a)
        for (const Segment &row : domain.rows())
          for (int i = row.i_begin; i < row.i_end; ++i) {
            wrong += rate[a](i, row.j, row.k) != expected[a](i, row.j, row.k);
            forced += expected[a](i, row.j, row.k) != 0;
          }
      EXPECT_EQ(wrong, 0) << "force, step " << step;
      if (domain.ranks() == 1) {
        EXPECT_GT(forced, 100);
      }
    }
    if (domain.rank() == owner) {
      EXPECT_GT(moved, 0);  // the box has followed the body
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Setups, FreeBodiesTest, ::testing::Range(std::size_t{0}, places.size()));

}  // namespace
