// Boundaries and rigid bodies that do not make a valid scene are refused in one line that names the option and what is
// accepted.
#include "support/files.hpp"
#include "support/refusals.hpp"

#include <fstream>

using namespace eulastic;
using namespace eulastic::test;

TEST(SceneRefusals, SidesThatVolumeCrosses) {
  const test::TemporaryDirectory files;
  const auto file = [&](const char *name, const std::string &text) {
    std::ofstream(files / name) << text;
    return " " + files / name;
  };
  const std::string in = "-boundary_xmin inflow -boundary_xmax ", way = in + "outflow -boundary_xmin_velocity 1 ";
  expect_refusals(
      {{in + "outflow", {"-boundary_xmin_velocity: must be given", "-boundary_xmin_flow_rate"}},
       {way + "-boundary_xmin_flow_rate 2", {"-boundary_xmin_flow_rate: given beside"}},
       {in + "wall -boundary_xmin_velocity 1", {"-boundary_xmin: ", "cannot leave", "a pressure or outflow boundary"}},
       {in + "inflow -boundary_xmin_velocity 1 -boundary_xmax_velocity 1",
        {"cannot leave", "-boundary_xmin, -boundary_xmax"}},
       {in + "inflow -boundary_xmin_velocity 1 -boundary_xmax_velocity -1 -boundary_xmax_angular_frequency 2",
        {"cannot leave"}},
       {"-boundary_xmin inflow", {"-boundary_xmin: a single boundary"}},
       {"-boundary_xmin inflow -boundary_xmin_velocity 1", {"-boundary_xmin: a single boundary"}},
       {"-boundary_xmax pressure -boundary_xmax_pressure 1", {"-boundary_xmax: a single boundary"}},
       {"-boundary_xmin_velocity 1",
        {"-boundary_xmin_velocity: applies only with -boundary_xmin wall or inflow, or -boundary_x wall"}},
       {way + "-boundary_xmax_pressure 1", {"-boundary_xmax_pressure: applies only with -boundary_xmax pressure"}},
       {in + "outflow -boundary_xmin_velocity 0,1,0", {"-boundary_xmin_velocity: cannot read 0,1,0"}},
       {way + "-boundary_ymin wall -boundary_ymax wall -boundary_ymin_velocity 1",
        {"-boundary_ymin_velocity: ", "accepted: for a wall 3 numbers"}},
       {way + "-boundary_xmin_profile nowhere", {"-boundary_xmin_profile: cannot read nowhere", "uniform, developed"}},
       {way + "-boundary_xmin_profile" + file("short", "1 2 3\n"), {"has 3 numbers", "one per cell of the boundary"}},
       {way + "-boundary_xmin_profile" + file("words", "1 two\n"), {"words line 1"}},
       {in + "outflow -boundary_xmin_velocity nowhere", {"-boundary_xmin_velocity: cannot read nowhere"}},
       {in + "outflow -boundary_xmin_velocity" + file("three", "0,1,2\n"), {"a row has 3 numbers", "time,value"}},
       {in + "outflow -boundary_xmin_velocity" + file("back", "0,1\n0,2\n"), {"does not come after", "ascending"}},
       {in + "outflow -boundary_xmin_angular_frequency 1 -boundary_xmin_velocity" + file("table", "0,1\n1,2\n"),
        {"-boundary_xmin_angular_frequency: does not apply to a table"}},
       {in + "outflow -boundary_xmin_velocity" + file("short_table", "0,1\n.5,1\n"),
        {"short_table goes from time 0 to 0.5, the run from 0 to 2", "-boundary_xmin_table_period",
         "-boundary_xmin_table_hold true"}},
       {in + "outflow -boundary_xmin_velocity" + file("late", ".1,1\n1,1\n"), {"late goes from time 0.1 to 1"}},
       {in + "outflow -boundary_xmin_table_period 2 -boundary_xmin_table_hold true -boundary_xmin_velocity " +
            files / "table",
        {"-boundary_xmin_table_hold: given beside -boundary_xmin_table_period"}},
       {in + "outflow -boundary_xmin_table_period .75 -boundary_xmin_velocity " + files / "table",
        {"-boundary_xmin_table_period: 0.75 is shorter than the table", "accepted: 1 or longer"}},
       {in + "outflow -boundary_xmin_table_period 1 -boundary_xmin_velocity " + files / "table",
        {"-boundary_xmin_table_period: the table ends with 2 and begins again with 1"}},
       {way + "-boundary_xmin_table_period 1", {"-boundary_xmin_table_period: applies only to a table"}},
       {way + "-boundary_xmin_table_hold true", {"-boundary_xmin_table_hold: applies only to a table"}},
       {in + "pressure -boundary_xmin_velocity 1 -boundary_xmax_pressure " + files / "short_table",
        {"-boundary_xmax_pressure: ", "short_table goes from", "-boundary_xmax_table_period"}},
       {in + "pressure -boundary_xmin_velocity 1 -boundary_xmax_pressure nowhere",
        {"-boundary_xmax_pressure: cannot read"}},
       {in + "pressure -boundary_xmin_velocity 1 -boundary_xmax_windkessel 1,0,2 "
             "-boundary_xmax_windkessel_initial_pressure 1",
        {"-boundary_xmax_windkessel_initial_pressure: the Windkessel has no capacitance"}},
       {in + "pressure -boundary_xmin_velocity 1 -boundary_xmax_windkessel 1,1,2 -boundary_xmax_resistance 1",
        {"-boundary_xmax_resistance: given beside"}}});
  EXPECT_EQ(parse_line(scene + " " + way).error, "");
  for (const char *end :
       {"-boundary_xmin_table_hold true", "-boundary_xmin_table_period .5", "-boundary_xmin_table_period .7"})
    EXPECT_EQ(parse_line(scene + " " + in + "outflow -boundary_xmin_velocity " + files / "short_table " + end).error,
              "");
  EXPECT_EQ(parse_line(scene + " " + in + "inflow -boundary_xmin_velocity 1 -boundary_xmax_flow_rate -64").error, "");
}

