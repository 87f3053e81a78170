// From the command line to a Config and back: what is accepted, where it arrives, which source wins.
#include "options/help_text.hpp"
#include "options/option_source.hpp"
#include "options/option_table.hpp"
#include "scene/check_only.hpp"
#include "support/command_line.hpp"

#include <regex>
#include <set>

using namespace eulastic;

TEST(Options, SidesAreThoseOfTheDirectionUnlessToldOtherwise) {
  const ParseResult result = parse_line(
      "-time_end 1 -grid_cells 8,8,8 -boundary_y wall -boundary_ymax symmetry -boundary_ymin_velocity 1,0,0 "
      "-boundary_zmin "
      "wall "
      "-boundary_zmax symmetry");
  ASSERT_EQ(result.error, "");
  const Config &c = result.config;
  EXPECT_EQ(c.grid.boundary, (std::array<Boundary, 3>{Boundary::periodic, Boundary::wall, Boundary::wall}));
  for (const int d : {1, 2}) {
    EXPECT_EQ(c.sides[d][0].kind, BoundaryKind::wall);
    EXPECT_EQ(c.sides[d][1].kind, BoundaryKind::symmetry);
  }
  const Config both = parse_line("-time_end 1 -grid_cells 8,8,8 -boundary_x symmetry").config;
  EXPECT_EQ(both.grid.boundary[0], Boundary::wall);
  for (const BoundaryCondition &side : both.sides[0]) EXPECT_EQ(side.kind, BoundaryKind::symmetry);
}

TEST(Options, ValuesArrive) {
  const ParseResult result = parse_line(
      "-grid_cells 32,16,8 -grid_length 4,2.5,1e1 -boundary_x periodic -boundary_y wall -boundary_z wall "
      "-da_processors_y 2 -boundary_ymax_velocity 1,0,-2 -boundary_ymax_angular_frequency 3 -boundary_zmin_phase .5 "
      "-fluid_density 2 "
      "-fluid_viscosity 0.1 -fluid_inertia no -body_force -1,2e-4,+3 -body_force_angular_frequency 6 -body_force_phase "
      "-1 "
      "-initial_velocity shear_wave_xy -initial_velocity_amplitude -1.5 -initial_velocity_mean 1,0,0 -species a,b_2 "
      "-a_shape biconcave -a_diameter 1 -a_axis z -a_shear_modulus 7 -a_placement lattice -a_count 2,1,1 "
      "-b_2_shape slab -b_2_interval -1,1.2 -b_2_shear_modulus 1 -b_2_initial_stretch 2,1,.5 "
      "-method classic -pressure_solver acm -time_end 10 -time_step .01 -time_steps_max 99 -output_dir out/a "
      "-output_overwrite -snapshot_interval 2 -snapshot_fields pressure,left_cauchy_green -snapshot_precision double "
      "-series_interval 3");
  ASSERT_EQ(result.error, "");
  const Config &c = result.config;
  EXPECT_EQ(c.grid.cells, (Int3{32, 16, 8}));
  EXPECT_EQ(c.grid.length, (Real3{4, 2.5, 10}));
  EXPECT_EQ(c.grid.boundary, (std::array<Boundary, 3>{Boundary::periodic, Boundary::wall, Boundary::wall}));
  EXPECT_EQ(c.grid.processors, (Int3{0, 2, 0}));
  EXPECT_EQ(c.sides[1][1].motion.velocity, (Real3{1, 0, -2}));
  EXPECT_EQ(c.sides[1][1].motion.frequency, 3);
  EXPECT_EQ(c.sides[2][0].motion.phase, 0.5);
  EXPECT_EQ(c.fluid.density, 2);
  EXPECT_EQ(c.fluid.viscosity, 0.1);
  EXPECT_FALSE(c.fluid.inertia);
  EXPECT_EQ(c.fluid.body_force.force, (Real3{-1, 2e-4, 3}));
  EXPECT_EQ(c.fluid.body_force.frequency, 6);
  EXPECT_EQ(c.fluid.body_force.phase, -1);
  EXPECT_EQ(c.initial.kind, InitialVelocity::shear_wave_xy);
  EXPECT_EQ(c.initial.amplitude, -1.5);
  EXPECT_EQ(c.initial.mean, (Real3{1, 0, 0}));
  ASSERT_EQ(c.species.size(), 2u);
  EXPECT_EQ(c.species[0].name, "a");
  EXPECT_EQ(c.species[0].shape, Shape::biconcave);
  EXPECT_EQ(c.species[0].radius, 0.5);
  EXPECT_EQ(c.species[0].axis, 2);
  EXPECT_EQ(c.species[0].shear_modulus, 7);
  EXPECT_EQ(c.species[0].placement, Placement::lattice);
  EXPECT_EQ(c.species[0].count, (Int3{2, 1, 1}));
  EXPECT_EQ(c.species[1].shape, Shape::slab);
  EXPECT_EQ(c.species[1].interval, (std::array<double, 2>{-1, 1.2}));
  EXPECT_EQ(c.species[1].initial_stretch, (Real3{2, 1, 0.5}));
  EXPECT_EQ(c.method.pressure, PressureKind::acm);
  EXPECT_EQ(c.time.end, 10);
  EXPECT_EQ(c.time.step, 0.01);
  EXPECT_EQ(c.time.steps_max, 99);
  EXPECT_EQ(c.output.directory, "out/a");
  EXPECT_TRUE(c.output.overwrite);
  EXPECT_EQ(c.output.snapshot_interval, 2);
  EXPECT_EQ(c.output.snapshot_fields, (Words{"pressure", "left_cauchy_green"}));
  EXPECT_FALSE(c.output.snapshot_single);
  EXPECT_EQ(c.output.series_interval, 3);
  EXPECT_FALSE(c.check_only);
}

