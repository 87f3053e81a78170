// SnapshotFields: what several species have in common, at its own place.
#include "io/snapshot_fields.hpp"

#include <gtest/gtest.h>

namespace eulastic {
namespace {

class MixedTensors : public ::testing::TestWithParam<int> {};

// I + sum of phi (B - I): on an edge phi is the mean of the four centres around, here of linear fractions.
TEST_P(MixedTensors, WeighTheSpeciesByTheirFractionsAtThePlaceOfEveryComponent) {
  DomainShape shape;
  shape.cells = {6, 5, GetParam()};
  const Box box(shape, {0, 0, 0}, shape.cells, 3);
  const int dimension = box.dimension();
  const auto fraction = [](int p, double x, double y, double z) {
    return p == 0 ? 0.05 * x + 0.3 : 0.03 * y + 0.02 * z;
  };
  const auto value = [](int p, int c, int i, int j, int k) { return 1.5 + p + 0.1 * c + 0.01 * (i + 2 * j + 3 * k); };
  std::vector<Phase> phases(2);
  for (int p = 0; p < 2; ++p) {
    phases[p].species = p == 0 ? "cell" : "platelet";
    phases[p].empty(box, true);
    for (int k = -box.layout().ghosts[2]; k < shape.cells[2]; ++k)
      for (int j = -1; j < shape.cells[1]; ++j)
        for (int i = -1; i < shape.cells[0]; ++i) phases[p].fraction[0](i, j, k) = fraction(p, i, j, k);
    for (int c = 0; c < phases[p].tensor.field.count(); ++c)
      for_points(box.rows(), [&](int i, int j, int k) { phases[p].tensor.field[c](i, j, k) = value(p, c, i, j, k); });
  }
  SnapshotFields fields(box);
  const Field velocity(box, dimension), pressure(box, 1);
  int found = 0;
  for (const SnapshotField &field : fields.collect({"left_cauchy_green"}, Stored::float64, velocity, pressure, phases))
    for (int c = 0; c < phases[0].tensor.field.count(); ++c) {
      const TensorComponent &component = phases[0].tensor.components()[c];
      if (field.format.name != "left_cauchy_green_" + component.name()) continue;
      ++found;
      const double back[3] = {component.at[0] ? 0.5 : 0, component.at[1] ? 0.5 : 0, component.at[2] ? 0.5 : 0};
      for_points(box.rows(), [&](int i, int j, int k) {
        double expected = component.rest();
        for (int p = 0; p < 2; ++p)
          expected += fraction(p, i - back[0], j - back[1], k - back[2]) * (value(p, c, i, j, k) - component.rest());
        EXPECT_NEAR(field.components[0](i, j, k), expected, 1e-14) << field.format.name << " " << i << j << k;
      });
    }
  EXPECT_EQ(found, phases[0].tensor.field.count());
}

INSTANTIATE_TEST_SUITE_P(Dimensions, MixedTensors, ::testing::Values(1, 4));

}  // namespace
}  // namespace eulastic
