// From the command line to a Config: what is accepted, what is refused and how the refusal reads.
#include "app/check_only.hpp"
#include "app/help_text.hpp"
#include "app/option_table.hpp"
#include "app/parse_options.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <set>
#include <sstream>

#include <unistd.h>

using namespace eulastic;

namespace {

using Words = std::vector<std::string>;

Words words(const std::string &line) {
  std::istringstream stream(line);
  Words list;
  for (std::string word; stream >> word;) list.push_back(word);
  return list;
}

ParseResult parse_line(const std::string &line, const std::string &environment = {}) {
  return parse(words(line), environment);
}

// A valid scene to spoil.
const std::string scene =
    "-grid_cells 16,16,16 -grid_length 8,8,8 -boundary_y wall -time_end 2 -species cell -cell_shape sphere "
    "-cell_radius 2 -cell_shear_modulus 0.5";

// A file of this process that goes with the test.
class TemporaryFile {
public:
  explicit TemporaryFile(const std::string &text)
      : path_(testing::TempDir() + "options_test_" + std::to_string(getpid()) + "_" + std::to_string(++count_)) {
    std::ofstream(path_) << text;
  }
  ~TemporaryFile() { std::remove(path_.c_str()); }
  const std::string &path() const { return path_; }

private:
  static int count_;
  std::string path_;
};
int TemporaryFile::count_ = 0;

struct Refusal {
  std::string added;              ///< to the valid scene
  std::vector<std::string> says;  ///< pieces of the message
};

void expect_refusals(const std::vector<Refusal> &refusals, const std::string &base = scene) {
  for (const Refusal &refusal : refusals) {
    const ParseResult result = parse_line(base + " " + refusal.added);
    EXPECT_FALSE(result.error.empty()) << refusal.added;
    EXPECT_EQ(result.error.find('\n'), std::string::npos);
    for (const std::string &piece : refusal.says)
      EXPECT_NE(result.error.find(piece), std::string::npos) << refusal.added << " says: " << result.error;
  }
}

}  // namespace

TEST(Options, ValuesArrive) {
  const ParseResult result = parse_line(
      "-grid_cells 32,16,8 -grid_length 4,2.5,1e1 -boundary_x periodic -boundary_y wall -boundary_z wall "
      "-da_processors_y 2 -wall_ymax_velocity 1,0,-2 -wall_ymax_frequency 3 -wall_zmin_phase .5 -fluid_density 2 "
      "-fluid_viscosity 0.1 -fluid_inertia no -body_force -1,2e-4,+3 -body_force_frequency 6 -body_force_phase -1 "
      "-initial_velocity shear_wave_xy -initial_velocity_amplitude -1.5 -initial_velocity_mean 1,0,0 -species a,b_2 "
      "-a_shape biconcave -a_diameter 1 -a_axis z -a_shear_modulus 7 -a_placement lattice -a_count 2,1,1 "
      "-b_2_shape slab -b_2_interval -1,1.2 -b_2_shear_modulus 0 -b_2_initial_stretch 2,1,.5 "
      "-method classic -pressure_solver acm -time_end 10 -time_step .01 -time_steps_max 99 -output_dir out/a "
      "-output_overwrite -snapshot_interval 2 -snapshot_fields pressure,left_cauchy_green -snapshot_precision double "
      "-series_interval 3");
  ASSERT_EQ(result.error, "");
  const Config &c = result.config;
  EXPECT_EQ(c.grid.cells, (Int3{32, 16, 8}));
  EXPECT_EQ(c.grid.length, (Real3{4, 2.5, 10}));
  EXPECT_EQ(c.grid.boundary, (std::array<Boundary, 3>{Boundary::periodic, Boundary::wall, Boundary::wall}));
  EXPECT_EQ(c.grid.processors, (Int3{0, 2, 0}));
  EXPECT_EQ(c.walls.motion[1][1].velocity, (Real3{1, 0, -2}));
  EXPECT_EQ(c.walls.motion[1][1].frequency, 3);
  EXPECT_EQ(c.walls.motion[2][0].phase, 0.5);
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
  EXPECT_EQ(result.petsc_arguments, (Words{"-skip_petscrc"}));
  EXPECT_TRUE(parse_line(scene + " -cell_centre 4,4,4").config.species[0].centre_given);
}

