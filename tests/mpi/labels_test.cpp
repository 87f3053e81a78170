// Labels follow their bodies, on any number of ranks.
#include "bodies/labels.hpp"
#include "base/rank_zero.hpp"
#include "field/ghost_exchange.hpp"
#include "support/body_scene.hpp"

using namespace eulastic;
using namespace eulastic::test;

TEST(Labels, FollowTwoCloseBodiesAroundTheBox) {
  // Radius 4 cells, 3 cells between the surfaces, half a cell a call, twice around x.
  for (int layers : {1, 14}) {
    const GridSpec spec = box({28, 15, layers}, {28, 15, double(layers)});
    const SpeciesSpec sphere = species(Shape::sphere, 4);
    BodyScene scene(run_communicator(), spec);
    const auto places_at = [&](int n) {
      const double z = layers / 2.0;
      return std::vector<BodyPlace>{{{wrap(5 + 0.5 * n, 28), wrap(6 + 0.25 * n, 15), z}, {}},
                                    {{wrap(16 + 0.5 * n, 28), wrap(6 + 0.25 * n, 15), z}, {}}};
    };
    scene.add(sphere, places_at(0));
    GhostExchange exchange(scene.domain);
    for (int n = 1; n <= 112; ++n) {
      Phase fresh;
      ASSERT_EQ(fill_phase(scene.domain, sphere, places_at(n), 1, &fresh), 0);
      scene.move(sphere, places_at(n));
      ASSERT_EQ(carry_labels(scene.domain, exchange, &scene.phases[0]), 0);
      const ConstView expected = std::as_const(fresh.label)[0], label = std::as_const(scene.phases[0].label)[0];
      int wrong = 0;
      for (const Segment &row : scene.domain.rows())
        for (int i = row.i_begin; i < row.i_end; ++i) {
          const bool solid = fresh.fraction[0](i, row.j, row.k) > label_threshold;
          wrong += label(i, row.j, row.k) != (solid ? expected(i, row.j, row.k) : 0);
        }
      EXPECT_EQ(wrong, 0) << n;
    }
  }
}

TEST(Labels, ABodyOfLessThanACellKeepsItsNameWhenItLeavesItsCell) {
  // All of phi in one cell, .11, that is the next one at every call, all around the box along y.
  const int n = 12;
  BodyScene scene(run_communicator(), box({6, n, 1}, {6, double(n), 1}));
  scene.add(species(Shape::sphere, 0.4), {{{2.5, 0.5, 0.5}, {}}});
  GhostExchange exchange(scene.domain);
  Phase &phase = scene.phases[0];
  const int first = scene.domain.layout().begin[1];
  for (int place = 1; place <= n; ++place) {
    for (const Segment &row : scene.domain.rows())
      for (int i = row.i_begin; i < row.i_end; ++i)
        phase.fraction[0](i, row.j, 0) =
            scene.domain.layout().begin[0] + i == 2 && first + row.j == place % n ? .11 : 0;
    ASSERT_EQ(phase.rows.find(scene.domain, phase.fraction[0]), 0);
    ASSERT_EQ(carry_labels(scene.domain, exchange, &phase), 0);
    int wrong = 0;
    for (const Segment &row : scene.domain.rows())
      for (int i = row.i_begin; i < row.i_end; ++i)
        wrong += phase.label[0](i, row.j, 0) != (phase.fraction[0](i, row.j, 0) > 0 ? 1 : 0);
    EXPECT_EQ(wrong, 0) << place;
  }
}

