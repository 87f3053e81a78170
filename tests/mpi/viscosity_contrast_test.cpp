// Bodies with a viscosity of their own: the energy balance of the viscous force to round-off, and whole steps with the
// same bits on any number of ranks; without contrast those of a scene that has never heard of it.
#include "base/rank_zero.hpp"
#include "diagnostics/energy_rates.hpp"
#include "diagnostics/flow_measures.hpp"
#include "diagnostics/wall_shear_stress.hpp"
#include "flow/viscous_stress.hpp"
#include "output/saved_state.hpp"
#include "support/cell_block.hpp"
#include "support/on_one_rank.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

#include <cstring>

using namespace eulastic;
using namespace eulastic::test;

namespace {

struct MeasuredBlock : CellBlock {
  using CellBlock::CellBlock;

  // Sum of v . div tau over all faces but those on sides, where v = 0.
  double power_of_force() {
    Field force(domain, domain.dimension());
    EXPECT_EQ(add_viscous_force(domain, viscosity, fluid.density, velocity, force), 0);
    double power = 0;
    for (int c = 0; c < domain.dimension(); ++c)
      for (const Segment &row : domain.rows())
        for (int i = 0; i < row.i_end; ++i)
          power += velocity[c](i, row.j, row.k) * force[c](i, row.j, row.k) * domain.cell_volume();
    MPI_Allreduce(MPI_IN_PLACE, &power, 1, MPI_DOUBLE, MPI_SUM, domain.comm());
    return power;
  }
  FlowMeasures flow() const {
    FlowMeasures measures;
    EXPECT_EQ(measure_flow(domain, velocity, {fluid.density, fluid.viscosity, 0, 0, &viscosity.fields}, &measures), 0);
    return measures;
  }
  EnergyRates rates() const {
    EnergyRates rates;
    const EnergyParameters numbers{fluid.density, fluid.viscosity, {}, &sides, 0, &viscosity.fields};
    EXPECT_EQ(measure_energy_rates(domain, velocity, phases, numbers, &rates), 0);
    return rates;
  }
  std::vector<WallStress> stresses() const {
    return wall_shear_stress(domain, sides, 0, {domain, fluid.viscosity, fluid.density, &viscosity.fields}, velocity,
                             phases);
  }
};

TEST(ViscosityContrast, PowerOfTheForceIsThatOfTheWallsLessTheDissipation) {
  for (const bool flat : {false, true})
    for (const double contrast : {0.01, 5.0, 100.0})
      for (const std::array<bool, 3> &bounded :
           {std::array<bool, 3>{true, true, true}, {false, true, false}, {true, false, true}, {false, false, false}}) {
        MeasuredBlock box(run_communicator(), flat, bounded, contrast);
        const double dissipation = box.flow().viscous_dissipation;
        const double walls = box.rates().wall_power;
        EXPECT_GT(dissipation, 0.1);
        EXPECT_EQ(std::fabs(walls) > 1e-3, bounded[0] || bounded[1]);
        EXPECT_NEAR(box.power_of_force(), walls - dissipation, 1e-12 * dissipation) << contrast << flat << bounded[0];
      }
}

TEST(ViscosityContrast, MeasuresHaveTheBitsOfOneRank) {
  for (const bool flat : {false, true}) {
    double values[2][3];
    for (int alone = 0; alone < 2; ++alone) {
      const MeasuredBlock box(alone ? PETSC_COMM_SELF : run_communicator(), flat, {true, true, false}, 5);
      double largest = 0;
      for (const WallStress &wall : box.stresses())
        for (const std::vector<double> &values_of_wall : wall.components)
          for (const double value : values_of_wall) largest = std::max(largest, std::fabs(value));
      MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, box.domain.comm());
      values[alone][0] = box.flow().viscous_dissipation;
      values[alone][1] = box.rates().wall_power;
      values[alone][2] = largest;
    }
    EXPECT_EQ(std::memcmp(values[0], values[1], sizeof values[0]), 0);
  }
}

struct Case {
  const char *name;
  MethodKind method;
  PressureKind pressure;
  Int3 cells;
  double viscosity;  // of the body for .3 of the fluid; 0: none of its own
  bool split_x = false;
};

void PrintTo(const Case &c, std::ostream *out) { *out << c.name; }

