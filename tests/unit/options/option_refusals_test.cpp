// Every class of wrong input is refused in one line that names the option and what is accepted.
#include "base/petsc.hpp"
#include "options/help_text.hpp"
#include "options/renamed_options.hpp"
#include "support/refusals.hpp"

using namespace eulastic;
using namespace eulastic::test;

TEST(OptionRefusals, UnknownNames) {
  expect_refusals(
      {{"-grid_cels 8,8,8", {"-grid_cels", "nearest known: -grid_cells", "at least 3 in x and y"}},
       {"-cell_raduis 1", {"nearest known: -cell_radius"}},
       {"-time_ned 1", {"nearest known: -time_end"}},
       {"-grid_cells=8,8,8", {"-grid_cells=8,8,8", "nearest known: -grid_cells"}},
       {"--time_step 1", {"--time_step", "nearest known: -time_step"}},
       {"-Time_step 1", {"-Time_step", "nearest known: -time_step"}},
       {"-other_radius 1", {"unknown option -other_radius: -species does not list other; see -help"}},
       {"-end_time 1", {"nearest known: -time_end"}},
       {"-viscosity 1", {"nearest known: -fluid_viscosity"}},
       {"-dt 1", {"unknown option -dt; see -help"}},
       {"-ksp_type cg", {"unknown option -ksp_type; accepted with -pressure_solver ksp: -pressure_ksp_type"}},
       {"-log_vew", {"nearest known: -log_view"}},
       {"-log_view log.txt", {"-log_view: \"log.txt\" is not a viewer", ":FILE"}},
       {"-options_file x", {"-options_file"}},
       {"-log", {"unknown option -log"}},
       {"-log_", {"unknown option -log_"}},
       {"-NAME_radius 1", {"unknown option -NAME_radius"}}});
}

// What we cannot do is answered by that, and not by the nearest spelling; what is near in spelling, by that.
TEST(OptionRefusals, WhatThereIsNot) {
  const std::string read = "; see README.md, \"What it does not do\"";
  expect_refusals(
      {{"-cell_density 2", {"unknown option -cell_density: \"density\" is not supported: bodies have", read}},
       {"-gravity 0,-9.81,0", {"\"gravity\" is not supported", "-body_force", read}},
       {"-inlet_velocity 1,0,0",
        {"unknown option -inlet_velocity: \"inlet\" is called inflow here: -boundary_xmin inflow"}},
       {"-outlet_pressure 1", {"\"outlet\" is called outflow here", "-boundary_xmax pressure"}},
       {"-boundary_xmin inlet", {"-boundary_xmin", "\"inlet\" is called inflow here", "one of same, wall"}},
       {"-cell_law casson", {"-cell_law", "\"casson\" is not supported: the fluid is Newtonian", "one of neo_hookean"}},
       {"-cell_law power_law", {"-cell_law", "\"power law\" is not supported: the fluid is Newtonian", read}},
       {"-cell_law skalak",
        {"-cell_law", "\"skalak\" is a law of membranes: -NAME_law membrane with -NAME_membrane_law skalak"}},
       {"-vec_type cuda", {"-vec_type: \"cuda\" runs on graphics processors; accepted: types that run on processors"}},
       {"-dm_mat_type aijcusparse", {"-dm_mat_type", "graphics processors"}},
       {"-cell_torque 1,0,0", {"\"torque\" is not supported", "-NAME_law rigid", read}},
       {"-cell_shell_thickness 1", {"\"shell\" is not supported", "-NAME_law membrane", read}},
       {"-surfactant 1", {"\"surfactant\" is not supported", "-NAME_surface_tension", read}},
       {"-boundary_x outflow", {"-boundary_x", "\"outflow\" is not a choice", "one of periodic, wall"}},
       {"-density 1", {"nearest known: -fluid_density"}},
       {"-surface_tension 1", {"nearest known: -cell_surface_tension"}},
       {"-fluid_viscosty 1", {"nearest known: -fluid_viscosity"}},
       {"-boundary_top_velocity 1,0,0", {"nearest known: -boundary_"}}});
}

