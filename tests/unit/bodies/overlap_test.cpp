// Bodies that are placed over each other are found, those that touch are not.
#include "bodies/overlap.hpp"
#include "bodies/near_places.hpp"
#include "support/command_line.hpp"

#include <algorithm>
#include <cmath>
#include <set>

using namespace eulastic;

namespace {

const std::string box = "-time_end 1 -grid_cells 32,32,32 -grid_length 32,32,32 ";

struct Found {
  Overlap first;
  long bodies = 0;
};

// What `parts` ranks find together, each of the bodies that come near its box.
Found find(const std::string &line, int parts = 1) {
  const ParseResult result = parse_line(line);
  EXPECT_EQ(result.error, "") << line;
  const Config &config = result.config;
  const Domain domain = Domain::planned(config.grid, parts);
  Found found;
  std::set<int> overlaps;
  for (int p = 0; p < parts; ++p) {
    std::vector<Places> near;
    for (std::size_t s = 0; s < config.species.size(); ++s) {
      const Surface surface(config.species[s], domain.dimension());
      Places &some = near.emplace_back(config.places[s]);
      const auto is_far = [&](const NumberedPlace &place) {
        const std::vector<int> ranks = ranks_near(domain, surface, place);
        const bool here = std::find(ranks.begin(), ranks.end(), p) != ranks.end();
        EXPECT_EQ(here, is_near(domain, p, surface, place));
        return !here;
      };
      some.known.erase(std::remove_if(some.known.begin(), some.known.end(), is_far), some.known.end());
    }
    Overlap first;
    const std::vector<int> some = find_overlaps(config.species, near, config.grid, &first);
    overlaps.insert(some.begin(), some.end());
    const auto key = [](const Overlap &o) { return std::make_pair(o.body, o.other); };
    if (first.body > 0 && (found.first.body == 0 || key(first) < key(found.first))) found.first = first;
  }
  found.bodies = static_cast<long>(overlaps.size());
  return found;
}

std::string sphere(const std::string &name, double radius, const std::string &centre) {
  return "-" + name + "_shape sphere -" + name + "_shear_modulus 1 -" + name + "_radius " + std::to_string(radius) +
         " -" + name + "_centre " + centre + " ";
}

// Volume common to two spheres of one radius.
double lens(double radius, double distance) {
  const double height = radius - distance / 2;
  return 2 * M_PI * height * height * (3 * radius - height) / 3;
}

TEST(Overlap, TheVolumeOfALens) {
  for (const double distance : {11.0, 9.0, 6.0}) {  // 1, 3 and 6 cells deep
    const Found found = find(box + "-species a,b " + sphere("a", 6, "10,16,16") +
                             sphere("b", 6, std::to_string(10 + distance) + ",16,16"));
    EXPECT_EQ(found.bodies, 2) << distance;
    EXPECT_EQ(found.first.body, 1);
    EXPECT_EQ(found.first.other, 2);
    EXPECT_NEAR(found.first.volume, lens(6, distance), 0.05 * lens(6, distance) + 0.3) << distance;
  }
}

TEST(Overlap, BodiesThatTouchDoNot) {
  const std::string spheres = "-species a -a_shape sphere -a_shear_modulus 1 -a_placement lattice -a_count 4,4,4 ";
  EXPECT_EQ(find(box + spheres + "-a_radius 4").bodies, 0);
  EXPECT_EQ(find(box + spheres + "-a_radius 4.001").bodies, 0);  // as the digits of a list may have it
  EXPECT_EQ(find(box + spheres + "-a_radius 4.15").bodies, 64);
  EXPECT_EQ(find(box + "-species a,b " + sphere("a", 6, "9.37,16.2,15.1") + sphere("b", 3, "18.37,16.2,15.1")).bodies,
            0);
  // Red cells one in the dimple of the other: their convex bodies overlap, they do not.
  const std::string cells =
      "-species a,b -a_shape biconcave -a_diameter 24 -a_shear_modulus 1 -a_axis z -a_centre 16,16,16 ";
  EXPECT_EQ(find(box + cells + sphere("b", 2, "16,16,20.6")).bodies, 0);
  EXPECT_EQ(find(box + cells + sphere("b", 2, "16,16,18.8")).bodies, 2);
}

TEST(Overlap, FacesOnCellFaces) {
  const std::string slab = "-species floor,a -floor_shape slab -floor_axis y -floor_shear_modulus 1 -boundary_y wall ";
  EXPECT_EQ(find(box + slab + "-floor_interval 0,10 " + sphere("a", 4, "16,14,16")).bodies, 0);
  const Found found = find(box + slab + "-floor_interval 0,11 " + sphere("a", 4, "16,14,16"));
  EXPECT_EQ(found.bodies, 2);
  const double height = 1;
  EXPECT_NEAR(found.first.volume, M_PI * height * height * (12 - height) / 3, 0.3);
}

TEST(Overlap, ThroughPeriodicSides) {
  EXPECT_EQ(find(box + "-species a,b " + sphere("a", 4, "2,16,16") + sphere("b", 4, "28,16,16")).bodies, 2);
  EXPECT_EQ(find(box + "-species a,b " + sphere("a", 4, "2,1,1") + sphere("b", 4, "29,31,30")).bodies, 2);
  EXPECT_EQ(
      find(box + "-boundary_x wall -species a,b " + sphere("a", 4, "4,16,16") + sphere("b", 4, "28,16,16")).bodies, 0);
}

TEST(Overlap, BodiesAndTheWallOfATube) {
  const std::string tube = "-species tube,a -tube_shape tube -tube_axis x -tube_radius 12 -tube_shear_modulus 1 ";
  EXPECT_EQ(find(box + tube + sphere("a", 4, "2,16,16")).bodies, 0);
  EXPECT_EQ(find(box + tube + sphere("a", 4, "2,24,16")).bodies, 0);
  EXPECT_EQ(find(box + tube + sphere("a", 4, "2,25,16")).bodies, 2);
  EXPECT_EQ(find(box + tube + sphere("a", 4, "2,31,16")).bodies, 2);  // in the wall altogether
  // Walls are joined by overlap.
  EXPECT_EQ(find(box + tube + sphere("a", 4, "2,25,16") + "-a_anchored true").bodies, 0);
  const std::string post = "-a_shape cylinder -a_axis y -a_radius 2 -a_shear_modulus 1 ";
  EXPECT_EQ(find(box + tube + post).bodies, 2);
  EXPECT_EQ(find(box + tube + post + "-a_anchored true").bodies, 0);
}

TEST(Overlap, ContactThatMerges) {
  const std::string line =
      box + "-species a -a_shape sphere -a_radius 5 -a_shear_modulus 1 -a_placement lattice -a_count 4,4,4 ";
  EXPECT_EQ(find(line).bodies, 64);
  EXPECT_EQ(find(line + "-a_contact merge").bodies, 0);  // one body by intention
}

// Looked at as if they had been listed.
TEST(Overlap, NotAtRandom) {
  const ParseResult result =
      parse_line(box +
                 "-species tube,a,b -tube_shape tube -tube_axis x -tube_radius 14 "
                 "-tube_shear_modulus 1 -a_shape ellipsoid -a_semi_axes 3,3,2 -a_shear_modulus 1 "
                 "-a_placement random -a_orientation random -a_count 20 -b_shape biconcave "
                 "-b_diameter 8 -b_shear_modulus 1 -b_placement random -b_orientation random "
                 "-b_count 25");
  ASSERT_EQ(result.error, "");
  std::vector<SpeciesSpec> species = result.config.species;
  Overlap first;
  EXPECT_TRUE(find_overlaps(species, result.config.places, result.config.grid, &first).empty());
  EXPECT_EQ(first.body, 0);
  species[1].placement = species[2].placement = Placement::list;
  EXPECT_TRUE(find_overlaps(species, result.config.places, result.config.grid, &first).empty());
}

TEST(Overlap, AnyNumberOfPartsFindsTheSame) {
  const std::string line = box +
                           "-species a,b -a_shape sphere -a_radius 3 -a_shear_modulus 1 -a_placement lattice "
                           "-a_count 3,4,5 -a_orientation random " +
                           sphere("b", 7, "13,12,11");
  const Found one = find(line);
  EXPECT_GT(one.bodies, 4);
  EXPECT_EQ(one.first.other, 61);
  for (const int parts : {2, 3, 7, 100}) {
    const Found more = find(line, parts);
    EXPECT_EQ(more.bodies, one.bodies);
    EXPECT_EQ(more.first.body, one.first.body);
    EXPECT_EQ(more.first.other, one.first.other);
    EXPECT_EQ(more.first.volume, one.first.volume);
  }
}

TEST(Overlap, InThePlane) {
  const std::string plane = "-time_end 1 -grid_cells 32,32,1 -grid_length 32,32,1 -species a,b ";
  EXPECT_EQ(find(plane + sphere("a", 4, "10,16,0") + sphere("b", 4, "18,16,0")).bodies, 0);
  const Found found = find(plane + sphere("a", 4, "10,16,0") + sphere("b", 4, "16,16,0"));
  EXPECT_EQ(found.bodies, 2);
  const double area = 2 * 16 * std::acos(0.75) - 3 * std::sqrt(64 - 36.0);
  EXPECT_LT(found.first.volume, area);
  EXPECT_GT(found.first.volume, 0.95 * area);
}

}  // namespace