// At every time of the run, not only at rows of a table or at eighths of a period.
TEST(SceneRefusals, InflowSidesThatDoNotCancel) {
  const test::TemporaryDirectory files;
  const auto file = [&](const char *name, const std::string &text) {
    std::ofstream(files / name) << text;
    return " " + files / name + " ";
  };
  const std::string in = "-boundary_xmin inflow -boundary_xmax inflow ", one = "-boundary_xmin_velocity ",
                    two = "-boundary_xmax_velocity ";
  const std::string beat = file("beat", "0,0\n.1,1\n.2,0\n"), back = file("back", "0,0\n.1,-1\n.2,0\n"),
                    twice = file("twice", "0 0\n.1 -1\n.2 0\n.3 -1\n.4 0"),
                    other = file("other", "0 0\n.1 -1\n.2 0\n.3 -1.5\n.4 0");
  expect_refusals(
      {{in + one + "1 -boundary_xmin_angular_frequency 1 " + two + "-1 -boundary_xmax_angular_frequency 9",
        {"up to 64 volume/time enters at the angular frequency 1", "cannot leave", "at every time"}},
       {in + one + beat + "-boundary_xmin_table_period .2 " + two + back + "-boundary_xmax_table_hold true",
        {"at time 0.3"}},
       {in + one + beat + "-boundary_xmin_table_period .2 " + two + back + "-boundary_xmax_table_period .25",
        {"cannot leave"}},
       {in + one + beat + "-boundary_xmin_table_period .2 " + two + other + "-boundary_xmax_table_period .4",
        {"-32", "at time 0.3"}},
       {in + one + beat + "-boundary_xmin_table_hold true " + two + "0 -boundary_xmax_angular_frequency 1",
        {"64 volume/time", "time 0.1"}},
       {in + one + beat + "-boundary_xmin_table_period .2 " + two +
            "-1 -boundary_xmax_angular_frequency 31.41592653589793",
        {"cannot leave"}}});
  for (const std::string &fine :
       {one + "1 -boundary_xmin_angular_frequency 7 -boundary_xmin_phase .3 " + two +
            "-1 -boundary_xmax_angular_frequency 7 -boundary_xmax_phase .3",
        one + beat + "-boundary_xmin_table_period .2 " + two + back + "-boundary_xmax_table_period .2",
        one + beat + "-boundary_xmin_table_period .2 " + two + twice + "-boundary_xmax_table_period .4",
        one + beat + "-boundary_xmin_table_hold true " + two + back + "-boundary_xmax_table_hold true"})
    EXPECT_EQ(parse_line(scene + " " + in + fine).error, "") << fine;
}