// Former names are refused with the present one.
TEST(OptionRefusals, FormerNames) {
  expect_refusals({{"-wall_ymax_velocity 1,0,0",
                    {"unknown option -wall_ymax_velocity: it is now called "
                     "-boundary_ymax_velocity; docs/options.md lists all former names"}},
                   {"-inflow_zmin_feeder 3", {"it is now called -boundary_zmin_generator_length"}},
                   {"-pressure_xmax_table f.csv", {"it is now called -boundary_xmax_pressure"}},
                   {"-body_force_frequency 1", {"it is now called -body_force_angular_frequency"}},
                   {"-Cell_body_force_frequency 1", {"it is now called -Cell_body_force_angular_frequency"}},
                   {"-cell_angular_velocity_frequency 1", {"called -cell_angular_velocity_angular_frequency"}},
                   {"-cell_membrane skalak", {"it is now called -cell_membrane_law"}},
                   {"-acm_memory 1", {"it is now called -acm_search_directions"}},
                   {"-balance", {"it is now called -load_balance"}}});
  const std::string help = help_markdown(), former = "\n## Former names\n";
  ASSERT_NE(help.find(former), std::string::npos);
  const std::string present = help.substr(0, help.find(former));
  for (const RenamedOption &option : renamed_options()) {
    EXPECT_NE(present.find("| `-" + option.now + "` |"), std::string::npos) << option.now;
    EXPECT_EQ(present.find("`-" + option.former + "`"), std::string::npos) << option.former;
  }
}

// A word instead of 0, which means the same.
TEST(OptionRefusals, WordsForZero) {
  for (const char *pair : {"-time_step auto 0", "-time_steps_max unlimited 0", "-snapshot_interval off 0",
                           "-guard_cfl off 0", "-ranks auto 0", "-da_processors_x auto 0", "-guard_memory off 0"}) {
    const Words given = words(pair);
    const ParseResult word = parse_line(scene + " " + given[0] + " " + given[1]),
                      zero = parse_line(scene + " " + given[0] + " " + given[2]);
    EXPECT_EQ(word.error, "");
    EXPECT_EQ(options_text(word), options_text(zero));
    EXPECT_NE(options_text(zero).find("\n" + given[0] + " " + given[1] + "\n"), std::string::npos) << pair;
  }
  expect_refusals({{"-time_step off", {"-time_step", "auto, or a number > 0"}},
                   {"-guard_cfl auto", {"-guard_cfl", "off, or a number > 0"}}});
}

TEST(OptionRefusals, PetscIsSilentAfterAnError) {
  EXPECT_TRUE(parse_line("-log_view -nonsense").petsc.empty());
  EXPECT_TRUE(parse_line("-log_view -help").petsc.empty());
}

TEST(OptionRefusals, Duplicates) {
  expect_refusals({{"-time_end 2", {"-time_end", "given twice"}},
                   {"-cell_diameter 4", {"-cell_diameter", "given twice, also as -cell_radius"}},
                   {"-check_only -check_only", {"-check_only", "given twice"}},
                   {"-snapshot_fields body,body", {"-snapshot_fields", "\"body\" is given twice"}}});
}

TEST(OptionRefusals, MissingValues) {
  expect_refusals({{"-time_step", {"-time_step", "a value is missing", "auto, or a number > 0"}},
                   {"-time_step -check_only", {"-time_step", "a value is missing"}},
                   {"-output_dir", {"-output_dir", "a value is missing"}}});
  Words list = words(scene);
  list.push_back("-output_dir");
  list.push_back("");
  EXPECT_NE(parse(list).error.find("a value is missing"), std::string::npos);
  expect_refusals({{"-species", {"-species", "a value is missing"}}}, "-time_end 1");
}

