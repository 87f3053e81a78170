// The memory of the machine; runs that need more are refused with both numbers.
#include "scene/memory.hpp"
#include "scene/scene.hpp"
#include "solver/synchronised_state.hpp"
#include "support/command_line.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

using namespace eulastic;

namespace {

std::string refusal(const std::string &line) {
  const ParseResult parsed = parse_line(line);
  EXPECT_EQ(parsed.error, "");
  std::string text;
  EXPECT_EQ(check_sizes(PETSC_COMM_SELF, parsed.config, &text), 0);
  return text;
}

}  // namespace

TEST(Memory, PhysicalMemoryOfTheMachine) {
  std::ifstream kernel("/proc/meminfo");  // MemTotal: <number> kB
  std::string name;
  double kilobytes = 0;
  ASSERT_TRUE(kernel >> name >> kilobytes && name == "MemTotal:");
  EXPECT_EQ(memory_limit(), 1024 * kilobytes);
}

TEST(Memory, RefusedWithBothNumbers) {
  EXPECT_EQ(refusal(scene), "");
  const std::string text = refusal("-time_end 1 -grid_cells 1290,1290,1290");
  EXPECT_NE(text.find("GB on a node (1 ranks), which has"), std::string::npos) << text;
  EXPECT_NE(text.find("-guard_memory"), std::string::npos) << text;
  // A machine with that much memory: with 32-bit indices PETSc cannot count to 6 x 1296^3.
  const std::string off = refusal("-time_end 1 -grid_cells 1290,1290,1290 -guard_memory 0");
  const bool counts = sizeof(PetscInt) == 8;
  EXPECT_EQ(off.find("a field of 13060694016 numbers") == std::string::npos, counts) << off;
  EXPECT_EQ(off.empty(), counts) << off;
  EXPECT_NE(refusal(scene + " -guard_memory 1e-9").find("1e-09 now"), std::string::npos);
}

TEST(Memory, PhasesAndBoxesCount) {
  const std::string line =
      "-time_end 1 -grid_length 8,8,8 -species vessel,ball -vessel_shape slab -vessel_axis y -vessel_interval 0,.1 "
      "-vessel_shear_modulus 1 -ball_shape sphere -ball_radius .3 -ball_shear_modulus 1 -ball_placement lattice "
      "-ball_count 4,4,4 -grid_cells 32,32,32 ";
  const Config merged = parse_line(line + "-ball_contact merge").config;
  // Phi, label and six of B, and the same at the time of the output; without modulus no B, the first B lies elsewhere.
  const double fluid =
      bytes_per_rank(parse_line("-time_end 1 -grid_cells 32,32,32 -grid_length 8,8,8").config, {1, 1, 1});
  std::string without = line;
  without.replace(without.find("-vessel_shear_modulus 1"), 23, "-vessel_shear_modulus 0");
  const Config soft = parse_line(without + "-ball_contact merge").config;
  EXPECT_DOUBLE_EQ(bytes_per_rank(merged, {1, 1, 1}), bytes_per_rank(soft, {1, 1, 1}) + 8 * 12 * std::pow(42, 3));
  EXPECT_GT(bytes_per_rank(soft, {1, 1, 1}), fluid);
  // Bodies in boxes: four cells around each, and five ghosts; phi and B; the force; and a copy with a velocity at the
  // time of the output, of the body and the eleven layers that its strain is seen in.
  const Config boxes = parse_line(line).config;
  const double reach = 2 * .3 * 4 + 2 * 4;
  EXPECT_NEAR(bytes_in_boxes(boxes),
              64 * 8. * (7 * std::pow(reach + 10, 3) + 10 * std::pow(reach + 3, 3) + 3 * std::pow(reach, 3)), 1);
  EXPECT_DOUBLE_EQ(bytes_per_rank(boxes, {1, 1, 1}),
                   bytes_per_rank(merged, {1, 1, 1}) - 8 * 8 * std::pow(42, 3) + bytes_in_boxes(boxes));
  const Config flat = parse_line(
                          "-time_end 1 -grid_cells 32,32,1 -grid_length 8,8,1 -species ball -ball_shape ellipsoid "
                          "-ball_semi_axes .3,.5,1 "
                          "-ball_shear_modulus 1 -ball_placement lattice -ball_count 4,4,1")
                          .config;
  const double flat_reach = 2 * .5 * 4 + 2 * 4;
  EXPECT_NEAR(
      bytes_in_boxes(flat),
      16 * 8. * (4 * std::pow(flat_reach + 10, 2) + 6 * std::pow(flat_reach + 3, 2) + 2 * std::pow(flat_reach, 2)), 1);
  // Viscosities of the place, at centres, on edges and along surfaces, three of the normal, six of the stress there,
  // and the pressure of the step before; five velocities, three fields of the V-cycles and their coarse levels.
  const Config viscous = parse_line(line + "-ball_contact merge -ball_viscosity 2 -fluid_viscosity 1").config;
  EXPECT_DOUBLE_EQ(bytes_per_rank(viscous, {1, 1, 1}),
                   bytes_per_rank(merged, {1, 1, 1}) + 8 * (15 + 18.4) * std::pow(42, 3));
}

// The estimate names fields that many classes allocate: Solver::bytes() sums what they have after an output. Lists of
// the faces at rigid bodies are not part of it; those of small bodies are short.
TEST(Memory, IsWhatTheSolverAllocates) {
  const std::string box = "-time_end 1 -grid_cells 32,32,32 -boundary_y wall -fluid_viscosity .1 ";
  const std::string ball = "-species a -a_shape sphere -a_radius .3 -a_contact merge ";
  const std::string soft = ball + "-a_shear_modulus 1 ";
  const std::string cases[] = {
      box,
      box + "-method classic",
      box + "-boundary_xmin pressure -boundary_xmax pressure -boundary_xmax_resistance 1",
      box + soft,
      box + soft + "-method classic",
      box + soft + "-a_viscosity 1",
      box + ball + "-a_shear_modulus 0 -a_surface_tension 1",
      box + "-species a -a_shape sphere -a_radius .3 -a_law membrane -a_surface_shear_modulus 1",
      box + "-species a -a_shape sphere -a_radius .1 -a_law rigid",
      box + "-species a -a_shape sphere -a_radius .1 -a_law rigid -a_velocity .1,0,0"};
  for (const std::string &line : cases) {
    const Config config = parse_line(line).config;
    Domain domain;
    Solver solver;
    std::string reason;
    FlowExtremes extremes;
    const std::vector<Phase> *phases = nullptr;
    ASSERT_EQ(domain.create(PETSC_COMM_SELF, config.grid), 0);
    ASSERT_EQ(build_scene(config, domain, &solver, &reason), 0);
    ASSERT_EQ(reason, "") << line;
    ASSERT_EQ(solver.measure(&extremes), 0);
    ASSERT_EQ(solver.step(1e-4), 0);
    ASSERT_EQ(solver.synchronised().phases(&phases), 0);
    // In fields: rows are padded, and directions with boundaries have one more layer, which the estimate leaves out.
    const double allocated = double(solver.bytes()) / (8. * double(domain.layout().size));
    const double estimated = bytes_per_rank(config, {1, 1, 1}) / (8. * std::pow(32 + 2 * config.grid.ghosts, 3));
    EXPECT_NEAR(allocated, estimated, 0.05 * estimated) << line;
  }
}
