// Measures of the flow that determine the time step.
#include "support/scene.hpp"

#include <gtest/gtest.h>

#include <limits>

using namespace eulastic;
using namespace eulastic::test;

namespace {

// Segments consist of whole vectors. Points in them that do not evolve must not count, or the bits would depend on
// which points are skipped.
TEST(Extremes, TraceIsThatOfCentresThatEvolve) {
  Scene scene;
  GridSpec grid;
  grid.cells = {16, 12, 8};
  grid.length = {16, 12, 8};
  SolverSpec spec;
  static_cast<Method &>(spec) = method_preset(MethodKind::fast);
  ASSERT_EQ(scene.create(PETSC_COMM_SELF, grid, spec), 0);
  scene.add_phase(
      0.1, [](double x, double y, double z) { return std::clamp(3.5 - std::hypot(x - 7, y - 6, z - 4), 0.0, 1.0); });
  ASSERT_EQ(scene.solver.prepare(), 0);
  Phase &phase = scene.solver.state().phases[0];
  const View B = phase.tensor.field[0], phi = phase.fraction[0];
  double *inner = nullptr, *outer = nullptr;
  for (const Segment &s : phase.tensor.evolving.all())
    for (int i = s.i_begin; i < s.i_end; ++i) (phi(i, s.j, s.k) >= 0.5 ? inner : outer) = &B(i, s.j, s.k);
  ASSERT_TRUE(inner && outer);
  const auto measure = [&] {
    FlowExtremes extremes;
    EXPECT_EQ(scene.solver.measure(&extremes), 0);
    return extremes;
  };
  EXPECT_EQ(measure().trace[0], 3);
  *inner = 5;
  EXPECT_EQ(measure().trace[0], 7);
  *outer = 9;
  EXPECT_EQ(measure().trace[0], 7);
  EXPECT_EQ(measure().first_non_finite, -1);
  *outer = std::numeric_limits<double>::quiet_NaN();
  EXPECT_GE(measure().first_non_finite, 0) << "wherever it is";
}

}  // namespace