TEST(OptionRefusals, Contact) {
  const std::string two = "-cell_contact separate -cell_placement lattice -cell_count 2,1,1 ";
  expect_refusals({{"-cell_contact maybe", {"-cell_contact", "separate, merge"}},
                   {two + "-body_series false", {"-cell_contact", "-body_series true", "merge"}},
                   {two + "-method classic", {"-cell_contact", "-interface_scheme plic", "-method fast", "merge"}}});
  const std::string bare = "-time_end 1 -species cell " + two;
  EXPECT_NE(parse_line(bare + "-cell_shape cylinder -cell_radius .1 -cell_shear_modulus 1")
                .error.find("-cell_contact: separate needs -cell_shape sphere, biconcave or ellipsoid"),
            std::string::npos);
  for (const char *fine : {"-cell_contact separate", "-cell_contact merge -body_series false", "-cell_contact merge",
                           "-cell_contact separate -method classic"})
    EXPECT_EQ(parse_line(scene + " " + fine).error, "") << fine;
}

TEST(OptionRefusals, Lists) {
  expect_refusals({{"-body_force 1,,2", {"-body_force", "empty item", "3 numbers"}},
                   {"-body_force ,1,2", {"empty item"}},
                   {"-body_force 1,2,", {"empty item"}},
                   {"-body_force 1,2", {"-body_force", "2 items", "3 numbers"}},
                   {"-body_force 1,2,3,4", {"4 items"}},
                   {"-time_step 1,2", {"-time_step", "2 items"}},
                   {"-body_force 1, 2, 3", {"stray word \"3\"", "lists without spaces"}},
                   {"-body_force 1,2, 3", {"options file 3", "lists without spaces"}},
                   {"-snapshot_fields body,", {"-snapshot_fields", "empty item"}},
                   {"-snapshot_fields body,velocty", {"-snapshot_fields", "\"velocty\"", "velocity"}}});
}

TEST(OptionRefusals, Numbers) {
  for (const char *bad : {"1x", "x", "nan", "-nan", "NaN", "inf", "-inf", "Infinity", "1e999", "0x10", "1.2.3", "1e",
                          "--1", "+-1", "1 ", "1;2", "1d0", "-"}) {
    const ParseResult result = parse([&] {
      Words list = words(scene);
      list.push_back("-body_force_phase");
      list.push_back(bad);
      return list;
    }());
    EXPECT_NE(result.error.find("-body_force_phase"), std::string::npos) << bad << ": " << result.error;
  }
  expect_refusals({{"-time_steps_max 1.5", {"-time_steps_max", "\"1.5\" is not an integer", "an integer"}},
                   {"-time_steps_max 1e3", {"not an integer"}},
                   {"-time_steps_max 99999999999999999999", {"does not fit"}},
                   {"-da_processors_x 4294967297", {"-da_processors_x", "does not fit"}},
                   {"-boundary_ymin_velocity nan,0,0", {"-boundary_ymin_velocity", "not finite"}},
                   {"-boundary_ymin_velocity -inf,0,0", {"-boundary_ymin_velocity", "not finite"}}});
}

TEST(OptionRefusals, Ranges) {
  expect_refusals({{"-fluid_density 0", {"-fluid_density", "out of range", "a number > 0"}},
                   {"-fluid_viscosity -1", {"-fluid_viscosity", "a number >= 0"}},
                   {"-time_step -1", {"-time_step", "out of range"}},
                   {"-time_steps_max -1", {"-time_steps_max", "out of range"}},
                   {"-series_interval -1", {"-series_interval", "out of range"}},
                   {"-da_processors_x -1", {"-da_processors_x", "out of range"}},
                   {"-cell_initial_stretch 1,0,1", {"-cell_initial_stretch", "out of range"}},
                   {"-boundary_ymin_angular_frequency -1", {"-boundary_ymin_angular_frequency", "out of range"}},
                   {"-method slow", {"-method", "\"slow\"", "classic"}},
                   {"-pressure_solver ACM", {"-pressure_solver", "one of acm, smac, ksp"}},
                   {"-fluid_inertia maybe", {"-fluid_inertia", "true or false"}},
                   {"-check_only 2", {"-check_only", "true or false"}},
                   {"-boundary_x open", {"-boundary_x", "one of periodic, wall, symmetry"}},
                   {"-initial_velocity vortex", {"-initial_velocity", "taylor_green"}}});
  expect_refusals({{"-grid_cells 0,8,8", {"-grid_cells", "out of range"}},
                   {"-grid_cells 8,8,2", {"-grid_cells", "at least 3"}},
                   {"-grid_cells 2,8,1", {"-grid_cells", "at least 3"}},
                   {"-grid_length 1,0,1", {"-grid_length", "out of range"}},
                   {"-grid_length 1,1001,1", {"-grid_length", "1001 times", "at most 1000"}},
                   {"-time_step 1e-16", {"-time_step", "1e-16", "1.1102230246251565e-16"}}},
                  "-time_end 1");
  if (sizeof(PetscInt) == 4) expect_refusals({{"-grid_cells 65536,65536,8", {"-grid_cells", "64-bit"}}}, "-time_end 1");
  expect_refusals({{"-time_end 0", {"-time_end", "out of range"}}, {"-threads 1", {"-time_end", "must be given"}}}, "");
}

