// -check_only: derived numbers against hand values.
#include "scene/check_only.hpp"
#include "scene/scene_warnings.hpp"
#include "support/command_line.hpp"

using namespace eulastic;

TEST(CheckOnly, NumbersOfAChannel) {
  // Channel of height 2: U = f H^2/(8 nu) = 1, shear rate f H/(2 nu) = 2; nu = 1/2, c^2 = 2, S = 2 4^2 = 32.
  const ParseResult result = parse_line(
      "-grid_cells 16,8,1 -grid_length 4,2,1 -boundary_y wall -fluid_density 2 -fluid_viscosity 1 -body_force 1,0,0 "
      "-time_end 100 -method classic -species a -a_shape sphere -a_radius .5 -a_shear_modulus 4 -a_placement lattice "
      "-a_count 2,1,1");
  ASSERT_EQ(result.error, "");
  const std::string report = check_report(result.config, 2);
  const auto has = [&](const std::string &line) {
    EXPECT_NE(report.find(line + "\n"), std::string::npos) << line << " in\n" << report;
  };
  has("cells: 16 x 8 x 1 = 128");
  has("spacing: 0.25 x 0.25");
  has("ranks: 1 x 2 x 1 = 2, about 64 cells each");
  has("velocity scale (estimate): 1");
  has("Reynolds number: 4 (length 2)");
  has("capillary number of a: 0.5 (viscosity x shear rate / shear modulus)");
  has("hematocrit: 0.19635");   // 2 pi/4 / 8
  const double ghosts = 2 * 3;  // of the paper's method
  char memory[64];              // 15 fields: u, v now and predicted, p, D; phi, label, 3 of B; phi and B being computed
  std::snprintf(memory, sizeof memory, "%.4g GB per rank; this", 8e-9 * 15 * (16 + ghosts) * (4 + ghosts));
  EXPECT_NE(report.find(memory), std::string::npos) << report;
  has("dt limit, viscous: 0.03125");                // 1/(2 nu S)
  has("dt limit, elastic wave: 0.125");             // 1/(c sqrt(S))
  has("dt limit, viscous and elastic: 0.0295085");  // 64 dt^2 + 32 dt = 1
  has("dt limit, advective: 0.059017");             // 4 dt + 4 dt^2 = 1/4
  has("dt limit, Euler 2 nu/U^2: 1");
  // ceil(100/(0.8 x 0.0295085)) = 4237 steps of 20 us and 128 cells at 10 + 6 ns, two ranks
  has("steps (estimate): 4237");
  has("wall time (estimate): 0.0891 seconds on 2 cores, 0.33 us per cell, step and core");
  EXPECT_EQ(report.find("warning"), std::string::npos);
  const std::string two =
      "-time_end 1 -grid_cells 16,16,16 -grid_length 8,8,8 -species cell -cell_shape sphere "
      "-cell_radius .8 -cell_shear_modulus 1 -cell_placement lattice -cell_count 2,1,1 ";
  EXPECT_NE(check_report(parse_line(two).config, 1).find("bodies in boxes (estimate): "), std::string::npos);
  EXPECT_EQ(check_report(parse_line(two + "-cell_contact merge").config, 1).find("bodies in boxes"), std::string::npos);
  // nu_max = 4, 4/3 of it in 3-D, S = 12; 2 4 mu (1 - 1/4)/G in the surface of what is four times as viscous.
  const std::string viscous = check_report(parse_line(two + "-cell_viscosity 4 -fluid_viscosity 1").config, 1);
  for (const char *line :
       {"viscosity of cell: 4, 4 times the fluid's\n", "dt limit, viscous: 0.0078125\n", "dt limit, Kelvin-Voigt: 6\n"})
    EXPECT_NE(viscous.find(line), std::string::npos) << line << viscous;
  // sqrt(.5^3/(2 pi 8)), and .5 over 8/((4 + 1)/2).
  const std::string drop = check_report(parse_line(two + "-cell_viscosity 4 -cell_surface_tension 8").config, 1);
  for (const char *line : {"dt limit, capillary wave: 0.0498678\n", "dt limit, viscous surface: 0.15625\n"})
    EXPECT_NE(drop.find(line), std::string::npos) << line << drop;
  EXPECT_EQ(viscous.find("capillary"), std::string::npos);
  const ParseResult forced = parse_line(scene + " -method classic -time_step 1 -check_only");
  EXPECT_NE(check_report(forced.config, 1).find("warning: -time_step 1 exceeds the viscous limit"), std::string::npos);
  const ParseResult huge = parse_line("-time_end 1 -grid_cells 8192,8192,8192 -check_only");
  ASSERT_EQ(huge.error, "");
  EXPECT_EQ(check_report(huge.config, 1024).find("64-bit") != std::string::npos, sizeof(PetscInt) == 4);
  // A tube of diameter 4: U = f R^2/(4 nu) = 1, shear rate f R/(2 nu) = 1; 4 pi/3 of the lumen's 8 pi are cell.
  const ParseResult tube = parse_line(
      "-time_end 1 -grid_cells 10,25,25 -grid_length 2,5,5 -body_force 1,0,0 -species vessel,cell -vessel_shape tube "
      "-vessel_axis x -vessel_radius 2 -vessel_shear_modulus 1 -cell_shape sphere -cell_radius 1 -cell_shear_modulus "
      "1");
  ASSERT_EQ(tube.error, "");
  const std::string inside = check_report(tube.config, 1);
  for (const char *line : {"velocity scale (estimate): 1\n", "shear rate (estimate): 1\n", "(length 4)\n",
                           "hematocrit: 0.166667 (of the box less slabs, tubes, vessels)\n"})
    EXPECT_NE(inside.find(line), std::string::npos) << line << inside;
}