TEST(Options, Defaults) {
  const ParseResult result = parse_line(scene);
  ASSERT_EQ(result.error, "");
  const Config &c = result.config;
  EXPECT_EQ(c.fluid.density, 1);
  EXPECT_EQ(c.fluid.viscosity, 1);
  EXPECT_TRUE(c.fluid.inertia);
  EXPECT_EQ(c.initial.kind, InitialVelocity::zero);
  EXPECT_FALSE(c.species[0].centre_given);
  EXPECT_EQ(c.species[0].centre, (Real3{4, 4, 4}));
  EXPECT_EQ(c.output.directory, "output");
  EXPECT_FALSE(c.output.overwrite);
  EXPECT_EQ(c.output.series_interval, 0.01);
  EXPECT_EQ(petsc_arguments(result.petsc), (Words{"-skip_petscrc"}));
  EXPECT_TRUE(parse_line(scene + " -cell_centre 4,4,4").config.species[0].centre_given);
}

// What -help prints, and what a run uses that was not told otherwise.
TEST(Options, HelpHasTheDefaultsThatAreUsed) {
  for (const std::string method : {"fast", "classic"}) {
    ParseResult result = parse_line(
        "-time_end 1 -species NAME -NAME_shape sphere -NAME_radius .1 -NAME_shear_modulus 1 "
        "-method " +
        method);
    ASSERT_EQ(result.error, "");
    Config fresh;
    fresh.species.resize(1);
    fresh.species[0].name = "NAME";
    const std::vector<Option> used = option_table(result.config), said = option_table(fresh);
    ASSERT_EQ(used.size(), said.size());
    int compared = 0;
    for (std::size_t r = 0; r < said.size(); ++r) {
      const std::string &note = said[r].default_note;
      if (said[r].required || !said[r].text || said[r].name == "method" || said[r].name == "species") continue;
      if (!note.empty() && said[r].group != "Method") continue;
      std::string text = note.empty() ? said[r].text() : note;
      if (const std::size_t at = text.find("; "); at != std::string::npos)
        text = method == "fast" ? text.substr(0, at) : text.substr(at + 2, text.find(" with") - at - 2);
      EXPECT_EQ(used[r].text(), text) << said[r].name;
      ++compared;
    }
    EXPECT_GT(compared, 70);
  }
}