TEST(Options, Booleans) {
  for (const char *yes : {"", "true", "yes", "1"})
    EXPECT_TRUE(parse_line(scene + " -output_overwrite " + yes + " -check_only false").config.output.overwrite) << yes;
  for (const char *no : {"false", "no", "0"}) {
    const ParseResult result = parse_line(scene + " -output_overwrite true -fluid_inertia " + no);
    EXPECT_EQ(result.error, "");
    EXPECT_FALSE(result.config.fluid.inertia) << no;
  }
  expect_refusals({{"-fluid_inertia maybe", {"-fluid_inertia", "true or false"}}, {"-check_only 2", {"-check_only"}}});
}

TEST(Options, UnknownNames) {
  expect_refusals({{"-grid_cels 8,8,8", {"-grid_cels", "nearest known: -grid_cells", "3 integers >= 1"}},
                   {"-cell_raduis 1", {"nearest known: -cell_radius"}},
                   {"-time_ned 1", {"nearest known: -time_end"}},
                   {"-grid_cells=8,8,8", {"-grid_cells=8,8,8", "nearest known: -grid_cells"}},
                   {"--time_step 1", {"--time_step", "nearest known: -time_step"}},
                   {"-Time_step 1", {"-Time_step", "nearest known: -time_step"}},
                   {"-other_radius 1", {"-other_radius"}},
                   {"-options_file x", {"-options_file"}},
                   {"-log", {"unknown option -log"}},
                   {"-log_", {"unknown option -log_"}},
                   {"-NAME_radius 1", {"unknown option -NAME_radius"}}});
}

TEST(Options, PetscOptionsPassThrough) {
  const ParseResult result = parse_line(
      scene + " -log_view :log.txt -pressure_ksp_type cg -info -malloc_debug -memory_view", "-ksp_rtol 1e-3");
  ASSERT_EQ(result.error, "");
  EXPECT_EQ(result.petsc_arguments, (Words{"-skip_petscrc", "-ksp_rtol", "1e-3", "-log_view", ":log.txt",
                                           "-pressure_ksp_type", "cg", "-info", "-malloc_debug", "-memory_view"}));
}

TEST(Options, PetscIsSilentAfterAnError) {
  EXPECT_EQ(parse_line("-log_view -nonsense").petsc_arguments, (Words{"-skip_petscrc"}));
  EXPECT_EQ(parse_line("-log_view -help").petsc_arguments, (Words{"-skip_petscrc"}));
}

TEST(Options, Duplicates) {
  expect_refusals({{"-time_end 2", {"-time_end", "given twice"}},
                   {"-cell_diameter 4", {"-cell_diameter", "given twice, also as -cell_radius"}},
                   {"-check_only -check_only", {"-check_only", "given twice"}},
                   {"-snapshot_fields body,body", {"-snapshot_fields", "\"body\" is given twice"}}});
}

TEST(Options, MissingValues) {
  expect_refusals({{"-time_step", {"-time_step", "a value is missing", "a number >= 0"}},
                   {"-time_step -check_only", {"-time_step", "a value is missing"}},
                   {"-output_dir", {"-output_dir", "a value is missing"}}});
  Words list = words(scene);
  list.push_back("-output_dir");
  list.push_back("");
  EXPECT_NE(parse(list).error.find("a value is missing"), std::string::npos);
  expect_refusals({{"-species", {"-species", "a value is missing"}}}, "-time_end 1");
}

TEST(Options, Lists) {
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

TEST(Options, Numbers) {
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
                   {"-wall_ymin_velocity nan,0,0", {"-wall_ymin_velocity", "not finite"}},
                   {"-wall_ymin_velocity -inf,0,0", {"-wall_ymin_velocity", "not finite"}}});
}