// 4.0 ms with 102400 cells, .30 ms with 16384 cells and no body, 19 us with 128 cells, as in the validation.
TEST(CheckOnly, WallTimeOfStepsIn2D) {
  const auto seconds = [](const std::string &options) {
    const ParseResult result = parse_line("-time_end 1 -time_step .001 -fluid_viscosity 1e-4 " + options);
    EXPECT_EQ(result.error, "");
    const std::string report = check_report(result.config, 1), name = "wall time (estimate): ";
    const std::size_t at = report.find(name);
    return at == std::string::npos ? 0 : std::stod(report.substr(at + name.size()));
  };
  EXPECT_NEAR(seconds("-grid_cells 320,320,1 -species a -a_shape sphere -a_radius .1 -a_shear_modulus 1"), 4, 1);
  EXPECT_NEAR(seconds("-grid_cells 128,128,1"), .3, .1);
  EXPECT_NEAR(seconds("-grid_cells 16,8,1"), .02, .015);
}

TEST(CheckOnly, FlowThroughOpenSides) {
  const std::string channel = "-time_end 9 -grid_cells 32,16,1 -grid_length 4,2,1 -boundary_y wall -fluid_viscosity 1 ";
  const auto says = [&](const std::string &options) {
    const ParseResult result = parse_line(channel + options);
    EXPECT_EQ(result.error, "");
    return check_report(result.config, 1);
  };
  const std::string fed = says("-boundary_xmin inflow -boundary_xmax outflow -boundary_xmin_velocity .5");
  for (const char *line : {"velocity scale (estimate): 1\n", "shear rate (estimate): 2\n"})
    EXPECT_NE(fed.find(line), std::string::npos) << line << fed;
  // f = 8/4, U = f H^2/(8 nu), shear rate f H/(2 nu).
  const std::string pushed = says("-boundary_xmin pressure -boundary_xmax pressure -boundary_xmin_pressure 8");
  for (const char *line : {"velocity scale (estimate): 1\n", "shear rate (estimate): 2\n"})
    EXPECT_NE(pushed.find(line), std::string::npos) << line << pushed;
}

TEST(CheckOnly, WarnsOfBodiesThatMergeWhereTheInterfaceIsSharp) {
  const std::string line =
      "-time_end 1 -grid_cells 32,32,1 -species cell -cell_shear_modulus 1 -cell_radius .1 -cell_placement lattice ";
  const auto warnings = [&](const std::string &options) {
    const ParseResult result = parse_line(line + options);
    EXPECT_EQ(result.error, "");
    std::string text;
    for (const std::string &warning : scene_warnings(result.config)) text += warning + "\n";
    return text;
  };
  const std::string merging = "bodies of cell merge where they touch: to stay separate they need ";
  EXPECT_NE(warnings("-cell_shape cylinder -cell_count 2,1,1").find(merging + "-cell_shape sphere"), std::string::npos);
  for (const std::string &fine :
       {std::string("-cell_shape cylinder -cell_count 2,1,1 -cell_contact merge"),
        std::string("-cell_shape sphere -interface_scheme weno5 -cell_count 2,1,1"),
        std::string("-cell_shape sphere -method classic -cell_count 2,1,1"),
        std::string("-cell_shape sphere -cell_count 2,1,1"), std::string("-cell_shape cylinder -cell_count 1,1,1")})
    EXPECT_EQ(warnings(fine).find("merge where they touch"), std::string::npos) << fine;
}

