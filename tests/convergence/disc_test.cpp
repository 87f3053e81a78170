// The moving disc: options/disc_in_channel.opts with the strong force, fast method, dt = 6.4/N (docs/method.md, 12).
#include "solver/synchronised_state.hpp"
#include "support/scene.hpp"

#include "bodies/fill_phase.hpp"
#include "diagnostics/energy_rates.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

// Every ten time units to t = 150.
struct History {
  std::vector<double> x, y, deformation, bulk_velocity;
  double drift = 0;  // largest relative change of the volume
};

double mean(const Domain &domain, ConstView view) {
  double sum = 0;
  for_points(domain, view, at_face[0], [&](const double &q, double, double, double) { sum += q; });
  return sum / (domain.domain_cells()[0] * domain.domain_cells()[1]);
}

History strong_disc(int cells, PressureKind pressure) {
  Scene scene;
  GridSpec grid;
  grid.cells = {cells, cells, 1};
  grid.length = {21.12, 21.12, 1};
  grid.boundary[1] = Boundary::wall;
  SolverSpec spec;
  static_cast<Method &>(spec) = method_preset(MethodKind::fast);
  spec.pressure = pressure;
  spec.fluid.body_force.force = {4e-3, 0, 0};
  EXPECT_EQ(scene.create(PETSC_COMM_SELF, grid, spec), 0);
  SpeciesSpec disc;
  disc.radius = 4;
  disc.shear_modulus = 0.02;
  const std::vector<BodyPlace> places{{{10.56, 7.392, 0}, {}}};
  Phase phase;
  EXPECT_EQ(fill_phase(scene.domain, disc, places, 1, &phase), 0);
  Solver &solver = scene.solver;
  solver.state().phases.push_back(std::move(phase));
  solver.bodies().add_phase(scene.domain, places);
  EXPECT_EQ(solver.prepare(), 0);
  History history;
  double volume = 0;
  const int steps = 375 * cells / 16;  // fifteen times a whole number
  for (int n = 0; n <= 15; ++n) {
    if (n > 0) {
      EXPECT_EQ(scene.run(10 * n, steps / 15), 0);
    }
    const std::vector<Phase> *phases = nullptr;
    std::vector<BodyMeasure> bodies;
    EXPECT_EQ(solver.synchronised().phases(&phases), 0);
    EXPECT_EQ(solver.bodies().measure(scene.domain, *phases, solver.state().velocity, strain_energy, &bodies), 0);
    if (n == 0) volume = bodies[0].volume;
    history.drift = std::max(history.drift, std::fabs(bodies[0].volume / volume - 1));
    history.x.push_back(bodies[0].centroid[0]);
    history.y.push_back(bodies[0].centroid[1]);
    history.deformation.push_back(bodies[0].taylor_deformation);
    history.bulk_velocity.push_back(mean(scene.domain, solver.state().velocity[0]));
  }
  return history;
}

// Root mean square over the history; what hangs on where the surface lies in its cells averages out.
double distance(const std::vector<double> &a, const std::vector<double> &b) {
  double sum = 0;
  for (std::size_t n = 0; n < a.size(); ++n) sum += (a[n] - b[n]) * (a[n] - b[n]);
  return std::sqrt(sum / double(a.size()));
}

TEST(StrongDisc, ConvergesAndKeepsItsVolume) {
  const History h[3] = {strong_disc(48, PressureKind::smac), strong_disc(96, PressureKind::smac),
                        strong_disc(192, PressureKind::smac)};
  const auto observed = [&](const char *name, std::vector<double> History::*q) {
    const double e[2] = {distance(h[0].*q, h[1].*q), distance(h[1].*q, h[2].*q)};
    std::printf("  disc, %s at t = 150: %.7f %.7f %.7f, order over the history %.2f\n", name, (h[0].*q).back(),
                (h[1].*q).back(), (h[2].*q).back(), order(e[0], e[1]));
    return std::array<double, 2>{e[0], e[1]};
  };
  const auto x = observed("x", &History::x), y = observed("y", &History::y);
  const auto D = observed("deformation", &History::deformation), u = observed("bulk velocity", &History::bulk_velocity);
  const double centroid = order(std::hypot(x[0], y[0]), std::hypot(x[1], y[1]));
  std::printf("  disc, centroid: order %.2f\n", centroid);
  EXPECT_GT(centroid, 1.7);
  EXPECT_GT(order(D[0], D[1]), 1.5);
  EXPECT_LT(D[1], 1e-3);
  EXPECT_GT(order(u[0], u[1]), 1.7);
  for (const History &each : h) EXPECT_LT(each.drift, 1e-10);
}

TEST(StrongDisc, IsAccurateWithAcm) {  // limits of fine grids: bulk velocity, deformation, y
  const History h = strong_disc(64, PressureKind::acm);
  std::printf("  disc, ACM: bulk velocity %.7f, deformation %.6f, y %.5f, volume %.1e\n", h.bulk_velocity.back(),
              h.deformation.back(), h.y.back(), h.drift);
  EXPECT_NEAR(h.bulk_velocity.back(), .13835, 5e-4 * .13835);
  EXPECT_NEAR(h.deformation.back(), .3858, 7e-3 * .3858);
  EXPECT_NEAR(h.y.back(), 7.456, 0.01);
  EXPECT_LT(h.drift, 1e-4);
}

}  // namespace
