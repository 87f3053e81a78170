// Measures of bodies: right values, and the same bits on any number of ranks.
#include "base/rank_zero.hpp"
#include "bodies/labels.hpp"
#include "diagnostics/flow_measures.hpp"
#include "field/boundaries.hpp"
#include "support/body_scene.hpp"

using namespace eulastic;
using namespace eulastic::test;

namespace {

constexpr double pi = 3.14159265358979323846;

}  // namespace

TEST(BodyMeasures, SameBitsOnAnyRanks) {
  for (const Int3 &cells : {Int3{21, 26, 31}, Int3{33, 30, 1}}) {
    GridSpec spec = box(cells, {2.1, 2.6, 3.1});
    spec.boundary[1] = Boundary::wall;
    std::vector<BodyMeasure> all[2];
    const MPI_Comm comms[2] = {run_communicator(), PETSC_COMM_SELF};
    for (int c = 0; c < 2; ++c) {
      BodyScene scene(comms[c], spec);
      const bool flat = cells[2] == 1;
      scene.add(species(Shape::ellipsoid, 0, {0.7, 0.4, 0.5}, flat ? Real3{0, 0, 25} : Real3{15, 30, 25}),
                {{{0.1, 1.3, 0.05}, flat ? Real3{0, 0, 25} : Real3{15, 30, 25}}, {{1.2, 0.6, 1.6}, {}}});
      scene.add(species(Shape::biconcave, 0.5), {{{1.0, 2.0, 3.0}, {}}});
      scene.set_velocity([](int d, const Real3 &x) { return std::sin(3 * x[0] + d) * std::cos(2 * x[1] - x[2]); });
      scene.phases[0].material.shear_modulus = 0.7;
      scene.phases[1].material.shear_modulus = 30;
      scene.strain();
      all[c] = scene.measure();
      FlowMeasures flow;
      ASSERT_EQ(measure_phases(scene.domain, scene.phases, &flow), 0);
      double energy = 0;
      for (const BodyMeasure &body : all[c]) energy += body.elastic_energy;
      EXPECT_GT(std::abs(energy), 1e-3);
      EXPECT_NEAR(energy, flow.elastic_energy, 1e-12 * std::abs(energy));
    }
    ASSERT_EQ(all[0].size(), 3u);
    EXPECT_EQ(all[0][2].species, 1);
    for (int b = 0; b < 3; ++b) {
      const BodyMeasure &many = all[0][b], &one = all[1][b];
      EXPECT_EQ(many.label, b + 1);
      EXPECT_GT(many.volume, 0.01);
      EXPECT_EQ(many.volume, one.volume);
      EXPECT_EQ(many.centroid, one.centroid);
      EXPECT_EQ(many.velocity, one.velocity);
      EXPECT_EQ(many.semi_axes, one.semi_axes);
      EXPECT_EQ(many.taylor_deformation, one.taylor_deformation);
      EXPECT_EQ(many.inclination, one.inclination);
      EXPECT_NE(many.elastic_energy, 0);
      EXPECT_EQ(many.elastic_energy, one.elastic_energy);
      EXPECT_GT(many.trace_max, 3.3);
      EXPECT_EQ(many.trace_max, one.trace_max);
      EXPECT_EQ(many.rest_deformation, one.rest_deformation);
    }
  }
}