TEST(OptionRefusals, StrayWords) {
  expect_refusals({{"-body_force 1,0,0 -time_step 1 2 3", {}},
                   {"word another", {"stray word \"another\""}},
                   {"no_such_file.opts", {"no_such_file.opts", "cannot be read"}},
                   {"/", {"options file / cannot be read"}}});
  Words list = words(scene);
  list.push_back("");
  EXPECT_NE(parse(list).error.find("stray word"), std::string::npos);
  EXPECT_NE(parse_line(scene, "word").error.find("PETSC_OPTIONS"), std::string::npos);
}

TEST(OptionRefusals, SpeciesNames) {
  for (const char *name :
       {"wall",   "fluid",   "body",   "time",     "grid",    "boundary", "initial", "output", "snapshot",
        "series", "species", "method", "pressure", "check",   "help",     "version", "da",     "log",
        "mat",    "vec",     "info",   "malloc",   "options", "grid_a",   "Wall"}) {
    const ParseResult result = parse_line(std::string("-time_end 1 -species ") + name);
    EXPECT_NE(result.error.find(std::string("-species: \"") + name + "\" collides"), std::string::npos)
        << name << ": " << result.error;
  }
  expect_refusals({{"-species a,b,a", {"-species", "\"a\" is given twice"}},
                   {"-species a,,b", {"-species", "empty item"}},
                   {"-species 1a", {"-species", "\"1a\" is not a name"}},
                   {"-species a-b", {"-species", "\"a-b\" is not a name"}},
                   {"-species a.b", {"-species", "not a name"}},
                   {"-species a", {"-a_shape", "must be given"}}},
                  "-time_end 1");
  const std::string two = "-time_end 1 -species a,a_shear -a_shape sphere -a_radius .1 -a_shear_modulus 1 ";
  EXPECT_EQ(parse_line(two + "-a_shear_shape sphere -a_shear_radius .2 -a_shear_shear_modulus 2").error, "");
}

