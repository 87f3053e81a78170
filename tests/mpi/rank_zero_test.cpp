// Files are what rank 0 finds. Every rank looks for them in a place of its own: nobody but rank 0 may go there.
#include "base/rank_zero.hpp"
#include "options/parse_options.hpp"
#include "support/all_bodies.hpp"
#include "support/files.hpp"

#include <gtest/gtest.h>

namespace eulastic {
namespace {

class RankZero : public ::testing::Test {
protected:
  // Where rank `there` has its files, as this rank sees it: the others see nothing at all, or files of nonsense.
  std::string place(const std::string &name) const { return room_ / (name + std::to_string(test::world_rank())); }
  void put(int there, const std::string &name, const std::string &text) const {
    if (test::world_rank() == there) std::ofstream(place(name), std::ios::binary) << text;
    MPI_Barrier(run_communicator());
  }
  static bool same_everywhere(std::string text) {
    const std::string mine = text;
    share(&text);
    int same = text == mine;
    MPI_Allreduce(MPI_IN_PLACE, &same, 1, MPI_INT, MPI_MIN, run_communicator());
    return same == 1;
  }
  const test::SharedDirectory room_;
};

}  // namespace

TEST_F(RankZero, AllHaveItsBytes) {
  const std::string odd("a\0b\r\n\n", 6);
  put(0, "odd", odd);
  put(0, "empty", "");
  put(1, "elsewhere", "not here");
  std::string bytes = "before";
  EXPECT_TRUE(is_file(place("odd")));
  EXPECT_TRUE(read_file(place("odd"), &bytes));
  EXPECT_EQ(bytes, odd);
  EXPECT_TRUE(read_file(place("empty"), &bytes));
  EXPECT_EQ(bytes, "");
  EXPECT_FALSE(is_file(place("elsewhere")));
  EXPECT_FALSE(read_file(place("elsewhere"), &bytes));
  EXPECT_FALSE(read_file(room_ / "", &bytes));  // a directory
}

TEST_F(RankZero, MoreThanAPiece) {
  std::vector<std::uint64_t> values;
  const std::size_t count = (std::size_t{1} << 23) + 3;
  if (test::world_rank() == 0)
    for (std::size_t n = 0; n < count; ++n) values.push_back(n * n);
  share(&values);
  ASSERT_EQ(values.size(), count);
  for (std::size_t n = 0; n < count; ++n) ASSERT_EQ(values[n], n * n);
}

TEST_F(RankZero, AlsoForOptionsAndWhatTheyName) {
  put(0, "scene",
      "-grid_cells 8,8,8 -boundary_x wall -boundary_xmin inflow -boundary_xmax outflow\n"
      "-time_end 1 -species a,v -a_shape sphere -a_radius .05 -a_placement list -a_shear_modulus 1\n"
      "-v_shape voxels -v_law rigid -check_only\n");
  put(0, "places", ".25,.25,.25\n.75,.75,.75,10,20,30\n");
  put(0, "table", "0,1\n1,2\n");
  put(0, "volume", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: ascii\n\n0 0 1 0 0 0 0 1\n");
  const auto result = [&](const std::string &scene) {
    return parse({place(scene), "-a_positions", place("places"), "-boundary_xmin_velocity", place("table"), "-v_voxels",
                  place("volume")});
  };
  const ParseResult fine = result("scene");
  ASSERT_EQ(fine.error, "");
  const Places places = test::with_all_places(fine.config).places[0];
  ASSERT_EQ(places.known.size(), 2u);
  EXPECT_EQ(places.known[1].orientation, (Real3{10, 20, 30}));
  EXPECT_EQ(fine.config.sides[0][0].given.table.size(), 2u);
  EXPECT_EQ(fine.config.solid_volumes[1], 0.25);
  EXPECT_NE(result("none").error.find("cannot be read"), std::string::npos);
  put(0, "places", "1,2\n");
  EXPECT_NE(result("scene").error.find("line 1: a row has 2 numbers"), std::string::npos);
  EXPECT_TRUE(same_everywhere(result("scene").error));
  put(0, "table", "");
  EXPECT_NE(result("scene").error.find("holds no numbers"), std::string::npos);
}

}  // namespace eulastic
