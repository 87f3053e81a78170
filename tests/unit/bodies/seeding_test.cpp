// Random placement: no overlap, the hematocrit that was asked for, the same scene again, refusals.
#include "bodies/crowd.hpp"
#include "bodies/shapes.hpp"
#include "support/command_line.hpp"

#include <algorithm>
#include <cmath>

using namespace eulastic;

namespace {

const std::string box = "-time_end 1 -grid_cells 32,32,32 -grid_length 42,42,42 ";
const std::string cells =
    "-rbc_shape biconcave -rbc_diameter 8 -rbc_shear_modulus 1 -rbc_placement random -rbc_orientation random ";

std::vector<NumberedPlace> seeded(const std::string &line, std::size_t species = 0) {
  const ParseResult result = parse_line(line);
  EXPECT_EQ(result.error, "") << line;
  return result.error.empty() ? result.config.places[species].known : std::vector<NumberedPlace>();
}

// Points all over the surface of a body, in the box.
std::vector<Real3> surface_points(const SpeciesSpec &spec, const BodyPlace &place, int dimension) {
  const Surface surface(spec, dimension);
  const Rotation q = rotation(place.orientation);
  std::vector<Real3> points;
  constexpr int rows = 12;
  for (int i = 0; i < 2 * rows; ++i)
    for (int j = dimension == 2 ? rows / 2 : 0; j <= (dimension == 2 ? rows / 2 : rows); ++j) {
      const double a = M_PI * i / rows, b = M_PI * j / rows;
      const Real3 n{std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), dimension == 2 ? 0 : std::cos(b)};
      double low = 0, high = 2 * surface.bounding_radius();
      for (int turn = 0; turn < 40; ++turn) {
        const double r = (low + high) / 2;
        (surface.level({r * n[0], r * n[1], r * n[2]}) < 0 ? low : high) = r;
      }
      Real3 x = place.centre;
      for (int d = 0; d < 3; ++d) x[d] += low * (q[d][0] * n[0] + q[d][1] * n[1] + q[d][2] * n[2]);
      points.push_back(x);
    }
  return points;
}

// Least level of the other bodies at the surface points of each, in the nearest image: negative where they overlap.
double least_level(const Config &config) {
  const int dimension = config.grid.cells[2] == 1 ? 2 : 3;
  double least = 1e9;
  for (std::size_t s = 0; s < config.species.size(); ++s)
    for (std::size_t b = 0; b < config.places[s].known.size(); ++b) {
      if (is_anchored(config.species[s].shape)) continue;
      for (const Real3 &x : surface_points(config.species[s], config.places[s].known[b], dimension))
        for (std::size_t t = 0; t < config.species.size(); ++t)
          for (std::size_t c = 0; c < config.places[t].known.size(); ++c) {
            if (t == s && c == b) continue;
            const BodyPlace &other = config.places[t].known[c];
            Real3 r, y{};
            for (int d = 0; d < 3; ++d) {
              r[d] = x[d] - other.centre[d];
              if (config.grid.boundary[d] == Boundary::periodic && !is_anchored(config.species[t].shape))
                r[d] -= config.grid.length[d] * std::round(r[d] / config.grid.length[d]);
            }
            if (r[0] * r[0] + r[1] * r[1] + r[2] * r[2] > 100 && !is_anchored(config.species[t].shape)) continue;
            const Rotation q = rotation(other.orientation);
            for (int d = 0; d < 3; ++d)
              for (int e = 0; e < 3; ++e) y[d] += q[e][d] * r[e];
            if (dimension == 2) y[2] = 0;
            least = std::min(least, Surface(config.species[t], dimension).level(y));
          }
    }
  return least;
}

double reached(const ParseResult &result, const std::string &word) {
  const std::size_t at = result.error.find(word);
  return at == std::string::npos ? -1 : std::stod(result.error.substr(at + word.size()));
}

}  // namespace