// A tube of diameter 1.6: pi .64 = 2.0106 of 5.76, .3 of it, .3 1.6/1. Two channels of .5 and .2 at 16 cells per
// length.
TEST(CheckOnly, LumensOfSides) {
  const auto says = [](const std::string &options) {
    const ParseResult result = parse_line("-time_end 1 -boundary_xmin inflow -boundary_xmin_velocity .3 " + options);
    EXPECT_EQ(result.error, "");
    std::string text = check_report(result.config, 1);
    for (const std::string &warning : scene_warnings(result.config)) text += warning + "\n";
    return text;
  };
  const auto has = [](const std::string &text, const std::string &line) {
    EXPECT_NE(text.find(line), std::string::npos) << line << " in\n" << text;
  };
  const std::string tube = says(
      "-grid_cells 12,48,48 -grid_length .6,2.4,2.4 -boundary_xmax outflow -species v -v_shape tube -v_axis x -v_law "
      "rigid -v_radius .8 -v_centre 0,1.25,1.15 -fluid_viscosity 1");
  has(tube,
      "\nboundary xmin: inflow, open area 2.011 of 5.76, lumen 1.6 wide, 32 cells across; mean velocity 0.3, flow rate "
      "0.6032 into the box, Reynolds number of the lumen 0.48\n");
  has(tube,
      "\nboundary xmax: outflow, open area 2.011 of 5.76, lumen 1.6 wide, 32 cells across; mean velocity -0.3, flow "
      "rate "
      "-0.6032 into the box, Reynolds number of the lumen 0.48\n");
  has(tube, "\nvelocity scale (estimate): 0.6\n");  // in the middle of a developed flow
  EXPECT_EQ(tube.find("boundary_x"), std::string::npos) << tube;
  const std::string two = says(
      "-grid_cells 16,16,1 -boundary_y wall -boundary_xmax pressure -species v -v_shape slab -v_axis y -v_interval "
      ".2,.5 -v_law rigid -fluid_viscosity 1e-5 -boundary_xmin_angular_frequency 1");
  has(two,
      "\nboundary xmin: inflow, open length 0.7 of 1, 2 lumens, the widest 0.5 wide, 3.2 cells across the narrowest; "
      "mean "
      "velocity up to 0.3, flow rate up to 0.21 into the box, Reynolds number of the lumen up to 1.5e+04\n");
  for (const char *side : {"-boundary_xmin: ", "-boundary_xmax: "})
    for (const char *what : {"only 3.2 cells across the lumen", "Reynolds number 1.5e+04 of the lumen"})
      has(two, std::string(side) + what);
  // Planes of symmetry and periodic directions are no walls; where the flow leaves twice it is not known how.
  const std::string mirrored =
      says("-grid_cells 16,7,6 -boundary_ymin wall -boundary_ymax symmetry -boundary_xmax outflow");
  has(mirrored, "\nboundary xmin: inflow, open area 1 of 1, lumen 2 wide, 14 cells across; mean velocity 0.3, ");
  const std::string open = says("-grid_cells 16,8,6 -boundary_xmax outflow");
  has(open, "\nboundary xmin: inflow, open area 1 of 1, no walls; mean velocity 0.3, flow rate 0.3 into the box\n");
  const std::string forked =
      says("-grid_cells 16,16,1 -boundary_ymin wall -boundary_ymax pressure -boundary_xmax outflow");
  has(forked,
      "\nboundary xmax: outflow, open length 1 of 1, lumen 2 wide, 32 cells across; the flow through it is unknown\n");
  const std::string nothing = says(
      "-grid_cells 16,16,1 -boundary_y wall -boundary_xmax outflow -species v -v_shape tube -v_axis x -v_radius .5 "
      "-v_law rigid");
  has(nothing, "-v_radius: the lumen is as wide as the box");
}

// What leaves through an outlet is negative, also where it varies.
TEST(CheckOnly, SignOfAFlowThatVaries) {
  const TemporaryFile pulse("time,value\n0,.1\n1,.3\n");
  const ParseResult result = parse_line("-time_end 1 -grid_cells 16,8,1 -boundary_y wall -boundary_xmin inflow " +
                                        ("-boundary_xmax outflow -boundary_xmin_velocity " + pulse.path()));
  ASSERT_EQ(result.error, "");
  const std::string text = check_report(result.config, 1);
  for (const char *says : {"; mean velocity up to 0.3, flow rate up to 0.3 into the box",
                           "; mean velocity up to -0.3, flow rate up to -0.3 into the box"})
    EXPECT_NE(text.find(says), std::string::npos) << text;
}