// Sizes that do not give a body, and placements of what is one body.
TEST(SceneRefusals, ShapesAndPlacements) {
  const std::string tube = "-grid_cells 8,8,8 -a_shape constricted_tube -a_radius .2 -a_axis ";
  const std::string ball = "-a_shape sphere -a_radius .2 ", flat = ball + "-grid_cells 8,8,1 ";
  expect_refusals(
      {{"-grid_cells 8,8,8 -a_shape sphere -a_radius 0", {"-a_radius: ", "accepted: "}},
       {tube + "x -a_throat_length .4 -a_throat_radius .2",
        {"-a_throat_radius: 0.2 is no narrower", "accepted: less than 0.2, -a_radius"}},
       {tube + "x -a_throat_length 0 -a_throat_radius .1", {"-a_throat_length: ", "accepted: "}},
       {"-grid_cells 8,8,1 -a_shape constricted_tube -a_radius .2 -a_throat_length .4 -a_throat_radius .1 -a_axis z",
        {"-a_axis: z cannot be the axis of this shape in 2-D", "accepted: x, y"}},
       {tube + "x -a_throat_length .4 -a_throat_radius .1 -a_placement lattice", {"-a_placement: ", "accepted: one"}},
       {"-grid_cells 8,8,8 -a_shape slab -a_interval 1,1", {"-a_interval: ", "accepted: low,high with low < high"}},
       {"-grid_cells 8,8,8 -a_shape slab -a_interval 1,2",
        {"-a_interval: the slab is outside the box", "accepted: a part of 0,1"}},
       {ball + "-grid_cells 8,8,8 -a_placement lattice -a_count 1,1,0", {"-a_count: "}},
       {flat + "-a_placement lattice -a_count 1,1,2", {"-a_count: 2 along z in 2-D", "accepted: 1 along z"}},
       {ball + "-grid_cells 8,8,8 -a_centre .5,.5,2", {"-a_centre: z = 2 ", "accepted: within 0 ... 1"}},
       {"-grid_cells 8,8,8 -a_shape sphere -a_radius 1", {"-a_shape: the body is 2 long in x", "accepted: at most 1"}},
       {ball + "-grid_cells 8,8,8 -a_centre .5,.1,.5 -boundary_y wall",
        {"-a_centre: the body reaches into the wall", "accepted: within 0 ... 1"}},
       {flat + "-a_body_force 0,0,1", {"-a_body_force: 1 along z in 2-D", "accepted: 0 along z"}},
       {flat + "-a_orientation 9,0,0", {"-a_orientation: ", "accepted: 0,0,angle"}}},
      "-time_end 1 -species a -a_shear_modulus 1 ");
}

// What would turn into another shape, or cannot go where it is told.
TEST(SceneRefusals, RigidBodiesThatMove) {
  expect_refusals(
      {{"-a_shape tube -a_radius .2 -a_axis x -a_angular_velocity 1,0,0", {"-a_angular_velocity", "accepted:"}},
       {"-a_shape tube -a_radius .2 -a_axis x -a_velocity 0,1,0", {"-a_velocity", "accepted:"}},
       {"-a_shape cylinder -a_radius .2 -a_axis z -a_angular_velocity 1,0,0", {"-a_angular_velocity", "accepted:"}},
       {"-a_shape ellipsoid -a_semi_axes .1,.2,.45 -grid_length 1,.8,1 -a_angular_velocity 3,0,0",
        {"-a_angular_velocity", "from its centre along y", "accepted: below 0.4"}},
       {"-a_shape ellipsoid -a_semi_axes .1,.2,.4 -a_angular_velocity 0,1,0 -boundary_x wall",
        {"-a_angular_velocity: rotates a body to x = 0.1", "accepted: a path between 0.25 and 0.75"}},
       {"-a_shape ellipsoid -a_semi_axes .1,.2,.1 -a_angular_velocity 0,1,0 -method classic",
        {"-a_angular_velocity", "or rotates through the grid"}},
       {"-a_shape slab -a_interval .3,.5 -a_axis y -a_velocity 0,1,0 -boundary_y wall",
        {"-a_velocity", "cannot leave"}},
       {"-a_shape slab -a_axis y -a_interval .26,.37 -a_velocity 0,1,0",
        {"-a_interval: the rigid slab holds no face", "accepted: at least 0.125"}},
       {"-a_shape slab -a_axis y -a_interval .25,.375", {"-a_interval: the rigid slab holds no face"}},
       {"-a_shape tube -a_radius .2 -a_axis x -a_velocity 1,0,0 -boundary_x wall",
        {"-a_velocity", "boundaries of the box"}}},
      "-time_end 1 -grid_cells 8,8,8 -species a -a_law rigid ");
}