TEST(Seeding, ConvexBodiesHoldTheirShapes) {
  SpeciesSpec spec;
  spec.radius = 4;
  spec.axis = 2;
  spec.semi_axes = {2, 2.5, 1.6};
  for (const Shape shape : {Shape::sphere, Shape::biconcave, Shape::ellipsoid}) {
    spec.shape = shape;
    const Surface surface(spec, 3);
    const ConvexBody body(spec, 3, 0);
    double widest = 0;
    for (int i = 0; i < 40; ++i)
      for (int j = 0; j < 40; ++j) {
        const double a = 2 * M_PI * i / 40, b = M_PI * (j + 0.5) / 40;
        const Real3 n{std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), std::cos(b)}, y = body.core(n);
        const double excess = n[0] * y[0] + n[1] * y[1] + n[2] * y[2] + body.rounding() - surface.support(n);
        EXPECT_GE(excess, -1e-5);
        widest = std::max(widest, excess);
      }
    EXPECT_LT(widest, shape == Shape::biconcave ? 0.35 : 0.02 * spec.semi_axes[1]);
    EXPECT_LE(surface.bounding_radius(), body.outer_radius() + 1e-5);
  }
}

TEST(Seeding, SeparatedAgreesWithTheDistanceOfDiscs) {
  SpeciesSpec spec;
  spec.shape = Shape::biconcave;
  spec.radius = 4;
  const ConvexBody body(spec, 3, 0);
  const double thick = 2 * body.rounding(), wide = 2 * body.outer_radius();
  const PlacedConvex flat{&body, {}, rotation({})};  // axis y
  const auto at = [&](const Real3 &x, const Real3 &turn) { return PlacedConvex{&body, x, rotation(turn)}; };
  EXPECT_TRUE(separated(flat, at({0, 1.001 * thick, 0}, {}), {}));
  EXPECT_FALSE(separated(flat, at({0, 0.999 * thick, 0}, {}), {}));
  EXPECT_TRUE(separated(flat, at({1.001 * wide, 0, 0}, {}), {}));
  EXPECT_FALSE(separated(flat, at({0.999 * wide, 0, 0}, {}), {}));
  EXPECT_TRUE(separated(flat, at({0, 1.001 * (thick + wide) / 2, 0}, {0, 0, 90}), {}));  // edge on face
  EXPECT_FALSE(separated(flat, at({0, 0.99 * (thick + wide) / 2, 0}, {0, 0, 90}), {}));
  EXPECT_TRUE(separated(flat, at({20, 0, 0}, {}), {}));
  EXPECT_FALSE(separated(flat, at({20, 0, 0}, {}), {-20, 0.5, 0}));
}

TEST(Seeding, HematocritAsAskedWithinOneCellWithoutOverlap) {
  for (const double h : {0.0, 0.03, 0.2, 0.4}) {
    const ParseResult result =
        parse_line(box + "-boundary_y wall -species rbc " + cells + "-rbc_hematocrit " + std::to_string(h));
    ASSERT_EQ(result.error, "");
    const double cell = shape_volume(result.config.species[0], 3), whole = 42.0 * 42 * 42;
    EXPECT_NEAR(double(result.config.places[0].known.size()) * cell, h * whole, 0.5001 * cell);
    EXPECT_GT(least_level(result.config), 0);
  }
  EXPECT_EQ(seeded(box + "-species rbc " + cells + "-rbc_count 17").size(), 17u);
}

