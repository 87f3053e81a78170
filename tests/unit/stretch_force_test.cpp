// -NAME_stretch_force: opposite forces on the two ends of a body, wherever it lies.
#include "bodies/stretch_force.hpp"
#include "physics/membrane.hpp"
#include "support/interface_scene.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

constexpr int cells = 40;
constexpr double radius = 0.33, force = 0.7, part = 0.05;

// A ball or disc whose centre has this x, in a periodic box, and the forces on its surface.
struct Pulled : InterfaceScene {
  std::vector<Phase> phases{1};
  std::unique_ptr<GhostExchange> exchange;
  std::vector<SurfaceSample> samples;
  std::vector<double> forces;
  int dim;
  Real3 centre;

  Pulled(int dimension, double x) : dim(dimension), centre{x, 0.493, dimension == 2 ? 0 : 0.505} {
    GridSpec spec;
    spec.cells = {cells, cells, dim == 2 ? 1 : cells};
    spec.length = {1, 1, dim == 2 ? 1. / cells : 1};
    spec.ghosts = 5;
    EXPECT_EQ(create(PETSC_COMM_SELF, spec), 0);
    set_fraction(ball(centre, radius, dim, true));
    exchange = std::make_unique<GhostExchange>(grid);
    Phase &phase = phases[0];
    phase.fraction = std::move(fraction);
    phase.tensor = tensor_at_rest(grid);
    phase.label = FieldBlock(grid, 1);
    phase.material.law = Law::membrane;
    phase.material.stretch_force = {force, part};
    each_owned([&](int i, int j, int k) { phase.label[0](i, j, k) = phase.fraction[0](i, j, k) > 1e-12; });
    EXPECT_EQ(exchange->update(phase.fraction, 5), 0);
    EXPECT_EQ(phase.rows.find(grid, phase.fraction[0]), 0);
    WorkSpace work(grid);
    EXPECT_EQ(work.reserve(MembraneTransport::work_fields), 0);
    MembraneTransport membrane(grid, *exchange, work, false);
    EXPECT_EQ(membrane.find_stretched(phases, &samples), 0);
    EXPECT_EQ(find_stretch_forces(grid, samples, {{int(x * cells) - cells, 19, 0}}, &forces), 0);
  }
  /// From the centre.
  double x_of(const SurfaceSample &s) const {
    const double x = position(s.place, {true, true, true})[0] + s.surface_x / cells - centre[0];
    return x - std::round(x);
  }
};

TEST(StretchForce, PullsThatPartOfTheSurfaceAtEitherEnd) {
  for (const int dim : {2, 3})
    for (const double x : {0.51, 0.03}) {
      const Pulled body(dim, x);
      const double volume = body.grid.cell_volume();
      double sum[2] = {}, place[2] = {}, largest = 0;
      for (std::size_t n = 0; n < body.samples.size(); ++n) {
        const SurfaceSample &s = body.samples[n];
        const int high = body.x_of(s) > 0;
        sum[high] += body.forces[n] * volume;
        place[high] += body.forces[n] * volume * body.x_of(s) / force;
        if (s.spread != 0) {
          EXPECT_GE(body.forces[n] / s.spread * (high ? 1 : -1), 0);
          largest = std::max(largest, std::fabs(body.forces[n] / s.spread));
        }
      }
      EXPECT_NEAR(sum[1], force, 1e-12);
      EXPECT_NEAR(sum[0], -force, 1e-12);
      const double area = dim == 2 ? 2 * M_PI * radius : 4 * M_PI * radius * radius;
      EXPECT_NEAR(largest * part * area / force, 1, 0.01);
      // The middle of a cap, or of an arc.
      const double middle = dim == 2 ? radius * std::sin(M_PI * part) / (M_PI * part) : radius * (1 - part);
      for (const double found : place) EXPECT_NEAR(found, middle, 0.01 * radius);
    }
}

TEST(StretchForce, FacesAddUpToNothing) {
  for (const int dim : {2, 3}) {
    Pulled body(dim, 0.03);
    FieldBlock rate(body.grid, dim), scratch(body.grid, 1);
    constexpr double scale = 0.5;
    ASSERT_EQ(add_stretch_forces(body.grid, *body.exchange, body.samples, body.forces, scale, scratch, rate), 0);
    double sum = 0, high = 0, virial = 0;
    body.each_owned([&](int i, int j, int k) {
      const double f = rate[0](i, j, k) * body.grid.cell_volume();
      double x = body.position({i, j, k}, {false, true, true})[0] - body.centre[0];
      x -= std::round(x);
      sum += f;
      high += x > 0 ? f : 0;
      virial += f * x;
      for (int d = 1; d < dim; ++d) EXPECT_EQ(rate[d](i, j, k), 0);
    });
    EXPECT_NEAR(sum, 0, 1e-12);
    EXPECT_NEAR(high, scale * force, 1e-12);
    EXPECT_NEAR(virial, 2 * scale * force * radius, 0.1 * scale * force * radius);
  }
}

TEST(StretchForce, PowerIsThatOfTheEnds) {
  Pulled body(3, 0.03);
  constexpr double rate = 0.4;
  double moment = 0, power = 0;
  for (std::size_t n = 0; n < body.samples.size(); ++n) {
    body.samples[n].velocity[0] = 3 + rate * body.x_of(body.samples[n]);
    moment += body.forces[n] * body.x_of(body.samples[n]) * body.grid.cell_volume();
  }
  ASSERT_EQ(stretch_power(body.grid, body.samples, body.forces, &power), 0);
  EXPECT_NEAR(power, rate * moment, 1e-12);
  EXPECT_NEAR(power, 2 * rate * force * radius * (1 - part), 0.01 * power);
}

}  // namespace