TEST(Options, Booleans) {
  for (const char *yes : {"", "true", "yes", "1"})
    EXPECT_TRUE(parse_line(scene + " -output_overwrite " + yes + " -check_only false").config.output.overwrite) << yes;
  for (const char *no : {"false", "no", "0"}) {
    const ParseResult result = parse_line(scene + " -output_overwrite true -fluid_inertia " + no);
    EXPECT_EQ(result.error, "");
    EXPECT_FALSE(result.config.fluid.inertia) << no;
  }
}

TEST(Options, PetscOptionsPassThrough) {
  const ParseResult result = parse_line(
      scene + " -log_view :log.txt -pressure_solver ksp -pressure_ksp_type cg -info -malloc_debug -memory_view",
      "-mat_stash_initial_size 9");
  ASSERT_EQ(result.error, "");
  EXPECT_EQ(petsc_arguments(result.petsc),
            (Words{"-skip_petscrc", "-info", "-log_view", ":log.txt", "-malloc_debug", "-mat_stash_initial_size", "9",
                   "-memory_view", "-pressure_ksp_type", "cg"}));
}

TEST(Options, SourcesAndPrecedence) {
  const TemporaryFile file(
      "# a case\n-time_end 3   # end\n\n  -fluid_viscosity 2\r\n-fluid_density 2\n-fluid_inertia\n"
      "-output_dir \"a b\"\n-log_view\n");
  ParseResult result = parse({"-fluid_viscosity", "5", file.path()}, "-fluid_density 3 -fluid_viscosity 4");
  ASSERT_EQ(result.error, "");
  EXPECT_EQ(result.config.time.end, 3);
  EXPECT_EQ(result.config.fluid.density, 3);
  EXPECT_EQ(result.config.fluid.viscosity, 5);
  EXPECT_EQ(result.config.output.directory, "a b");
  EXPECT_EQ(petsc_arguments(result.petsc), (Words{"-skip_petscrc", "-log_view"}));
  // The file may stand behind options that need no value.
  EXPECT_EQ(parse({"-check_only", file.path()}).error, "");
  EXPECT_EQ(parse({"-log_view", file.path()}).error, "");
  EXPECT_NE(parse({file.path(), file.path()}).error.find("stray word"), std::string::npos);
}

TEST(Options, ADiameterOverridesTheRadiusOfTheFile) {
  const TemporaryFile file("-time_end 1\n-species a\n-a_shape sphere\n-a_radius 0.25\n-a_shear_modulus 1\n");
  const ParseResult result = parse({file.path(), "-a_diameter", "0.25"});
  ASSERT_EQ(result.error, "");
  EXPECT_EQ(result.config.species[0].radius, 0.125);
}

TEST(Options, AFileBringsInAnotherAndWins) {
  const TemporaryFile base("-time_end 1\n-fluid_density 2\n-fluid_viscosity 3\n");
  const std::string name = base.path().substr(base.path().rfind('/') + 1);  // beside it, wherever we are
  const TemporaryFile middle("-fluid_viscosity 4\n-options_file " + name + "\n-body_force_phase 5\n");
  const TemporaryFile top("-options_file \"" + middle.path() + "\"\n-body_force_phase 6\n");
  const ParseResult result = parse({top.path(), "-time_end", "7"}, "-time_step 8");
  ASSERT_EQ(result.error, "");
  EXPECT_EQ(result.config.fluid.density, 2);
  EXPECT_EQ(result.config.fluid.viscosity, 4);
  EXPECT_EQ(result.config.fluid.body_force.phase, 6);
  EXPECT_EQ(result.config.time.end, 7);
  EXPECT_EQ(result.config.time.step, 8);
  EXPECT_EQ(options_text(result).find("options_file"), std::string::npos);

  const auto error = [](const std::string &text) {
    const TemporaryFile file(text);
    return parse({file.path()}).error;
  };
  EXPECT_NE(error("-options_file no_such.opts\n").find("no_such.opts cannot be read"), std::string::npos);
  EXPECT_NE(error("-options_file\n").find("-options_file: a value is missing"), std::string::npos);
  EXPECT_NE(error("-options_file " + middle.path() + " -time_end x\n").find("-options_file: out of place"),
            std::string::npos);
  const TemporaryFile wrong("-time_step x\n");
  EXPECT_NE(error("-time_end 1\n-options_file " + wrong.path()).find(wrong.path() + ":1)"), std::string::npos);
  const TemporaryFile loop("");
  std::ofstream(loop.path()) << "-options_file " << loop.path() << "\n";
  EXPECT_NE(parse({loop.path()}).error.find("includes itself"), std::string::npos);
}