// Random sites of a regular packing stop at 36 to 44 % in these.
TEST(Seeding, DenseCrowdsMoveAndTurnUntilTheyFit) {
  const std::string domain = "-time_end 1 -grid_cells 16,16,16 -grid_length ";
  const std::string scenes[] = {"33,22,22 -boundary_y wall -boundary_z wall -species rbc ",
                                "24,24,24 -boundary_x wall -boundary_y wall -boundary_z wall -species rbc ",
                                "40,32,32 -species rbc,v -v_shape tube -v_axis x -v_radius 15 -v_law rigid "};
  for (const std::string &scene : scenes) {
    const ParseResult result = parse_line(domain + scene + cells + "-rbc_hematocrit 0.45");
    ASSERT_EQ(result.error, "") << scene;
    const Config &config = result.config;
    const double cell = shape_volume(config.species[0], 3);
    double region = 1;
    for (const double length : config.grid.length) region *= length;
    if (config.species.size() > 1) region = lumen_volume(config.species[1], config.grid);
    EXPECT_NEAR(config.places[0].count * cell, 0.45 * region, 0.5001 * cell) << scene;
    EXPECT_GT(least_level(config), 0) << scene;
  }
  const auto one = seeded(domain + scenes[0] + cells + "-rbc_hematocrit 0.45"),
             again = seeded(domain + scenes[0] + cells + "-rbc_hematocrit 0.45"),
             other = seeded(domain + scenes[0] + cells + "-rbc_hematocrit 0.45 -rbc_seed 2");
  for (std::size_t b = 0; b < one.size(); ++b) {
    EXPECT_EQ(one[b].centre, again[b].centre);
    EXPECT_EQ(one[b].orientation, again[b].orientation);
    EXPECT_NE(one[b].centre, other[b].centre);
  }
}

// Sites beyond the box do not come back into the lumen on its other side.
TEST(Seeding, BodiesInATubeOfAPeriodicBoxDoNotOverlap) {
  const ParseResult result = parse_line(
      "-time_end 1 -grid_cells 16,16,16 -grid_length 40,24,24 -species rbc,v -v_shape tube -v_axis x -v_radius 11 "
      "-v_law rigid " +
      cells + "-rbc_hematocrit 0.35");
  ASSERT_EQ(result.error, "");
  EXPECT_GT(least_level(result.config), 0);
}

TEST(Seeding, PenetrationOfSpheresAndOfDiscsSideBySide) {
  SpeciesSpec spec;
  spec.shape = Shape::sphere;
  spec.radius = 1;
  const ConvexBody ball(spec, 3, 0);
  const Penetration deep = penetration({&ball, {1, 1, 1}, rotation({})}, {&ball, {1, 2.5, 1}, rotation({})}, {});
  EXPECT_NEAR(deep.depth, 0.5, 1e-12);
  EXPECT_NEAR(deep.normal[1], 1, 1e-12);
  EXPECT_NEAR(deep.point[1], 0.75, 1e-12);
  spec.shape = Shape::biconcave;
  spec.radius = 4;
  const ConvexBody disc(spec, 3, 0);
  const double half = disc.rounding(), flat = disc.outer_radius() - half;
  for (const double tilt : {0.0, 0.3, 2.0})
    for (const double apart : {-0.2, -0.02, 0.02}) {
      // Coaxial but for the tilt about x: the lowest point of the rim is flat sin(tilt) lower than the centre.
      const double y = 2 * half + flat * std::sin(tilt * M_PI / 180) + apart;
      const PlacedConvex low{&disc, {0, 0, 0}, rotation({})}, high{&disc, {0, y, 0}, rotation({tilt, 0, 0})};
      const double depth = penetration(low, high, {}).depth;
      if (apart > 0)
        EXPECT_EQ(depth, 0) << tilt;
      else
        EXPECT_NEAR(depth, -apart, 2e-4 * half) << tilt << " " << apart;
    }
}

TEST(Seeding, BodiesKeepOffSidesThatVolumeCrosses) {
  const std::string open = "-boundary_y wall -boundary_xmin inflow -boundary_xmin_velocity 1 -boundary_xmax outflow ";
  const ParseResult result = parse_line(box + open + "-species rbc " + cells + "-rbc_hematocrit 0.25");
  ASSERT_EQ(result.error, "");
  double least[2][2] = {{42, 42}, {42, 42}};  // at x and y
  for (const BodyPlace &place : result.config.places[0].known)
    for (const Real3 &x : surface_points(result.config.species[0], place, 3))
      for (int d = 0; d < 2; ++d) {
        least[d][0] = std::min(least[d][0], x[d]);
        least[d][1] = std::min(least[d][1], 42 - x[d]);
      }
  constexpr double h = 42.0 / 32;
  for (const int high : {0, 1}) {
    EXPECT_GE(least[0][high], 3 * h);
    EXPECT_LT(least[1][high], 2 * h);  // at walls they may be
    EXPECT_GE(least[1][high], 0);
  }
}