TEST(OptionRefusals, InconsistentScenes) {
  expect_refusals(
      {{"-boundary_ymin_velocity 0,1,0", {"-boundary_ymin_velocity", "normal"}},
       {"-boundary_xmin_velocity 0,1,0", {"-boundary_xmin_velocity", "-boundary_x wall"}},
       {"-boundary_xmax_angular_frequency 1", {"-boundary_xmax_angular_frequency", "-boundary_x wall"}},
       {"-boundary_xmin wall", {"-boundary_xmin", "a single boundary cannot be periodic", "-boundary_xmax"}},
       {"-boundary_xmin periodic", {"-boundary_xmin", "one of same, wall, symmetry"}},
       {"-boundary_ymin symmetry -boundary_ymin_velocity 1,0,0", {"-boundary_ymin_velocity", "-boundary_y wall"}},
       {"-boundary_ymax symmetry -initial_velocity couette", {"-initial_velocity", "-boundary_y wall"}},
       {"-initial_velocity_amplitude 2", {"-initial_velocity_amplitude", "-initial_velocity"}},
       {"-pressure_pc_type mg", {"-pressure_pc_type", "-pressure_solver ksp"}},
       {"-pressure_solver smac -pressure_ksp_view", {"-pressure_ksp_view", "-pressure_solver ksp"}},
       {"-initial_velocity_mean 0,1,0", {"-initial_velocity_mean", "closed"}},
       {"-cell_interval 1,2", {"-cell_interval", "-cell_shape slab"}},
       {"-cell_axis x", {"-cell_axis"}},
       {"-cell_count 1,1,1", {"-cell_count", "-cell_placement lattice"}},
       {"-cell_placement list", {"-cell_positions", "must be given"}},
       {"-cell_positions x.csv", {"-cell_positions", "-cell_placement list"}},
       {"-cell_placement list -cell_positions no_such.csv", {"-cell_positions", "no_such.csv"}},
       {"-cell_placement list -cell_positions /", {"-cell_positions"}},
       {"-cell_placement lattice -cell_count 17,16,16", {"-cell_count", "4352", "at most 4096, one per cell"}},
       {"-cell_placement lattice -cell_count 1,9,1", {"-cell_count: ", "wall", "accepted: "}},
       {"-cell_centre 4,1,4", {"-cell_centre: ", "wall", "accepted: "}},
       {"-cell_centre 40,4,4", {"-cell_centre: ", "outside", "accepted: "}}});
  const std::string periodic = "-time_end 1 -grid_cells 8,8,8 ";
  expect_refusals({{"-initial_velocity couette", {"-initial_velocity", "-boundary_y wall"}},
                   {"-initial_velocity poiseuille", {"-boundary_y wall"}}},
                  periodic);
  const std::string material = "-species a -a_shear_modulus 1 ";
  expect_refusals({{"-a_shape sphere", {"-a_radius", "must be given"}},
                   {"-a_shape sphere -a_radius 0", {"-a_radius", "out of range"}},
                   {"-a_shape sphere -a_diameter 0", {"-a_diameter", "out of range"}},
                   {"-a_shape sphere -a_radius 3", {"-a_shape: ", "long", "accepted: "}},
                   {"-a_shape ellipsoid", {"-a_semi_axes", "must be given"}},
                   {"-a_shape ellipsoid -a_semi_axes 1,-1,1", {"-a_semi_axes", "out of range"}},
                   {"-a_shape slab", {"-a_interval", "must be given"}},
                   {"-a_shape slab -a_interval .5,.2", {"-a_interval", "below"}},
                   {"-a_shape slab -a_interval .5,.5", {"-a_interval", "below"}},
                   {"-a_shape slab -a_interval 1.5,2", {"-a_interval", "outside"}},
                   {"-a_shape slab -a_interval 0,.5 -a_radius 1", {"-a_radius", "-a_shape sphere"}},
                   {"-a_shape slab -a_interval 0,.5 -a_centre 0,0,0", {"-a_centre"}},
                   {"-a_shape cube", {"-a_shape", "sphere, biconcave"}}},
                  periodic + material);
  expect_refusals(
      {{"-species a -a_shape sphere -a_radius .1", {"-a_shear_modulus", "must be given"}},
       {"-species a -a_shape sphere -a_radius .1 -a_shear_modulus -1", {"-a_shear_modulus", "out of range"}},
       {"-species a -a_shape sphere -a_radius .1 -a_shear_modulus 1 -a_viscosity 0", {"-a_viscosity", "> 0"}},
       {"-species a -a_shape sphere -a_radius .1 -a_shear_modulus 1 -a_viscosity -2", {"-a_viscosity", "> 0"}},
       {"-species a -a_shape sphere -a_radius .1 -a_shear_modulus 0 -a_surface_tension -1",
        {"-a_surface_tension", ">= 0"}},
       {"-species a -a_shape sphere -a_radius .1 -a_shear_modulus 0 -a_surface_tension 1 -interface_scheme weno5",
        {"-a_surface_tension", "-interface_scheme plic"}},
       {"-species a -a_shape sphere -a_radius .1 -a_shear_modulus 1 -a_viscosity 2 -fluid_viscosity 0",
        {"-a_viscosity", "-fluid_viscosity > 0"}}},
      periodic);
  expect_refusals(
      {{"-a_law rubber", {"-a_law", "neo_hookean, mooney_rivlin"}},
       {"-a_law membrane", {"-a_surface_shear_modulus", "must be given"}},
       {"-a_law membrane -a_surface_shear_modulus 0", {"-a_surface_shear_modulus", "> 0"}},
       {"-a_law membrane -a_surface_shear_modulus 1 -a_skalak_c -1", {"-a_skalak_c", ">= 0"}},
       {"-a_law membrane -a_surface_shear_modulus 1 -method classic", {"-a_law", "-method fast"}},
       {"-a_law membrane -a_surface_shear_modulus 1 -a_anchored true", {"-a_law", "a closed surface"}},
       {"-a_law membrane -a_surface_shear_modulus 1 -a_shear_modulus 1", {"-a_shear_modulus", "neo_hookean"}},
       {"-a_law membrane -a_surface_shear_modulus 1 -a_stretch_force -1", {"-a_stretch_force", ">= 0"}},
       {"-a_law membrane -a_surface_shear_modulus 1 -a_stretch_volume_fraction .6",
        {"-a_stretch_volume_fraction", "> 0 and <= 0.5"}},
       {"-a_law membrane -a_surface_shear_modulus 1 -a_stretch_force 1 -body_series false",
        {"-a_stretch_force", "-body_series true"}},
       {"-a_law membrane -a_surface_shear_modulus 1 -a_stretch_volume_fraction .1",
        {"-a_stretch_volume_fraction", "-a_stretch_force > 0, or 0.02"}},
       {"-a_shear_modulus 1 -a_stretch_force 1", {"-a_stretch_force", "-a_law membrane or red_cell"}},
       {"-a_shear_modulus 1 -a_initial_stretch 2,1,1", {"-a_initial_stretch", "product", "is 2", "within 0.001"}},
       {"-a_law rigid -a_shear_modulus 1", {"-a_shear_modulus", "-a_law neo_hookean"}},
       {"-a_law rigid -a_viscosity 1", {"-a_viscosity", "-a_law neo_hookean or"}},
       {"-a_law rigid -a_body_force 1,0,0", {"-a_body_force", "-a_law neo_hookean or"}},
       {"-a_law rigid -a_surface_tension 1", {"-a_surface_tension", "-a_law neo_hookean or"}},
       {"-a_law rigid -a_contact separate", {"-a_contact", "-a_law neo_hookean or"}},
       {"-a_law rigid -a_initial_stretch 2,1,1", {"-a_initial_stretch", "-a_law neo_hookean or"}},
       {"-a_law rigid -a_velocity 1,0,0 -method classic", {"-a_velocity", "-method fast"}},
       {"-a_shear_modulus 1 -a_angular_velocity 1,0,0", {"-a_angular_velocity", "-a_law rigid"}},
       {"-a_shear_modulus 1 -a_membrane_law skalak", {"-a_membrane_law", "-a_law membrane or red_cell"}},
       {"-a_law membrane -a_surface_shear_modulus 1 -a_skalak_c 1", {"-a_skalak_c", "-a_membrane_law skalak"}},
       {"-a_law mooney_rivlin", {"-a_c1", "must be given"}},
       {"-a_law mooney_rivlin -a_c1 -1", {"-a_c1", "out of range"}},
       {"-a_law mooney_rivlin -a_c1 1 -a_shear_modulus 2", {"-a_shear_modulus", "-a_law neo_hookean"}},
       {"-a_shear_modulus 2 -a_c3 1", {"-a_c3", "-a_law mooney_rivlin"}}},
      periodic + "-species a -a_shape sphere -a_radius .1 ");
}