TEST(BodyMeasures, EllipsoidsHaveTheirAxesAcrossSeams) {
  // Turned about z alone, so that the moments in the xy plane show the angle itself.
  for (double angle : {-62.0, 30.0, 90.0}) {
    const GridSpec full = box({36, 40, 44}, {3.6, 4.0, 4.4}), flat = box({72, 80, 1}, {3.6, 4.0, 1});
    for (const GridSpec &spec : {full, flat}) {
      const bool is_flat = spec.cells[2] == 1;
      BodyScene scene(run_communicator(), spec);
      const Real3 centre{0.123, 3.9, is_flat ? 0.5 : 0.05};
      scene.add(species(Shape::ellipsoid, 0, {1.2, 0.7, 0.9}), {{centre, {0, 0, angle}}});
      scene.set_velocity([](int d, const Real3 &) { return 0.3 - 0.7 * d; });
      const BodyMeasure body = scene.measure()[0];
      const double volume = is_flat ? pi * 1.2 * 0.7 : 4 * pi / 3 * 1.2 * 0.7 * 0.9;
      EXPECT_NEAR(body.volume, volume, 2e-6 * volume);
      EXPECT_NEAR(body.semi_axes[0], 1.2, 5e-4);
      EXPECT_NEAR(body.semi_axes[1], is_flat ? 0.7 : 0.9, 5e-4);
      EXPECT_NEAR(body.semi_axes[2], is_flat ? 0.0 : 0.7, 5e-4);
      EXPECT_NEAR(body.taylor_deformation, 0.5 / 1.9, 3e-4);
      EXPECT_NEAR(std::remainder(body.inclination - angle, 180), 0, 0.02);
      EXPECT_GT(body.inclination, -90);
      EXPECT_LE(body.inclination, 90);
      for (int d = 0; d < 3; ++d) {
        EXPECT_NEAR(body.centroid[d], centre[d], 3e-4);
        EXPECT_NEAR(body.velocity[d], is_flat && d == 2 ? 0 : 0.3 - 0.7 * d, 1e-14);
      }
    }
  }
}

// B = diag(l^2) everywhere inside: W = G/2 (tr B - 3), per body of its own species.
TEST(BodyMeasures, StretchedBodiesHaveTheirEnergy) {
  for (const bool flat : {false, true}) {
    BodyScene scene(run_communicator(), box({24, 24, flat ? 1 : 24}, {1, 1, 1}));
    double trace[2];
    for (int s = 0; s < 2; ++s) {
      SpeciesSpec spec = species(Shape::sphere, 0.15);
      const double stretch = s ? 1.5 : 1.2;
      spec.initial_stretch = {stretch, flat ? 1 / stretch : 1, flat ? 1 : 1 / stretch};
      spec.shear_modulus = 1 + 3 * s;
      trace[s] = stretch * stretch + 1 / (stretch * stretch) + 1;
      scene.add(spec, {{{0.25 + 0.5 * s, 0.5, 0.5}, {}}});
    }
    scene.set_velocity([](int, const Real3 &) { return 0.0; });
    const std::vector<BodyMeasure> bodies = scene.measure();
    for (int s = 0; s < 2; ++s) {
      EXPECT_NEAR(bodies[s].elastic_energy, (1 + 3 * s) / 2.0 * (trace[s] - 3) * bodies[s].volume, 1e-13);
      EXPECT_NEAR(bodies[s].trace_max, trace[s], 1e-14);
    }
  }
}

// An ellipsoid of semi-axes l a is what B = diag(l^2), turned with it, makes of one of semi-axes a.
TEST(BodyMeasures, StretchUndoneGivesTheShapeAtRest) {
  for (const bool flat : {false, true}) {
    const Real3 stretch{1.6, flat ? 1 / 1.6 : .8, flat ? 1 : 1 / (1.6 * .8)},
        turned{flat ? 0. : 20, flat ? 0. : -35, 70};
    for (const double longer : {1., 1.3}) {  // a sphere, or an ellipsoid at rest
      SpeciesSpec spec =
          species(Shape::ellipsoid, 0, {.25 * longer * stretch[0], .25 * stretch[1], .25 * stretch[2]}, turned);
      spec.initial_stretch = stretch;
      spec.shear_modulus = 1;
      BodyScene scene(run_communicator(), box({48, 48, flat ? 1 : 48}, {1, 1, 1}));
      scene.add(spec, {{{.1, .5, .5}, turned}});
      GhostExchange exchange(scene.domain);
      ASSERT_EQ(exchange.update_ghosts(scene.phases[0].tensor.field, 1), 0);
      const BodyMeasure body = scene.measure()[0];
      EXPECT_GT(body.taylor_deformation, .3);
      EXPECT_NEAR(body.rest_deformation, (longer - 1) / (longer + 1), 1e-3);
      scene.phases[0].tensor.field = undeformed_tensor(scene.domain);  // without the stretch it is the shape's
      EXPECT_NEAR(scene.measure()[0].rest_deformation, body.taylor_deformation, 1e-14);
    }
  }
}