TEST(Options, Ranges) {
  expect_refusals({{"-fluid_density 0", {"-fluid_density", "out of range", "a number > 0"}},
                   {"-fluid_viscosity -1", {"-fluid_viscosity", "a number >= 0"}},
                   {"-time_step -1", {"-time_step", "out of range"}},
                   {"-time_steps_max -1", {"-time_steps_max", "out of range"}},
                   {"-series_interval -1", {"-series_interval", "out of range"}},
                   {"-da_processors_x -1", {"-da_processors_x", "out of range"}},
                   {"-cell_initial_stretch 1,0,1", {"-cell_initial_stretch", "out of range"}},
                   {"-wall_ymin_frequency -1", {"-wall_ymin_frequency", "out of range"}},
                   {"-method slow", {"-method", "\"slow\"", "classic"}},
                   {"-pressure_solver ACM", {"-pressure_solver", "one of acm, smac"}},
                   {"-boundary_x open", {"-boundary_x", "one of periodic, wall"}},
                   {"-initial_velocity vortex", {"-initial_velocity", "taylor_green"}}});
  expect_refusals({{"-grid_cells 0,8,8", {"-grid_cells", "out of range"}},
                   {"-grid_cells 8,8,2", {"-grid_cells", "at least 3"}},
                   {"-grid_cells 2,8,1", {"-grid_cells", "at least 3"}},
                   {"-grid_length 1,0,1", {"-grid_length", "out of range"}},
                   {"-grid_cells 65536,65536,8", {"-grid_cells", "64-bit"}}},
                  "-time_end 1");
  expect_refusals({{"-time_end 0", {"-time_end", "out of range"}}, {"", {"-time_end", "must be given"}}}, "");
}

TEST(Options, StrayWords) {
  expect_refusals({{"-body_force 1,0,0 -time_step 1 2 3", {}},
                   {"word another", {"stray word \"another\""}},
                   {"no_such_file.opts", {"no_such_file.opts", "cannot be read"}},
                   {"/", {"options file / cannot be read"}}});
  Words list = words(scene);
  list.push_back("");
  EXPECT_NE(parse(list).error.find("stray word"), std::string::npos);
  EXPECT_NE(parse_line(scene, "word").error.find("PETSC_OPTIONS"), std::string::npos);
}