TEST(OptionRefusals, TwoDimensions) {
  const std::string flat = "-time_end 1 -grid_cells 8,8,1 -boundary_y wall ";
  EXPECT_EQ(parse_line(flat + "-species a -a_shape sphere -a_radius .2 -a_centre .5,.5,9 -a_shear_modulus 1").error,
            "");
  expect_refusals(
      {{"-boundary_z wall", {"-boundary_z", "more than one cell"}},
       {"-boundary_zmin wall -boundary_zmax symmetry", {"-boundary_z", "more than one cell"}},
       {"-body_force 0,0,1", {"-body_force", "2-D"}},
       {"-species a -a_shape sphere -a_radius .2 -a_shear_modulus 1 -a_body_force 0,0,1", {"-a_body_force", "2-D"}},
       {"-boundary_ymin_velocity 0,0,1", {"-boundary_ymin_velocity", "2-D"}},
       {"-initial_velocity_mean 0,0,1", {"-initial_velocity_mean", "2-D"}},
       {"-initial_velocity shear_wave_xz", {"-initial_velocity", "more than one cell"}},
       {"-initial_velocity taylor_green_3d", {"-initial_velocity", "more than one cell"}},
       {"-species a -a_shape sphere -a_radius .1 -a_shear_modulus 0 -a_initial_stretch 2,.5,1",
        {"-a_initial_stretch", "without a modulus", "-a_shear_modulus > 0"}},
       {"-species a -a_shape sphere -a_radius .1 -a_shear_modulus 1 -a_initial_stretch 1,1,2",
        {"-a_initial_stretch", "2-D"}},
       {"-species a -a_shape sphere -a_radius .1 -a_shear_modulus 1 -a_initial_stretch 2,1,1",
        {"-a_initial_stretch", "product", "within 0.001"}},
       {"-species a -a_shape sphere -a_radius .1 -a_shear_modulus 1 -a_placement lattice -a_count 1,1,2",
        {"-a_count", "2-D"}},
       {"-species a -a_shape sphere -a_radius .1 -a_shear_modulus 1 -a_placement random -a_count 1,1,2",
        {"-a_count", "random", "an integer"}}},
      flat);
}