// Those that turn in place have surfaces that move, too.
TEST(SceneRefusals, RigidBodiesThatTurnInPlace) {
  const std::string disc =
      "-time_end 1 -grid_cells 20,20,1 -boundary_y wall -species a,b -a_law rigid -a_shape cylinder -a_axis z "
      "-a_radius .1 -b_law rigid -b_shape cylinder -b_axis z -b_radius .1 ";
  EXPECT_EQ(parse_line(disc + "-b_centre .7,.7,.5 -a_centre .3,.15,.5").error, "");  // at rest
  EXPECT_EQ(parse_line(disc + "-b_centre .7,.7,.5 -a_centre .3,.3,.5 -a_angular_velocity 0,0,1").error, "");
  expect_refusals(
      {{"-b_centre .7,.7,.5 -a_centre .3,.125,.5",
        {"-a_angular_velocity: rotates a body that reaches y = 0.02", "between 0.1 and 0.9"}},
       {"-b_centre .7,.7,.5 -a_centre .48,.7,.5",
        {"-a_angular_velocity: rotates a body within a cell of one of b", "accepted: a cell"}},
       {"-a_placement lattice -a_count 4,1,1 -b_centre .7,.85,.5", {"rotates a body within a cell of one of a"}},
       {"-b_centre .7,.7,.5 -a_centre .1,.125,.5 -a_velocity 1,0,0",
        {"-a_velocity: moves a body that reaches y = 0.02"}}},
      disc + "-a_angular_velocity 0,0,1 ");
  expect_refusals({{"-a_radius .1 -a_centre .3,.7,.5 -a_angular_velocity 0,0,1 -a_shape cylinder -a_axis z -species "
                    "a,b -b_law rigid "
                    "-b_shape slab -b_axis x -b_interval .41,.6",
                    {"-a_angular_velocity: rotates a body within a cell of one of b"}},
                   {"-a_radius .49 -a_shape cylinder -a_axis z -a_angular_velocity 0,0,1 -species a",
                    {"-a_angular_velocity: the body reaches 0.49", "accepted: below 0.475"}},
                   {"-a_shape slab -a_axis x -a_interval .3,.5 -a_velocity 1,0,0 -species a -boundary_ymin inflow "
                    "-boundary_ymin_velocity 1 -boundary_ymax pressure",
                    {"-a_velocity: moves a body that covers a part of the inflow boundary ymin", "accepted: 0,0,0"}}},
                  "-time_end 1 -grid_cells 20,20,1 -a_law rigid ");
}

TEST(SceneRefusals, BodiesThatCutOffAnInlet) {
  const std::string says = "-boundary_xmin: rigid bodies cut this inflow boundary off";
  const std::string slab =
      "-time_end 1 -grid_cells 24,16,1 -boundary_xmin inflow -boundary_xmin_velocity 1 -boundary_xmax pressure "
      "-species s -s_shape slab -s_axis x -s_interval .3,.6 -s_law rigid ";
  EXPECT_EQ(parse_line(slab + "-boundary_ymin wall -boundary_ymax pressure").error, "");
  expect_refusals({{"-boundary_y wall", {says, "accepted: "}}}, slab);
  // A disc in a channel leaves a way of one face on either side, or none.
  const std::string channel =
      "-time_end 1 -grid_cells 48,16,1 -grid_length 3,1,1 -boundary_xmin inflow -species s -s_shape cylinder -s_axis z "
      "-s_law rigid ";
  const std::string disc = channel + "-boundary_y wall -boundary_xmax outflow ", flow = "-boundary_xmin_velocity 1 ";
  EXPECT_EQ(parse_line(disc + flow + "-s_radius .45").error, "");
  EXPECT_EQ(parse_line(disc + "-boundary_xmin_velocity 0 -s_radius .48").error, "");
  expect_refusals({{"-s_radius .48", {says}}, {"-s_radius .24 -s_placement lattice -s_count 1,2,1", {says}}},
                  disc + flow);
  // Across the periodic boundary in y the way is open only where the disc has a gap to its image.
  EXPECT_EQ(parse_line(channel + flow + "-boundary_xmax outflow -s_radius .45 -s_centre 1.5,.25,.5").error, "");
  expect_refusals({{"-s_radius .499 -s_centre 1.5,.25,.5", {says}}}, channel + flow + "-boundary_xmax outflow ");
  // What flows in may leave through another inlet.
  const std::string two = channel + flow + "-boundary_y wall -boundary_xmax inflow -boundary_xmax_velocity -1 ";
  EXPECT_EQ(parse_line(two + "-s_radius .45").error, "");
  expect_refusals({{"-s_radius .48", {says}}}, two);
}