TEST(Options, AQuotedWordReadsBackTheSame) {
  for (const std::string word : {"plain", "a b", "#", "\"", "\\", "a\\b", "a \\\"b\\\\", "tab\there", ""}) {
    Words words;
    EXPECT_EQ(split_words("-x " + quote_word(word) + " # a comment", &words), "");
    EXPECT_EQ(words, (Words{"-x", word}));
  }
  Words words;
  EXPECT_NE(split_words("-x \"a\\\"", &words), "");  // the quote is escaped and the word never ends
}

TEST(Options, AValueOfTheFileIsUnset) {
  const TemporaryFile file(
      "-time_end 1\n-species a\n-a_shape sphere\n-a_diameter .5\n-a_shear_modulus 1\n-a_viscosity 3\n");
  const ParseResult result = parse({file.path(), "-a_viscosity", "none"});
  ASSERT_EQ(result.error, "");
  EXPECT_FALSE(result.config.species[0].viscosity.has_value());
  EXPECT_TRUE(result.warnings.empty());
  EXPECT_NE(parse({file.path(), "-a_radius", "none"}).error.find("-a_radius: must be given"), std::string::npos);
}

TEST(Options, WhatHasLostItsMeaningIsDropped) {
  const TemporaryFile file(
      "-time_end 1\n-pressure_solver ksp\n-pressure_ksp_rtol 1e-3\n-boundary_y wall\n-boundary_ymax_velocity 1,0,0\n");
  const ParseResult result = parse({file.path(), "-pressure_solver", "acm", "-boundary_y", "periodic"});
  ASSERT_EQ(result.error, "");
  ASSERT_EQ(result.warnings.size(), 2U);
  EXPECT_EQ(result.warnings[0],
            "-boundary_ymax_velocity (" + file.path() +
                ":5): dropped, as it applies only with -boundary_ymax wall or inflow, or -boundary_y wall");
  EXPECT_EQ(result.warnings[1],
            "-pressure_ksp_rtol (" + file.path() + ":3): dropped, as it applies only with -pressure_solver ksp");
  EXPECT_EQ(result.config.sides[1][1].motion.velocity, Real3{});
  EXPECT_EQ(petsc_arguments(result.petsc), (Words{"-skip_petscrc"}));
  EXPECT_NE(parse({file.path(), "-pressure_solver", "acm", "-pressure_ksp_rtol", "1"}).error, "");
}

TEST(Options, PositionsAreRead) {
  const TemporaryFile good("x,y,z\n4,4,4\n"), bad("x,y,z\n4,4\n");
  const std::string list = scene + " -cell_placement list -cell_positions ";
  EXPECT_EQ(parse_line(list + good.path()).error, "");
  const std::string error = parse_line(list + bad.path()).error;
  EXPECT_NE(error.find("-cell_positions"), std::string::npos) << error;
  EXPECT_NE(error.find("line 2"), std::string::npos) << error;
}