TEST(Labels, SmearedBodiesDoNotLeaveTheirLabelsBehind) {
  // phi > 1e-6 everywhere between the bodies, as after a diffusive transport: the border must move with them.
  const int nx = 30, ny = 13, nz = 12;
  const auto phi_of = [&](double centre, const Int3 &cell) {
    const double x = std::remainder(cell[0] + 0.5 - centre, nx), y = cell[1] + 0.5 - 6.5, z = cell[2] + 0.5 - 6;
    return 0.5 * (1 - std::tanh(std::sqrt(x * x + y * y + z * z) - 4));
  };
  const MPI_Comm comms[2] = {run_communicator(), PETSC_COMM_SELF};
  BodyScene world(comms[0], box({nx, ny, nz}, {30, 13, 12})), alone(comms[1], box({nx, ny, nz}, {30, 13, 12}));
  for (BodyScene *scene : {&world, &alone}) {
    scene->add(species(Shape::sphere, 4), {{{5, 6.5, 6}, {}}, {{16, 6.5, 6}, {}}});
    GhostExchange exchange(scene->domain);
    for (int n = 1; n <= 150; ++n) {
      const double first = 5 + 0.4 * n, second = 16 + 0.4 * n;
      Phase &phase = scene->phases[0];
      const Layout &layout = scene->domain.layout();
      const auto global = [&](int i, const Segment &row) {
        return Int3{layout.begin[0] + i, layout.begin[1] + row.j, layout.begin[2] + row.k};
      };
      for (const Segment &row : scene->domain.rows())
        for (int i = row.i_begin; i < row.i_end; ++i)
          phase.fraction[0](i, row.j, row.k) = phi_of(first, global(i, row)) + phi_of(second, global(i, row));
      ASSERT_EQ(carry_labels(scene->domain, exchange, &phase), 0);
      int wrong = 0;
      for (const Segment &row : scene->domain.rows())
        for (int i = row.i_begin; i < row.i_end; ++i) {
          const double a = phi_of(first, global(i, row)), b = phi_of(second, global(i, row));
          wrong += a + b > 0.2 && phase.label[0](i, row.j, row.k) != (a > b ? 1 : 2);
        }
      EXPECT_EQ(wrong, 0) << n;
    }
  }
  const Layout &layout = world.domain.layout();
  for (const Segment &row : world.domain.rows())
    for (int i = row.i_begin; i < row.i_end; ++i)
      ASSERT_EQ(world.phases[0].label[0](i, row.j, row.k),
                alone.phases[0].label[0](layout.begin[0] + i, layout.begin[1] + row.j, layout.begin[2] + row.k));
}

TEST(Labels, NewCellsAloneAreNamedAndOldOnesStay) {
  // Half a cell onwards: those that the surface has reached, and no others.
  const GridSpec spec = box({28, 15, 14}, {28, 15, 14});
  const SpeciesSpec sphere = species(Shape::sphere, 4);
  BodyScene scene(run_communicator(), spec);
  const auto places_at = [](double shift) {
    return std::vector<BodyPlace>{{{5 + shift, 7, 7}, {}}, {{wrap(17 + shift, 28), 7, 7}, {}}};
  };
  scene.add(sphere, places_at(0));
  Phase before;
  before.copy_from(scene.phases[0]);
  GhostExchange exchange(scene.domain);
  scene.move(sphere, places_at(0.5));
  ASSERT_EQ(label_new_cells(scene.domain, exchange, &scene.phases[0]), 0);
  Phase fresh;
  ASSERT_EQ(fill_phase(scene.domain, sphere, places_at(0.5), 1, &fresh), 0);
  const ConstView old = std::as_const(before.label)[0], label = std::as_const(scene.phases[0].label)[0],
                  expected = std::as_const(fresh.label)[0], phi = std::as_const(fresh.fraction)[0];
  long counts[2] = {0, 0};  // named anew, wrong
  for (const Segment &row : scene.domain.rows())
    for (int i = row.i_begin; i < row.i_end; ++i) {
      const bool is_new = old(i, row.j, row.k) == 0 && phi(i, row.j, row.k) > label_threshold;
      counts[0] += is_new;
      counts[1] += label(i, row.j, row.k) != (is_new ? expected(i, row.j, row.k) : old(i, row.j, row.k));
    }
  MPI_Allreduce(MPI_IN_PLACE, counts, 2, MPI_LONG, MPI_SUM, run_communicator());
  EXPECT_GT(counts[0], 20);
  EXPECT_EQ(counts[1], 0);
}
