// Measures of membranes in bodies.h5: areas, energies, and rates of rotation.
#include "membranes/surface_measures.hpp"
#include "membranes/membrane_transport.hpp"
#include "support/interface_scene.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

using Flow = std::function<Real3(const Real3 &)>;

// An ellipse or ellipsoid a, b, b with its long axis along x, in a linear flow around its centre.
SurfaceMeasure measure(int dim, const Flow &flow, SurfaceEnergy *energy) {
  constexpr int cells = 40;
  constexpr double a = 0.33, b = 0.22;
  InterfaceScene scene;
  GridSpec spec;
  spec.cells = {cells, cells, dim == 2 ? 1 : cells};
  spec.length = {1, 1, dim == 2 ? 1. / cells : 1};
  spec.ghosts = 5;
  EXPECT_EQ(scene.create(PETSC_COMM_SELF, spec), 0);
  const Real3 centre{0.51, 0.493, dim == 2 ? 0 : 0.505};
  scene.set_fraction(ellipsoid(centre, {a, b, b}, dim));
  GhostExchange exchange(scene.domain);
  std::vector<Phase> phases(1);
  Phase &phase = phases[0];
  phase.fraction = std::move(scene.fraction);
  phase.tensor.field = undeformed_tensor(scene.domain);
  phase.label = Field(scene.domain, 1);
  phase.material.law = Law::membrane;
  phase.material.membrane.shear_modulus = 2;
  phase.material.membrane.bending_modulus = 0.1;
  phase.material.membrane.initial_area_stretch = 1.2;
  scene.each_owned([&](int i, int j, int k) {
    phase.label[0](i, j, k) = phase.fraction[0](i, j, k) > 1e-12;
    for (int d = 0; d < dim; ++d) {
      std::array<bool, 3> at{true, true, true};
      at[d] = false;
      Real3 x = scene.position({i, j, k}, at);
      for (int e = 0; e < 3; ++e) x[e] -= centre[e];
      scene.velocity[d](i, j, k) = 0.2 + flow(x)[d];
    }
  });
  EXPECT_EQ(exchange.update_ghosts(scene.velocity, 1), 0);
  EXPECT_EQ(exchange.update_ghosts(phase.fraction, 5), 0);
  EXPECT_EQ(phase.rows.find(scene.domain, phase.fraction[0]), 0);
  eulastic::Flow still(scene.domain, {});
  EXPECT_EQ(still.work.reserve(MembraneTransport::fields), 0);
  still.now.phases = std::move(phases);
  still.now.velocity = std::move(scene.velocity);
  MembraneTransport membrane(&still);
  EXPECT_EQ(membrane.start(), 0);
  std::vector<SurfaceSample> samples;
  EXPECT_EQ(membrane.add_surface_energy({still.now.phases, {}}, energy, &samples), 0);
  std::vector<SurfaceMeasure> bodies;
  BodyOwners owners;
  EXPECT_EQ(owners.connect(PETSC_COMM_SELF, 1, {0}), 0);
  EXPECT_EQ(measure_surfaces(scene.domain, still.now.phases, samples, owners, {{20, 20, dim == 2 ? 0 : 20}}, &bodies),
            0);
  return bodies.at(0);
}

TEST(SurfaceMeasures, AreaAndEnergies) {
  for (const int dim : {2, 3}) {
    SurfaceEnergy energy;
    const SurfaceMeasure seen = measure(
        dim, [](const Real3 &) { return Real3{}; }, &energy);
    const double e = std::sqrt(1 - 0.22 * 0.22 / (0.33 * 0.33));
    const double exact = dim == 2 ? 1.7453042 : 2 * M_PI * 0.22 * (0.22 + 0.33 * std::asin(e) / e);
    EXPECT_NEAR(seen.area, exact, 0.01 * exact);
    EXPECT_NEAR(seen.shear_energy + seen.area_energy + seen.bending_energy, energy.energy, 1e-9);
    EXPECT_GT(seen.bending_energy, 0.1);
    // In 3-D the stretch is the same in all directions; in 2-D only lengths in the plane change.
    const double J = 1.2, stored = 0.5 * 2 * (2 * J + 1 / (J * J) - 3) / J * exact;
    EXPECT_NEAR(seen.area_energy, stored, 0.02 * stored);
    EXPECT_NEAR(seen.shear_energy, dim == 2 ? (J - 1) * (J - 1) / J * exact : 0, 0.02 * stored);
  }
}

TEST(SurfaceMeasures, MaterialGoesRoundAsInTankTreadingAndTumblingAlike) {
  constexpr double ratio = 1.5, rate = 0.7;
  const auto turns = [&](int dim, double xy, double yx) {
    SurfaceEnergy energy;
    return measure(
               dim,
               [=](const Real3 &x) {
                 return Real3{xy * x[1], yx * x[0], 0};
               },
               &energy)
        .turning_rate;
  };
  for (const int dim : {2, 3}) {
    EXPECT_NEAR(turns(dim, -rate, rate), rate, 1e-9);                   // as a whole
    EXPECT_NEAR(turns(dim, rate * ratio, -rate / ratio), -rate, 1e-9);  // along an ellipse
    EXPECT_EQ(turns(dim, rate, rate), 0);                               // it is only strained
  }
}

}  // namespace