TEST(Options, TextReadsBackTheSame) {
  const TemporaryFile list("x,y,z\n4,4,4\n");
  const Words scenes{
      scene,
      scene + " -fluid_viscosity 0.1 -body_force 0.30000000000000004,-1e-300,5e22 -output_overwrite",
      scene + " -boundary_ymax_velocity 1,0,0 -boundary_ymax_phase 2 -initial_velocity random -time_steps_max 7",
      scene + " -cell_placement list -cell_positions " + list.path() + " -cell_orientation 10,20,30",
      "-time_end 1 -grid_cells 8,8,1 -pressure_solver acm -snapshot_precision double",
      scene +
          " -pressure_solver ksp -pressure_ksp_rtol 1e-8 -pressure_ksp_monitor "
          "-pressure_pc_gamg_threshold -1 -pressure_mg_levels_pc_type sor -log_view",
      ("-time_end 1 -species a,b -a_shape slab -a_interval 0,.5 -a_axis x -a_shear_modulus 2 -b_shape "
       "ellipsoid -b_semi_axes .1,.2,.3 -b_shear_modulus 3 -b_initial_stretch 1.5,1,.6666666667"),
      "-time_end 1 -species a -a_shape sphere -a_radius .2 -a_law mooney_rivlin -a_c1 4 -a_c3 .6"};
  for (const std::string &line : scenes) {
    const ParseResult first = parse_line(line);
    ASSERT_EQ(first.error, "") << line;
    const std::string text = options_text(first);
    const TemporaryFile file(text);
    const ParseResult second = parse({file.path()});
    ASSERT_EQ(second.error, "") << text;
    EXPECT_EQ(options_text(second), text);
  }
  Words spaced = words(scene);
  spaced.insert(spaced.end(), {"-output_dir", "a #b"});
  const TemporaryFile file(options_text(parse(spaced)));
  EXPECT_EQ(parse({file.path()}).config.output.directory, "a #b");
  const std::string noted = options_text(parse_line(scene, "-fluid_density 2 -log_view"));
  EXPECT_NE(noted.find("# PETSC_OPTIONS: -fluid_density 2 -log_view\n"), std::string::npos);
  EXPECT_NE(noted.find("\n-fluid_density 2\n"), std::string::npos);
}

TEST(Options, MooneyRivlinHasItsModulus) {
  const ParseResult result =
      parse_line("-time_end 1 -species a -a_shape sphere -a_radius .2 -a_law mooney_rivlin -a_c1 4 -a_c2 2 -a_c3 .6");
  ASSERT_EQ(result.error, "");
  const Material m = result.config.species[0].material();
  EXPECT_EQ(m.law, Law::mooney_rivlin);
  EXPECT_EQ(m.shear_modulus, 12);
  EXPECT_EQ((Real3{m.c1, m.c2, m.c3}), (Real3{4, 2, .6}));
  EXPECT_NE(check_report(result.config, 1).find("shear modulus of a: 12 "), std::string::npos);
}

TEST(Options, TableIsComplete) {
  Config config;
  config.species.resize(1);
  config.species[0].name = "NAME";
  std::set<std::string> names;
  const std::string help = help_text(), markdown = help_markdown(), man = man_page();
  for (const Option &option : option_table(config)) {
    EXPECT_TRUE(names.insert(option.name).second) << option.name;
    EXPECT_FALSE(option.doc.empty() || option.accepted.empty() || option.group.empty()) << option.name;
    EXPECT_EQ(option.only_with.empty(), !option.applies) << option.name;
    const std::string shown = std::regex_replace(option.name, std::regex("_[xyz](min|max)(?![a-z])"), "_SIDE");
    EXPECT_NE(help.find("  -" + shown), std::string::npos);
    EXPECT_NE(markdown.find("| `-" + shown + "` |"), std::string::npos);
    EXPECT_NE(man.find("\\fB\\-" + shown + "\\fR"), std::string::npos);
    // The default that -help shows is itself a value that is accepted.
    if (!option.read || !option.text || option.required || option.text().empty()) continue;
    EXPECT_EQ(option.read(option.text()), "") << option.name;
  }
}