TEST(Seeding, OrientationsAreRandomEvenWhenCrowded) {
  // At 30 % all begin aligned. Mean of cos^2 with each direction: 1/3; 74 cells at random scatter by 0.035.
  for (const char *h : {"0.1", "0.3"}) {
    Real3 mean{};
    const auto places = seeded(box + "-species rbc " + cells + "-rbc_hematocrit " + h);
    for (const BodyPlace &place : places) {
      const Rotation q = rotation(place.orientation);
      for (int d = 0; d < 3; ++d) mean[d] += q[d][1] * q[d][1] / double(places.size());
    }
    std::printf("  hematocrit %s: mean squares of the axes %.3f %.3f %.3f\n", h, mean[0], mean[1], mean[2]);
    for (int d = 0; d < 3; ++d) EXPECT_NEAR(mean[d], 1.0 / 3, 0.12);
  }
}

// More than 20000 begin as copies of a block: still random orientations, no overlap, clear of walls, no two alike.
TEST(Seeding, ManyBodiesAreNoLattice) {
  const std::string line =
      "-time_end 1 -grid_cells 64,64,64 -grid_length 300,240,180 -boundary_y wall -species dot,rbc -dot_shape sphere "
      "-dot_radius 1 -dot_shear_modulus 1 -dot_placement random -dot_count 500 " +
      cells + "-rbc_hematocrit 0.2";
  const ParseResult result = parse_line(line);
  ASSERT_EQ(result.error, "");
  const GridSpec &grid = result.config.grid;
  const SpeciesSpec &dot = result.config.species[0], &rbc = result.config.species[1];
  const auto &places = result.config.places[1].known;
  EXPECT_NEAR(double(places.size()) * shape_volume(rbc, 3), 0.2 * 300 * 240 * 180, 0.5001 * shape_volume(rbc, 3));
  EXPECT_GT(places.size(), 25000u);
  Real3 mean{};
  Crowd crowd(grid, 8.5, places.size());
  const ConvexBody shape(rbc, 3, 0), ball(dot, 3, 0);
  for (const BodyPlace &place : result.config.places[0].known) crowd.add({&ball, place.centre, rotation({})});
  for (const BodyPlace &place : places) crowd.add({&shape, place.centre, rotation(place.orientation)});
  std::size_t touching = 0, outside = 0, alike = 0;
  std::vector<Real3> centres;
  for (std::size_t b = 0; b < crowd.size(); ++b) {
    touching += !crowd.has_room_for(crowd[b], b);
    const double half = crowd[b].half_width(1);
    outside += crowd[b].centre[1] < half || crowd[b].centre[1] > 240 - half;
    if (b < 500) continue;
    for (int d = 0; d < 3; ++d) mean[d] += crowd[b].rotation[d][1] * crowd[b].rotation[d][1] / double(places.size());
    centres.push_back(crowd[b].centre);
  }
  EXPECT_EQ(touching, 0u);
  EXPECT_EQ(outside, 0u);
  std::sort(centres.begin(), centres.end());
  for (std::size_t b = 1; b < centres.size(); ++b) alike += centres[b][0] == centres[b - 1][0];
  EXPECT_LT(alike, centres.size() / 100) << "centres with the same x as another";
  std::printf("  %zu bodies: mean squares of the axes %.3f %.3f %.3f, %zu alike\n", places.size(), mean[0], mean[1],
              mean[2], alike);
  for (int d = 0; d < 3; ++d) EXPECT_NEAR(mean[d], 1.0 / 3, 0.06);
}