TEST(CheckOnly, WhatCannotFlowIsRefused) {
  const std::string box = "-time_end 1 -grid_cells 16,16,1 -boundary_xmin inflow -boundary_xmax outflow ",
                    slab = "-species v -v_shape slab -v_law rigid ", flow = "-boundary_xmin_velocity 1 ";
  const auto refused = [](const std::string &options, const std::string &start) {
    for (const char *check : {"", " -check_only"})
      EXPECT_EQ(parse_line(options + check).error.rfind(start, 0), 0u) << options << parse_line(options).error;
  };
  refused(box + flow + slab + "-v_axis x -v_interval 0,.2",
          "-boundary_xmin: rigid bodies cover all of this inflow boundary; accepted: ");
  refused(box + flow + slab + "-v_axis x -v_interval .8,1",
          "-boundary_xmax: rigid bodies cover all boundaries through which");
  refused(box + flow + slab + "-v_axis y -v_interval 0,1",
          "-v_interval: the rigid slab fills all of the box and leaves no fluid; accepted: a part of 0,1");
  refused(
      "-time_end 1 -grid_cells 16,16,1 -boundary_xmin inflow -boundary_xmax inflow -boundary_xmin_velocity 1 "
      "-boundary_xmax_velocity -1 " +
          slab + "-v_axis y -v_interval 0,.2",
      "-boundary_xmin_velocity: rigid bodies cover a part of this boundary, and ");
  std::string numbers;  // where the profile is not 0 the side is closed
  for (int cell = 0; cell < 16; ++cell) numbers += cell < 4 ? "1\n" : "0\n";
  const TemporaryFile profile(numbers);
  refused(box + "-boundary_xmin_profile " + profile.path() + " " + slab + "-v_axis y -v_interval 0,.5",
          "-boundary_xmin: rigid bodies cover all of this");
}

// Obstacles hold back the flow, bodies shear it: by how much does not follow from the options.
TEST(CheckOnly, WhatItCannotKnowIsUnknown) {
  const auto says = [](const std::string &options) {
    const ParseResult result = parse_line("-time_end 2 -body_force .5,0,0 " + options);
    EXPECT_EQ(result.error, "");
    return check_report(result.config, 1);
  };
  const std::string ball = " -species a -a_shape sphere -a_radius .25 ", box = "-grid_cells 16,16,16 ";
  const std::string obstacle = says(box + ball + "-a_law rigid");
  for (const char *line : {"\nvelocity scale (estimate): less than 1\n", "\nshear rate (estimate): unknown\n",
                           "\nReynolds number: unknown (length 1)\n"})
    EXPECT_NE(obstacle.find(line), std::string::npos) << line << obstacle;
  const std::string cell = says(box + ball + "-a_shear_modulus 1");
  for (const char *line :
       {"\nvelocity scale (estimate): 1\n", "\nshear rate (estimate): unknown\n", "\nReynolds number: 1 (length 1)\n",
        "\ncapillary number of a: unknown (viscosity x shear rate / shear modulus)\n"})
    EXPECT_NE(cell.find(line), std::string::npos) << line << cell;
  EXPECT_NE(says(box).find("\nshear rate (estimate): 0\n"), std::string::npos) << "nothing touches this fluid";
  EXPECT_NE(says(box + "-fluid_viscosity 0").find("\nReynolds number: unknown (no viscosity)\n"), std::string::npos);
}

TEST(CheckOnly, LengthsAreTheLumens) {
  const auto says = [](const std::string &options) {
    const ParseResult result = parse_line("-time_end 100 -species v -v_shape tube -v_law rigid " + options);
    EXPECT_EQ(result.error, "");
    return check_report(result.config, 1);
  };
  // Two plates: U = f H^2/(8 nu) = .5, shear rate f H/(2 nu) = 1.
  const std::string plates = says("-grid_cells 16,16,1 -grid_length 4,4,1 -v_axis x -v_radius 1 -body_force 1,0,0");
  for (const char *line : {"\nvelocity scale (estimate): 0.5\n", "\nshear rate (estimate): 1\n", " (length 2)\n"})
    EXPECT_NE(plates.find(line), std::string::npos) << line << plates;
  const std::string circle = says(
      "-grid_cells 16,16,1 -grid_length 4,4,1 -v_axis z -v_radius 1.5 -initial_velocity "
      "uniform -initial_velocity_mean 1,0,0");
  EXPECT_NE(circle.find(" (length 3)\n"), std::string::npos) << circle;
}