TEST(Options, SpeciesNames) {
  for (const char *name :
       {"wall",   "fluid",   "body",   "time",     "grid",   "boundary", "initial", "output", "snapshot",
        "series", "species", "method", "pressure", "check",  "help",     "version", "da",     "log",
        "ksp",    "mat",     "vec",    "info",     "malloc", "options",  "grid_a",  "Wall"}) {
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

TEST(Options, InconsistentScenes) {
  expect_refusals({{"-wall_ymin_velocity 0,1,0", {"-wall_ymin_velocity", "normal"}},
                   {"-wall_xmin_velocity 0,1,0", {"-wall_xmin_velocity", "-boundary_x wall"}},
                   {"-wall_xmax_frequency 1", {"-wall_xmax_frequency", "-boundary_x wall"}},
                   {"-initial_velocity_amplitude 2", {"-initial_velocity_amplitude", "-initial_velocity"}},
                   {"-initial_velocity_mean 0,1,0", {"-initial_velocity_mean", "between walls"}},
                   {"-cell_interval 1,2", {"-cell_interval", "-cell_shape slab"}},
                   {"-cell_axis x", {"-cell_axis"}},
                   {"-cell_count 1,1,1", {"-cell_count", "-cell_placement lattice"}},
                   {"-cell_placement list", {"-cell_positions", "must be given"}},
                   {"-cell_positions x.csv", {"-cell_positions", "-cell_placement list"}},
                   {"-cell_placement list -cell_positions no_such.csv", {"-cell_positions", "no_such.csv"}},
                   {"-cell_placement list -cell_positions /", {"-cell_positions"}},
                   {"-cell_placement lattice -cell_count 1,9,1", {"-species cell", "wall"}},
                   {"-cell_centre 4,1,4", {"-species cell", "wall"}},
                   {"-cell_centre 40,4,4", {"-species cell", "outside"}}});
  const std::string periodic = "-time_end 1 -grid_cells 8,8,8 ";
  expect_refusals({{"-initial_velocity couette", {"-initial_velocity", "-boundary_y wall"}},
                   {"-initial_velocity poiseuille", {"-boundary_y wall"}}},
                  periodic);
  const std::string material = "-species a -a_shear_modulus 1 ";
  expect_refusals({{"-a_shape sphere", {"-a_radius", "must be given"}},
                   {"-a_shape sphere -a_radius 0", {"-a_radius", "out of range"}},
                   {"-a_shape sphere -a_diameter 0", {"-a_diameter", "out of range"}},
                   {"-a_shape sphere -a_radius 3", {"-species a", "long"}},
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
       {"-species a -a_shape sphere -a_radius .1 -a_shear_modulus -1", {"-a_shear_modulus", "out of range"}}},
      periodic);
}

TEST(Options, TwoDimensions) {
  const std::string flat = "-time_end 1 -grid_cells 8,8,1 -boundary_y wall ";
  EXPECT_EQ(parse_line(flat + "-species a -a_shape sphere -a_radius .2 -a_centre .5,.5,9 -a_shear_modulus 1").error,
            "");
  expect_refusals({{"-boundary_z wall", {"-boundary_z", "more than one cell"}},
                   {"-body_force 0,0,1", {"-body_force", "2-D"}},
                   {"-wall_ymin_velocity 0,0,1", {"-wall_ymin_velocity", "2-D"}},
                   {"-initial_velocity_mean 0,0,1", {"-initial_velocity_mean", "2-D"}},
                   {"-initial_velocity shear_wave_xz", {"-initial_velocity", "more than one cell"}},
                   {"-initial_velocity taylor_green_3d", {"-initial_velocity", "more than one cell"}},
                   {"-species a -a_shape sphere -a_radius .1 -a_shear_modulus 1 -a_initial_stretch 1,1,2",
                    {"-a_initial_stretch", "2-D"}},
                   {"-species a -a_shape sphere -a_radius .1 -a_shear_modulus 1 -a_placement lattice -a_count 1,1,2",
                    {"-a_count", "2-D"}}},
                  flat);
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
  EXPECT_EQ(result.petsc_arguments, (Words{"-skip_petscrc", "-log_view"}));
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

TEST(Options, ErrorsNameTheirSource) {
  const auto error = [](const std::string &text) {
    const TemporaryFile file(text);
    const std::string message = parse({file.path()}).error;
    return message.find(file.path()) == std::string::npos ? "no path in: " + message : message;
  };
  EXPECT_NE(error("-time_end 1\n-time_step 1x\n").find(":2)"), std::string::npos);
  EXPECT_NE(error("-time_end 1\n-time_end 2\n").find("given twice"), std::string::npos);
  EXPECT_NE(error("-time_end 1\nword\n").find("stray word \"word\""), std::string::npos);
  EXPECT_NE(error("-time_end 1 2\n").find("stray word \"2\""), std::string::npos);
  EXPECT_NE(error("-body_force 1, 2, 3\n").find(":1)"), std::string::npos);
  EXPECT_NE(error("-output_dir \"a\n").find("quote"), std::string::npos);
  EXPECT_NE(error("-help\n").find("only on the command line"), std::string::npos);
  EXPECT_NE(error("-wall_xmin_velocity 0,0,0\n-time_end 1\n").find(":1)"), std::string::npos);
  EXPECT_NE(parse_line("-time_end 1", "-time_step x").error.find("in PETSC_OPTIONS"), std::string::npos);
  EXPECT_EQ(parse({"-x\ny"}).error.find('\n'), std::string::npos);
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
  const Words scenes{scene,
                     scene + " -fluid_viscosity 0.1 -body_force 0.30000000000000004,-1e-300,5e22 -output_overwrite",
                     scene + " -wall_ymax_velocity 1,0,0 -wall_ymax_phase 2 -initial_velocity random -time_steps_max 7",
                     scene + " -cell_placement list -cell_positions " + list.path() + " -cell_orientation 10,20,30",
                     "-time_end 1 -grid_cells 8,8,1 -pressure_solver acm -snapshot_precision double",
                     "-time_end 1 -species a,b -a_shape slab -a_interval 0,.5 -a_axis x -a_shear_modulus 2 -b_shape "
                     "ellipsoid -b_semi_axes .1,.2,.3 -b_shear_modulus 0 -b_initial_stretch 1.5,1,1"};
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

TEST(Options, TableIsComplete) {
  Config config;
  config.species.resize(1);
  config.species[0].name = "NAME";
  std::set<std::string> names;
  const std::string help = help_text(), markdown = help_markdown();
  for (const Option &option : option_table(config)) {
    EXPECT_TRUE(names.insert(option.name).second) << option.name;
    EXPECT_FALSE(option.doc.empty() || option.accepted.empty() || option.group.empty()) << option.name;
    EXPECT_EQ(option.only_with.empty(), !option.applies) << option.name;
    EXPECT_NE(help.find("  -" + option.name), std::string::npos);
    EXPECT_NE(markdown.find("| `-" + option.name + "` |"), std::string::npos);
    // The default that -help shows is itself a value that is accepted.
    if (!option.read || !option.text || option.required || option.text().empty()) continue;
    EXPECT_EQ(option.read(option.text()), "") << option.name;
  }
}

TEST(Options, HelpAndVersionWinOverErrors) {
  EXPECT_EQ(parse_line("-nonsense -help").message, help_text());
  EXPECT_EQ(parse_line("-help markdown").message, help_markdown());
  EXPECT_EQ(parse_line("-version").message, version_text());
  EXPECT_EQ(parse_line("-version").message.rfind("eulastic ", 0), 0u);
}

TEST(Options, CheckReport) {
  // Channel of height 2: U = f H^2/(8 nu) = 1, shear rate f H/(2 nu) = 2; nu = 1/2, c^2 = 2, S = 2 4^2 = 32.
  const ParseResult result = parse_line(
      "-grid_cells 16,8,1 -grid_length 4,2,1 -boundary_y wall -fluid_density 2 -fluid_viscosity 1 -body_force 1,0,0 "
      "-time_end 100 -species a -a_shape sphere -a_radius .5 -a_shear_modulus 4 -a_placement lattice -a_count 2,1,1");
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
  has("hematocrit: 0.19635");                                     // 2 pi/4 / 8
  has("memory: 5.632e-05 GB for fields, 2.816e-05 GB per rank");  // 16 fields of (16 + 6) x (4 + 6) doubles
  has("dt limit, viscous: 0.03125");                              // 1/(2 nu S)
  has("dt limit, elastic wave: 0.125");                           // 1/(c sqrt(S))
  has("dt limit, viscous and elastic: 0.0295085");                // 64 dt^2 + 32 dt = 1
  has("dt limit, advective: 0.25");
  has("dt limit, Euler 2 nu/U^2: 1");
  EXPECT_EQ(report.find("warning"), std::string::npos);
  const ParseResult forced = parse_line(scene + " -time_step 1 -check_only");
  EXPECT_NE(check_report(forced.config, 1).find("warning: -time_step 1 breaks the viscous limit"), std::string::npos);
  const ParseResult huge = parse_line("-time_end 1 -grid_cells 8192,8192,8192 -check_only");
  ASSERT_EQ(huge.error, "");
  EXPECT_NE(check_report(huge.config, 1024).find("64-bit"), std::string::npos);
}