TEST(Seeding, SeveralSpeciesInsideATube) {
  std::string line =
      "-time_end 1 -grid_cells 48,32,32 -grid_length 50,27,27 -boundary_y wall -boundary_z wall -species "
      "vessel,rbc,plt "
      "-vessel_shape tube -vessel_axis x -vessel_diameter 26 -vessel_shear_modulus 1 " +
      cells +
      "-rbc_hematocrit 0.2 -plt_shape ellipsoid -plt_semi_axes 2,2,1.6 -plt_shear_modulus 1 -plt_placement random "
      "-plt_count 12 -plt_orientation random -plt_gap 0.1 ";
  const ParseResult result = parse_line(line);
  ASSERT_EQ(result.error, "");
  const double lumen = M_PI * 13 * 13 * 50, cell = shape_volume(result.config.species[1], 3);
  EXPECT_NEAR(double(result.config.places[1].known.size()) * cell, 0.2 * lumen, 0.5001 * cell);
  EXPECT_EQ(result.config.places[2].known.size(), 12u);
  EXPECT_GT(least_level(result.config), 0);
  EXPECT_EQ(parse_line(line + "-rbc_inside vessel").error, "");
  for (const char *wrong : {"-rbc_inside plt", "-rbc_inside nothing"})
    EXPECT_EQ(parse_line(line + wrong).error.rfind("-rbc_inside: ", 0), 0u);
  // A throat that the cells cannot pass: none there.
  line.replace(line.find("shape tube"), 10, "shape constricted_tube -vessel_throat_radius 2 -vessel_throat_length 20");
  line.replace(line.find("hematocrit 0.2"), 14, "hematocrit 0.1");
  const ParseResult throat = parse_line(line);
  ASSERT_EQ(throat.error, "");
  EXPECT_GT(least_level(throat.config), 0);
  for (const BodyPlace &place : throat.config.places[1].known) EXPECT_GT(std::abs(place.centre[0] - 25), 3);
}

TEST(Seeding, StaysClearOfSlabsCylindersAndEarlierBodies) {
  const std::string line =
      box +
      "-species floor,post,ball,rbc -floor_shape slab -floor_axis y -floor_interval 0,9 "
      "-floor_shear_modulus 1 -post_shape cylinder -post_radius 3 -post_axis z -post_centre 1,20,0 "
      "-post_shear_modulus 1 -ball_shape sphere -ball_radius 5 -ball_shear_modulus 1 " +
      cells + "-rbc_hematocrit 0.2";
  const ParseResult result = parse_line(line);
  ASSERT_EQ(result.error, "");
  const double cell = shape_volume(result.config.species[3], 3), free = 42.0 * 42 * 33;
  EXPECT_NEAR(double(result.config.places[3].known.size()) * cell, 0.2 * free, 0.5001 * cell);
  Config bodies = result.config;  // the slab and the post by hand
  const SpeciesSpec rbc = bodies.species[3];
  for (const BodyPlace &place : bodies.places[3].known)
    for (Real3 x : surface_points(rbc, place, 3)) {
      for (double &c : x) c -= 42 * std::floor(c / 42);
      EXPECT_GT(x[1], 9);
      EXPECT_GT(std::hypot(x[0] - 1 - 42 * std::round((x[0] - 1) / 42), x[1] - 20), 3);
    }
  bodies.species.erase(bodies.species.begin(), bodies.species.begin() + 2);
  bodies.places.erase(bodies.places.begin(), bodies.places.begin() + 2);
  EXPECT_GT(least_level(bodies), 0);
}