TEST(BodyMeasures, RedCellHasItsSecondMoments) {
  // <z^2> and <x^2> of h(r) by quadrature, as semi-axes sqrt(5 <.>).
  double volume = 0, along = 0, across = 0;
  constexpr int n = 200000;
  for (int s = 0; s < n; ++s) {
    const double r = (s + 0.5) / n, q = r * r;
    const double h = std::sqrt(1 - q) * (0.207161 + 2.002558 * q - 1.122762 * q * q);
    volume += 2 * pi * r * h / n;
    along += 2 * pi * r * h * h * h / 12 / n;
    across += pi * r * r * r * h / n;
  }
  BodyScene scene(run_communicator(), box({44, 44, 44}, {2.4, 2.4, 2.4}));
  scene.add(species(Shape::biconcave, 1), {{{0.03, 1.2, 1.25}, {20, 0, 35}}});
  const BodyMeasure body = scene.measure()[0];
  const double a = std::sqrt(5 * across / volume), c = std::sqrt(5 * along / volume);
  EXPECT_NEAR(body.semi_axes[0], a, 3e-4);
  EXPECT_NEAR(body.semi_axes[1], a, 3e-4);
  EXPECT_NEAR(body.semi_axes[2], c, 1e-3);
  EXPECT_NEAR(body.taylor_deformation, (a - c) / (a + c), 2e-3);
}

TEST(BodyMeasures, FollowAcrossSeamsWhateverTheInterval) {
  const GridSpec spec = box({20, 18, 16}, {2.0, 1.8, 1.6});
  const SpeciesSpec sphere = species(Shape::sphere, 0.4);
  BodyScene scene(run_communicator(), spec), silent(run_communicator(), spec);
  const Real3 start{1.9, 0.05, 0.8}, step{0.05, -0.03, 0.04};
  for (BodyScene *s : {&scene, &silent}) s->add(sphere, {{start, {}}});
  GhostExchange exchange(scene.domain);
  for (int n = 1; n <= 100; ++n) {
    Real3 centre{};
    for (int d = 0; d < 3; ++d) centre[d] = wrap(start[d] + n * step[d], spec.length[d]);
    for (BodyScene *s : {&scene, &silent}) {
      s->move(sphere, {{centre, {}}});
      ASSERT_EQ(carry_labels(s->domain, exchange, &s->phases[0]), 0);
      ASSERT_EQ(s->tracker.follow(s->domain, s->phases), 0);
    }
    const BodyMeasure body = scene.measure()[0];
    for (int d = 0; d < 3; ++d) ASSERT_NEAR(body.centroid[d], start[d] + n * step[d], 2e-3) << n;
    ASSERT_NEAR(body.volume, shape_volume(sphere, 3), 1e-5);
  }
  std::vector<Int3> references, others;
  std::vector<double> volumes;
  ASSERT_EQ(scene.tracker.known(scene.domain, &references, &volumes), 0);
  ASSERT_EQ(silent.tracker.known(silent.domain, &others, &volumes), 0);
  EXPECT_EQ(references, others);
  references.resize(1);
  ASSERT_EQ(MPI_Bcast(references[0].data(), 3, MPI_INT, 0, run_communicator()), 0);
  EXPECT_EQ(scene.measure()[0].centroid, silent.measure()[0].centroid);
  // A restart: a new tracker with the carried references measures the same.
  const BodyMeasure last = scene.measure()[0];
  scene.tracker = BodyTracker();
  scene.tracker.add_phase(scene.domain, {{start, {}}});
  scene.tracker.set_known(references, {});
  EXPECT_EQ(scene.measure()[0].centroid, last.centroid);
}

TEST(BodyMeasures, SlabsThatFillTheBoxStay) {
  SpeciesSpec slab = species(Shape::slab, 0);
  slab.interval = {0.2, 0.5};
  BodyScene scene(run_communicator(), box({12, 10, 7}, {1.2, 1.0, 0.7}));
  Places places;
  ASSERT_EQ(place_bodies(slab, scene.domain.domain_shape(), &places), "");
  scene.add(slab, places);
  for (int n = 0; n < 5; ++n) ASSERT_EQ(scene.tracker.follow(scene.domain, scene.phases), 0);
  const BodyMeasure body = scene.measure()[0];
  EXPECT_NEAR(body.volume, 0.3 * 1.2 * 0.7, 1e-14);
  EXPECT_NEAR(body.centroid[0], 0.6, 1e-13);
  EXPECT_NEAR(body.centroid[1], 0.35, 1e-13);
  EXPECT_NEAR(body.centroid[2], 0.35, 1e-13);
}