// A body in shear beside a plane of symmetry, another one of the fluid's viscosity.
std::uint64_t hash_after(MPI_Comm comm, const Case &c, int steps) {
  int size = 0;
  MPI_Comm_size(comm, &size);
  Scene scene;
  GridSpec grid;
  grid.cells = c.cells;
  for (int d = 0; d < 3; ++d) grid.length[d] = 0.5 * c.cells[d];
  grid.boundary[1] = grid.boundary[2] = Boundary::wall;
  if (c.cells[2] == 1) grid.boundary[2] = Boundary::periodic;
  if (c.split_x) grid.processors = {size, 1, 1};
  SolverSpec spec;
  static_cast<Method &>(spec) = method_preset(c.method);
  spec.pressure = c.pressure;
  spec.fluid.density = 1.3;
  spec.fluid.viscosity = 0.3;
  spec.sides[1][1].motion = {{0.4, 0, 0}, 0.3, 0.2};
  spec.sides[2][0].kind = BoundaryKind::symmetry;
  EXPECT_EQ(scene.create(comm, grid, spec), 0);
  const double height = grid.length[1];
  set(scene.domain, scene.solver.state().velocity[0], at_face[0],
      [&](double, double y, double) { return 0.4 * y / height; });
  const auto ball = [&](Real3 centre, double radius) {
    if (c.cells[2] == 1) centre[2] = 0.25;
    return [=](double x, double y, double z) {
      const double dx = x - centre[0], dy = y - centre[1], dz = z - centre[2];
      return std::min(1.0, std::max(0.0, 0.5 + (radius - std::sqrt(dx * dx + dy * dy + dz * dz)) / 0.5));
    };
  };
  scene.add_phase(0.5, ball({3.1, 0.42 * height, 2}, 1.6)).material.viscosity = c.viscosity;
  scene.add_phase(0.3, ball({6.2, 0.5 * height, 3}, 1.1));
  EXPECT_EQ(scene.solver.prepare(), 0);
  for (int n = 0; n < steps; ++n) {
    FlowExtremes extremes;
    EXPECT_EQ(scene.solver.measure(&extremes), 0);
    EXPECT_EQ(extremes.first_non_finite, -1);
    EXPECT_EQ(scene.solver.step(0.5 * scene.solver.limits(extremes).automatic()), 0);
  }
  std::uint64_t hash = 0;
  EXPECT_EQ(state_hash(&scene.solver, &hash), 0);
  return hash;
}

class Contrast : public testing::TestWithParam<Case> {};

TEST_P(Contrast, SameBitsAsOnOneRank) {
  EXPECT_EQ(hash_after(run_communicator(), GetParam(), 8),
            on_one_rank([](MPI_Comm comm) { return hash_after(comm, GetParam(), 8); }));
}

constexpr PressureKind acm = PressureKind::acm, smac = PressureKind::smac;
constexpr MethodKind fast = MethodKind::fast, classic = MethodKind::classic;
INSTANTIATE_TEST_SUITE_P(Scenes, Contrast,
                         testing::Values(Case{"fast_acm", fast, acm, {18, 16, 14}, 1.5},
                                         Case{"fast_smac", fast, smac, {18, 16, 14}, 0.006},
                                         Case{"classic_smac", classic, smac, {18, 16, 14}, 1.5},
                                         Case{"flat_acm", fast, acm, {23, 19, 1}, 3},
                                         Case{"flat_classic", classic, acm, {23, 19, 1}, 0.03},
                                         Case{"split_x", fast, smac, {1030, 9, 1}, 1.5, true}),
                         [](const auto &test) { return test.param.name; });

TEST(ViscosityContrast, OfOneIsNone) {
  for (const MethodKind method : {fast, classic})
    for (const Int3 &cells : {Int3{18, 16, 14}, Int3{23, 19, 1}}) {
      const Case none{"", method, smac, cells, 0}, same{"", method, smac, cells, 0.3},
          more{"", method, smac, cells, 0.6};
      const std::uint64_t reference = hash_after(run_communicator(), none, 3);
      EXPECT_EQ(hash_after(run_communicator(), same, 3), reference);
      EXPECT_NE(hash_after(run_communicator(), more, 3), reference);
    }
}

}  // namespace