// Red cells as solids lie on the walls; their membranes would begin in a film that the grid does not resolve.
TEST(Seeding, MembranesKeepACellFromWallsAndHalfOfOneFromTheMiddleBetweenThem) {
  const std::string red_cells = " -rbc_law red_cell -rbc_diameter 8 -rbc_placement random -rbc_orientation random ";
  const std::string tube =
      "-time_end 1 -grid_cells 48,32,32 -grid_length 48,32,32 -boundary_y wall -boundary_z wall "
      "-species vessel,rbc -vessel_shape tube -vessel_axis x -vessel_radius 13 -vessel_law rigid ";
  const std::string plates = "-time_end 1 -grid_cells 48,40,32 -grid_length 24,20,16 -boundary_y wall -species ";
  for (const std::string &line :
       {plates + "rbc -rbc_hematocrit 0.3" + red_cells,
        plates +
            "floor,rbc -floor_shape slab -floor_axis y -floor_interval 0,2.2 -floor_law rigid -rbc_hematocrit .25" +
            red_cells,
        tube + "-rbc_hematocrit 0.2" + red_cells, plates + "rbc -rbc_hematocrit 0.25 -rbc_gap 0" + red_cells}) {
    const ParseResult result = parse_line(line);
    ASSERT_EQ(result.error, "") << line;
    const Config &config = result.config;
    const double h = config.grid.longest_spacing(), round_off = 1e-6;
    const std::size_t last = config.species.size() - 1;
    const SpeciesSpec &wall = config.species[0];
    EXPECT_EQ(config.species[last].gap, line.find("_gap 0") == std::string::npos ? h : 0);
    double nearest = 1e9;
    for (const BodyPlace &place : config.places[last].known)
      for (const Real3 &x : surface_points(config.species[last], place, 3)) {
        const double floor = wall.shape == Shape::slab ? wall.interval[1] : 0;
        const double beside = wall.shape == Shape::tube ? wall.radius - std::hypot(x[1] - 16, x[2] - 16)
                                                        : std::min(x[1] - floor, config.grid.length[1] - x[1]);
        nearest = std::min(nearest, beside);
      }
    EXPECT_GT(nearest, h - round_off) << line;
    EXPECT_LT(nearest, 3 * h) << line;
    if (config.species[last].gap == 0) continue;
    Config bodies = config;  // grown by half the gap they are still apart
    bodies.species = {config.species[last]};
    bodies.places = {config.places[last]};
    EXPECT_GT(least_level(bodies), 0.5 * h) << line;
  }
}

TEST(Seeding, TheSeedIsTheScene) {
  const std::string line = box + "-species rbc " + cells + "-rbc_hematocrit 0.15 ";
  const auto one = seeded(line), again = seeded(line), other = seeded(line + "-rbc_seed 2");
  ASSERT_EQ(one.size(), other.size());
  std::size_t different = 0;
  for (std::size_t b = 0; b < one.size(); ++b) {
    EXPECT_EQ(one[b].centre, again[b].centre);
    EXPECT_EQ(one[b].orientation, again[b].orientation);
    different += one[b].centre != other[b].centre;
  }
  EXPECT_EQ(different, one.size());
  // Nothing of the grid or of other species is in it.
  const auto finer = seeded("-time_end 1 -grid_cells 64,48,40 -grid_length 42,42,42 -species rbc,ball " + cells +
                            "-rbc_hematocrit 0.15 -ball_shape sphere -ball_radius 1 -ball_shear_modulus 1 "
                            "-ball_placement random -ball_count 3");
  ASSERT_EQ(finer.size(), one.size());
  for (std::size_t b = 0; b < one.size(); ++b) EXPECT_EQ(one[b].centre, finer[b].centre);
}

TEST(Seeding, TheCountOfTheCommandLineWins) {
  const std::string line = box + "-species rbc -rbc_shape sphere -rbc_radius 2 -rbc_shear_modulus 1 -rbc_placement ";
  const ParseResult random = parse_line(line + "random -rbc_count 5", "-rbc_count 2,2,2");
  const ParseResult lattice = parse_line(line + "lattice -rbc_count 2,2,2", "-rbc_count 5");
  EXPECT_EQ(random.error + lattice.error, "");
  EXPECT_EQ(random.config.places[0].known.size(), 5u);
  EXPECT_EQ(lattice.config.places[0].known.size(), 8u);
}

