// A flow has the parts that its scene needs, and every item of its persistent state has a name of its own.
#include "drops/surface_tension.hpp"
#include "membranes/membrane_transport.hpp"
#include "openings/loaded_outlets.hpp"
#include "parts/state.hpp"
#include "solids/grid_bodies.hpp"
#include "solids/species_force.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>
#include <set>

using namespace eulastic;
using namespace eulastic::test;

namespace {

SolverSpec fast_spec() {
  SolverSpec spec;
  static_cast<Method &>(spec) = method_preset(MethodKind::fast);
  spec.fluid.viscosity = 0.1;
  return spec;
}

struct Discs : Scene {
  explicit Discs(const SolverSpec &spec, int discs = 1) {
    GridSpec grid;
    grid.cells = {16, 16, 1};
    grid.length = {1, 1, 1. / 16};
    EXPECT_EQ(create(PETSC_COMM_SELF, grid, spec), 0);
    for (int n = 0; n < discs; ++n)
      add_phase(0.3, [](double x, double y, double) {
        return std::min(1.0, std::max(0.0, 16 * (0.3 - std::hypot(x - 0.5, y - 0.5)) + 0.5));
      }).species = "disc" + std::to_string(n);
  }
  Material &material(int phase = 0) { return solver.state().phases[phase].material; }
};

TEST(Parts, AreThoseOfTheScene) {
  Discs solid(fast_spec());
  ASSERT_EQ(solid.solver.prepare(), 0);
  EXPECT_NE(solid.solver.part<GridBodies>(), nullptr);
  EXPECT_EQ(solid.solver.flow().parts.size(), 1u);

  Discs drop(fast_spec());
  drop.material().shear_modulus = 0;
  drop.material().surface_tension = 1;
  drop.material().body_force.force = {1, 0, 0};
  ASSERT_EQ(drop.solver.prepare(), 0);
  EXPECT_NE(drop.solver.part<SurfaceTension>(), nullptr);
  EXPECT_NE(drop.solver.part<SpeciesForces>(), nullptr);
  EXPECT_EQ(drop.solver.part<MembraneTransport>(), nullptr);
  EXPECT_EQ(drop.solver.part<LoadedOutlets>(), nullptr);
  EXPECT_EQ(drop.solver.flow().parts.size(), 3u);

  Discs fluid(fast_spec(), 0);
  ASSERT_EQ(fluid.solver.prepare(), 0);
  EXPECT_TRUE(fluid.solver.flow().parts.empty());
}

TEST(Parts, CarryEveryFieldUnderAName) {
  for (const MethodKind kind : {MethodKind::fast, MethodKind::classic}) {
    SolverSpec spec = fast_spec();
    static_cast<Method &>(spec) = method_preset(kind);
    Discs two(spec, 2);
    ASSERT_EQ(two.solver.prepare(), 0);
    ASSERT_EQ(two.advance(2, 1), 0);
    CarriedState state;
    ASSERT_EQ(two.solver.carry(&state), 0);
    std::set<std::string> names;
    std::set<const double *> places;
    for (const CheckpointField &field : state.fields) {
      names.insert(field.name);
      places.insert(field.view.origin);
    }
    EXPECT_EQ(names.size(), state.fields.size());
    EXPECT_EQ(places.size(), state.fields.size());
    for (const char *name :
         {"velocity_x", "velocity_y", "pressure", "solid_fraction_disc0", "left_cauchy_green_xy_disc1"})
      EXPECT_EQ(names.count(name), 1u) << name;
    EXPECT_EQ(names.count("advection_x"), kind == MethodKind::fast ? 1u : 0u);
    EXPECT_EQ(*state.integers.at("step")[0], 2);
    EXPECT_EQ(*state.reals.at("time")[0], two.solver.state().time);
  }
}

}  // namespace