TEST(Options, HelpOfAWord) {
  const std::string help = parse_line("-help Viscosity").message;
  EXPECT_NE(help.find("  -fluid_viscosity (1)\n"), std::string::npos) << help;
  EXPECT_NE(parse_line("-help energy").message.find("  -guard_energy_growth"), std::string::npos);
  EXPECT_NE(parse_line("-help centres").message.find("  -profile_x"), std::string::npos) << "a word of its text";
  EXPECT_EQ(help.find("  -grid_cells"), std::string::npos) << help;
  EXPECT_NE(parse_line("-help mirror").error.find("no option has \"mirror\""), std::string::npos);
  EXPECT_NE(parse_line("-help -time_end").message.find("  -time_end (required)"), std::string::npos);
  EXPECT_NE(parse_line("-help mooney").message.find("  -NAME_law (neo_hookean)"), std::string::npos) << "a value";
  EXPECT_EQ(parse_line("-help log_view").message, "\nPETSc's own options pass through: -log_view, -log_view_memory\n");
  EXPECT_NE(parse_line("-help pc_type").message.find("pass through: -pressure_pc_*\n"), std::string::npos);
  const std::string density = parse_line("-help density").message;
  EXPECT_NE(density.find("  -fluid_density (1)"), std::string::npos);
  EXPECT_NE(density.find("\n\"density\" is not supported: bodies have"), std::string::npos);
  EXPECT_EQ(parse_line("-help cuda").message.find("\n\"cuda\" is not supported"), 0u);
}

TEST(Options, HelpListsWhatIsOfAllSidesOnce) {
  const std::string all = parse_line("-help windkessel").message;
  EXPECT_EQ(all.find("windkessel (0"), all.rfind("windkessel (0")) << all;
  EXPECT_NE(all.find("  -boundary_SIDE_windkessel (0,0,0)"), std::string::npos) << all;
  EXPECT_NE(all.find("only with -boundary_SIDE pressure"), std::string::npos) << all;
  EXPECT_NE(all.find("      SIDE: xmin, xmax, ymin, ymax, zmin or zmax\n"), std::string::npos) << all;
  const std::string one = parse_line("-help boundary_ymax_velocity").message;
  EXPECT_NE(one.find("  -boundary_SIDE_velocity"), std::string::npos) << one;
  EXPECT_NE(one.find("only with -boundary_SIDE wall or inflow [length/time]\n"), std::string::npos) << one;
  const std::string some = parse_line("-help boundary_x").message;
  EXPECT_NE(some.find("  -boundary_SIDE_velocity"), std::string::npos) << some;
  EXPECT_EQ(help_markdown().find("`-boundary_xmin"), std::string::npos);
  EXPECT_NE(help_markdown().find("| `-boundary_SIDE_windkessel` |"), std::string::npos);
}

TEST(Options, WallsOfOneBoundaryMayMove) {
  const ParseResult result =
      parse_line("-time_end 1 -boundary_ymin wall -boundary_ymax symmetry -boundary_ymin_velocity 1,0,0");
  EXPECT_EQ(result.error, "");
  EXPECT_EQ(result.config.sides[1][0].motion.velocity[0], 1);
}

TEST(Options, HelpAndVersionWinOverErrors) {
  EXPECT_EQ(parse_line("-nonsense -help").message, help_text());
  EXPECT_EQ(parse_line("-help markdown").message, help_markdown());
  EXPECT_EQ(parse_line("-help man").message, man_page());
  EXPECT_EQ(parse_line("-version").message, version_text());
  EXPECT_EQ(parse_line("-nonsense -h").message, usage_text());
  EXPECT_EQ(parse_line("--help").message, usage_text());
  EXPECT_FALSE(parse_line("--help").alone);
  EXPECT_TRUE(parse_line("").alone);
  EXPECT_EQ(parse_line("").message, usage_text());
  EXPECT_EQ(parse_line("", "-fluid_density 1").message, "");  // a run whose options are in the environment
  EXPECT_EQ(parse_line("-version").message.rfind("eulastic ", 0), 0u);
}