TEST(OptionRefusals, ErrorsNameTheirSource) {
  const auto error = [](const std::string &text) {
    const TemporaryFile file(text);
    const std::string message = parse({file.path()}).error;
    return message.find(file.path()) == std::string::npos ? "no path in: " + message : message;
  };
  EXPECT_NE(error("-time_end 1\n-time_step 1x\n").find(":2)"), std::string::npos);
  EXPECT_NE(error("-time_end 1\n-time_end 2\n").find("given twice"), std::string::npos);
  EXPECT_NE(error("-time_end 1\nword\n").find("stray word \"word\""), std::string::npos);
  EXPECT_NE(error("\xEF\xBB\xBF-time_end 1\nword\n").find("stray word \"word\""), std::string::npos);
  EXPECT_NE(error("-time_end 1 2\n").find("stray word \"2\""), std::string::npos);
  EXPECT_NE(error("-body_force 1, 2, 3\n").find(":1)"), std::string::npos);
  EXPECT_NE(error("-output_dir \"a\n").find("quote"), std::string::npos);
  EXPECT_NE(error("-help\n").find("only on the command line"), std::string::npos);
  EXPECT_NE(error("-boundary_xmin_velocity 0,1,0\n-time_end 1\n").find(":1)"), std::string::npos);
  EXPECT_NE(parse_line("-time_end 1", "-time_step x").error.find("in PETSC_OPTIONS"), std::string::npos);
  EXPECT_EQ(parse({"-x\ny"}).error.find('\n'), std::string::npos);
}

// Found by tests/fuzz.
TEST(OptionRefusals, LongWords) {
  for (const char *option : {"-initial_state", "-restart", "-cell_jitter"})
    for (std::size_t length : {300, 5000}) {
      const std::string error = parse_line(scene + " " + option + " " + std::string(length, 'a')).error;
      EXPECT_NE(error.find(option), std::string::npos) << error;
      EXPECT_LT(error.size(), 1100u);
    }
}