TEST(CheckOnly, LengthsAreTheGapsBesideSlabs) {
  const auto length = [](const std::string &options) {
    const ParseResult result = parse_line(
        "-time_end 200 -grid_cells 16,32,1 -grid_length 4,8,1 -body_force 1e-2,0,0 -species a,b -a_shape slab -a_axis "
        "y -a_law rigid -b_shape slab -b_axis y " +
        options);
    EXPECT_EQ(result.error, "");
    const std::string text = check_report(result.config, 1);
    const std::size_t begin = text.find(" (length ");
    return begin == std::string::npos ? text : text.substr(begin, text.find('\n', begin) - begin);
  };
  const std::string rigid = "-b_law rigid ", wall = "-boundary_y wall ", below = "-a_interval -1,5 ";
  EXPECT_EQ(length(wall + rigid + below + "-b_interval 7,8"), " (length 2)");
  EXPECT_EQ(length(wall + "-b_shear_modulus 1 " + below + "-b_interval 7,8"), " (length 2)") << "elastic and anchored";
  EXPECT_EQ(length(wall + rigid + below + "-b_interval 5,5.5"), " (length 2.5)");
  EXPECT_EQ(length(wall + rigid + "-a_interval 3,4 -b_interval 6,6.5"), " (length 3)");
  EXPECT_EQ(length(rigid + "-a_interval 1,4 -b_interval 5,6"), " (length 3)") << "with its periodic image";
  EXPECT_EQ(length("-boundary_ymin wall -boundary_ymax symmetry " + rigid + "-a_interval 1,4 -b_interval 5,6.5"),
            " (length 3)")
      << "mirrored";
}

TEST(CheckOnly, HematocritIsOfCells) {
  const auto says = [](const std::string &options) {
    const ParseResult result = parse_line("-time_end 1 -grid_cells 16,16,1 " + options);
    EXPECT_EQ(result.error, "");
    return check_report(result.config, 1);
  };
  const std::string ball = "-species a -a_shape sphere -a_radius .25 ";
  for (const std::string &none :
       {std::string(), ball + "-a_law rigid",
        std::string("-species a -a_shape slab -a_axis y -a_interval 0,1 -a_shear_modulus 1")}) {
    const std::string report = says(none);
    EXPECT_EQ(report.find("hematocrit"), std::string::npos) << report;
    EXPECT_EQ(report.find("nan"), std::string::npos) << report;
  }
  EXPECT_NE(says(ball + "-a_shear_modulus 1").find("\nhematocrit: 0.19635\n"), std::string::npos);
}

TEST(CheckOnly, NoFlowIsSaid) {
  const std::string rest = "-time_end 2 -grid_cells 16,16,1",
                    body = " -species a -a_shape sphere -a_radius .2 -a_shear_modulus 1";
  const std::string report = check_report(parse_line(rest).config, 1);
  EXPECT_NE(report.find("\nflow: none (no force, pressure, moving wall, inlet or initial velocity)\n"),
            std::string::npos)
      << report;
  EXPECT_EQ(report.find("inf"), std::string::npos) << report;
  EXPECT_EQ(report.find("Reynolds"), std::string::npos) << report;
  EXPECT_NE(report.find("\ntime step (estimate): 2 (-time_end: nothing limits it)\nsteps (estimate): 1\n"),
            std::string::npos)
      << report;
  const std::string let_go = check_report(parse_line(rest + body + " -a_initial_stretch 2,.5,1").config, 1);
  EXPECT_NE(let_go.find("but for what stretched bodies"), std::string::npos) << let_go;
  EXPECT_EQ(check_report(parse_line(rest + body).config, 1).find("but for"), std::string::npos);
}

// The largest case of Sugiyama et al., HPCS 2013, is judged whatever PetscInt is, and by one rank.
TEST(CheckOnly, JudgesThePapersOwnSize) {
  const ParseResult paper = parse_line("-time_end 1 -grid_cells 24576,5184,5120 -check_only -ranks 82944");
  ASSERT_EQ(paper.error, "");
  const std::string report = check_report(paper.config, 82944);
  EXPECT_NE(report.find("= 652298158080\n"), std::string::npos) << report;
  EXPECT_EQ(report.find("64-bit") != std::string::npos, sizeof(PetscInt) == 4) << report;
  EXPECT_NE(report.find("\nV-cycle: "), std::string::npos) << report;
  for (const char *other : {" -method classic", " -pressure_solver smac", " -acm_coarse false"}) {
    const ParseResult without =
        parse_line("-time_end 1 -grid_cells 64,64,64 -check_only -ranks 8" + std::string(other));
    ASSERT_EQ(without.error, "") << other;
    EXPECT_EQ(check_report(without.config, 8).find("V-cycle"), std::string::npos) << other;
  }
}