TEST(SceneRefusals, BodiesWithoutAFace) {
  const std::string body = "-time_end 1 -grid_cells 16,16,16 -species s -s_law rigid ";
  EXPECT_EQ(parse_line(body + "-s_shape sphere -s_radius .005 -s_centre .5,.53125,.53125").error, "");  // on a face
  EXPECT_EQ(parse_line(body + "-s_shape sphere -s_radius .0625 -s_centre .51,.52,.53").error, "");
  expect_refusals(
      {{"-s_shape sphere -s_radius .005 -s_centre .51,.52,.53",
        {"-s_radius: the rigid body at 0.51,0.52,0.53 contains no face", "accepted: bodies at least 0.125 thick"}},
       {"-s_shape ellipsoid -s_semi_axes .2,.2,.01 -s_centre .5,.5,.515", {"-s_semi_axes: the rigid body at"}},
       {"-s_shape cylinder -s_axis z -s_radius .01 -s_centre .51,.51,.5", {"-s_radius: the rigid body at 0.51,0.51"}}},
      body);
}

// Only rigid vessels may have open ends.
TEST(SceneRefusals, ElasticVesselsAtOpenBoundaries) {
  const std::string open =
      "-time_end 1 -grid_cells 16,16,16 -boundary_zmin inflow -boundary_zmin_flow_rate 1 -boundary_zmax pressure "
      "-species v -v_axis z ";
  EXPECT_EQ(parse_line(open + "-v_shape tube -v_radius .4 -v_law rigid").error, "");
  EXPECT_EQ(parse_line(open + "-v_shape slab -v_interval .4,.6 -v_shear_modulus 1").error, "");
  expect_refusals({{"-v_shape tube -v_radius .4", {"-v_shape: ", "open boundary zmin", "accepted: -v_law rigid"}},
                   {"-v_shape slab -v_interval .4,.9", {"-v_shape: ", "open boundary zmax"}},
                   {"-v_shape cylinder -v_radius .2", {"-v_shape: ", "open boundary zmin"}}},
                  open + "-v_shear_modulus 1 ");
}

TEST(SceneRefusals, PathsOfRigidBodies) {
  const std::string ball =
      "-time_end 1 -grid_cells 20,20,20 -boundary_y wall -species a,b -a_law rigid -a_shape sphere "
      "-a_radius .1 -a_centre .3,.4,.5 -b_law rigid -b_shape cylinder -b_axis z -b_radius .1 "
      "-b_centre .7,.7,.5 ";
  EXPECT_EQ(parse_line(ball + "-a_velocity 1,.1,.3").error, "");  // past it, and across the sides
  EXPECT_EQ(parse_line(ball + "-a_velocity 0,1,0 -a_velocity_angular_frequency 10").error, "");
  expect_refusals(
      {{"-a_velocity 0,.5,0", {"-a_velocity", "carries a body to y = 1", "accepted: a path between 0.1 and 0.9"}},
       {"-a_velocity 0,-.25,0", {"-a_velocity", "carries a body to y = 0.05"}},
       {"-a_velocity 0,2,0 -a_velocity_angular_frequency 9", {"-a_velocity", "carries a body to y = 0.0777"}},
       {"-a_velocity .6,.35,0",
        {"-a_velocity", "carries a body to one of b at t = 0.", "accepted: a path with a cell"}},
       {"-a_velocity .5,.35,0 -b_velocity -.1,0,0", {"-a_velocity", "carries a body to one of b at t = 0."}},
       {"-a_velocity .1,0,0 -method classic", {"-a_velocity", "-method fast"}},
       {"-a_velocity .1,0,0 -acm_iterations_max 1 -acm_search_directions 0 -acm_coarse false",
        {"-a_velocity", "-acm_iterations_max > 1"}}},
      ball);
}