TEST(Seeding, TwoDimensions) {
  const std::string line =
      "-time_end 1 -grid_cells 64,64,1 -grid_length 60,60,1 -boundary_y wall -species rbc,dot " + cells +
      "-rbc_hematocrit 0.3 -dot_shape sphere -dot_radius 1 -dot_shear_modulus 1 -dot_placement random -dot_count 20";
  const ParseResult result = parse_line(line);
  ASSERT_EQ(result.error, "");
  const double cell = shape_volume(result.config.species[0], 2);
  EXPECT_NEAR(double(result.config.places[0].known.size()) * cell, 0.3 * 3600, 0.5001 * cell);
  EXPECT_GT(least_level(result.config), 0);
}

TEST(Seeding, RefusesWhatDoesNotFitAndSaysWhatDoes) {
  const std::string line = box + "-species rbc " + cells;
  const ParseResult much = parse_line(line + "-rbc_hematocrit 0.8");
  ASSERT_EQ(much.error.rfind("-rbc_hematocrit: ", 0), 0u) << much.error;
  const double most = reached(much, "do not fit; "), hematocrit = reached(much, ", hematocrit ");
  EXPECT_GT(hematocrit, 0.4);
  EXPECT_NEAR(hematocrit, most * 100.74 / (42.0 * 42 * 42), 1e-3);
  EXPECT_EQ(seeded(line + "-rbc_count " + std::to_string(int(most))).size(), most);
  EXPECT_NE(parse_line(line + "-rbc_count 20000000").error.find("at most 10000000"), std::string::npos);
  EXPECT_NE(
      parse_line(box + "-species a -a_shape sphere -a_radius 22 -a_shear_modulus 1 -a_placement random -a_count 1")
          .error.find("do not fit; 0 could be placed"),
      std::string::npos);
  const auto refused = [&](const std::string &options, const std::string &option) {
    const std::string error = parse_line(line + options).error;
    EXPECT_EQ(error.rfind(option, 0), 0u) << options << ": " << error;
  };
  refused("", "-rbc_placement: random needs either");
  refused("-rbc_count 3 -rbc_hematocrit 0.1", "-rbc_placement: random needs either");
  refused("-rbc_count 3,3,3", "-rbc_count: ");
  refused("-rbc_count -3", "-rbc_count: ");
  refused("-rbc_hematocrit 1.1", "-rbc_hematocrit: ");
  refused("-rbc_hematocrit -0.1", "-rbc_hematocrit: ");
  refused("-rbc_count 3 -rbc_jitter 0.1", "-rbc_jitter: ");
  refused("-rbc_count 3 -rbc_orientation any", "-rbc_orientation: ");
  refused("-rbc_count 3 -rbc_shape slab -rbc_interval 1,2", "-rbc_");
  EXPECT_EQ(
      parse_line(box + "-species a -a_shape sphere -a_radius 1 -a_shear_modulus 1 -a_placement lattice -a_count 3")
          .error.rfind("-a_count: ", 0),
      0u);
  const ParseResult many = parse_line(box +
                                      "-species a -a_shape sphere -a_radius .1 -a_shear_modulus 1 "
                                      "-a_placement lattice -a_count 400,400,400");
  EXPECT_EQ(many.error.rfind("-a_count: ", 0), 0u);
}

TEST(Lattice, JitterStaysInsideWhatIsFree) {
  const std::string line = box +
                           "-species a -a_shape sphere -a_radius 4 -a_shear_modulus 1 -a_placement lattice "
                           "-a_count 4,4,4 -a_jitter ";
  const ParseResult result = parse_line(line + "1");
  ASSERT_EQ(result.error, "");
  EXPECT_GT(least_level(result.config), -1e-9);
  const auto regular = seeded(line + "0"), half = seeded(line + "0.5");
  double farthest = 0;
  for (std::size_t b = 0; b < regular.size(); ++b)
    for (int d = 0; d < 3; ++d) farthest = std::max(farthest, std::abs(half[b].centre[d] - regular[b].centre[d]));
  EXPECT_LE(farthest, 0.5 * (42.0 / 8 - 4) * (1 + 1e-12));
  EXPECT_GT(farthest, 0.4 * (42.0 / 8 - 4));
}
