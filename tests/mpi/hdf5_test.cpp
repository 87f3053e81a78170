// HDF5 files on 1-4 ranks: what is in the file depends on the global index alone, and damage is an error.
#include "base/body_range.hpp"
#include "base/rank_zero.hpp"
#include "io/fail_together.hpp"
#include "io/hdf5_file.hpp"
#include "io/text_file.hpp"
#include "support/files.hpp"
#include "support/numbered_fields.hpp"

namespace eulastic {
namespace {

using namespace test;

class Fields : public ::testing::TestWithParam<std::tuple<Int3, Stored, bool>> {};

TEST_P(Fields, RoundTrip) {
  const auto [cells, stored, high_wall] = GetParam();
  const SharedDirectory directory;
  const NumberedFields scene(cells);
  const Staggering places[] = {at_centre, at_face[0], at_face[1], {true, true, false}};
  for (const Staggering &place : places) {
    SCOPED_TRACE(location_name(place));
    Field block(scene.domain, 2);
    scene.fill(block[0], place);
    const std::string path = directory / ("field_" + location_name(place) + ".h5");
    Hdf5File out;
    ASSERT_EQ(out.create(run_communicator(), path), 0);
    const ConstView view = block[0];
    ASSERT_EQ(out.write_field(scene.domain, {"q", place, stored, high_wall}, {view}), 0);
    EXPECT_FALSE(fs::exists(path)) << "visible before it is complete";
    ASSERT_EQ(out.commit(), 0);
    EXPECT_TRUE(fs::exists(path));
    EXPECT_FALSE(fs::exists(temporary_name(path)));

    std::vector<hsize_t> shape;
    const std::vector<double> stored_values = whole(path, "q", &shape);
    const hsize_t nx = cells[0] + (high_wall && place[0]), ny = cells[1] + (high_wall && place[1]), nz = cells[2];
    ASSERT_EQ(shape, (std::vector<hsize_t>{nz, ny, nx}));
    std::size_t at = 0;
    for (hsize_t k = 0; k < nz; ++k)
      for (hsize_t j = 0; j < ny; ++j)
        for (hsize_t i = 0; i < nx; ++i) ASSERT_EQ(stored_values[at++], value_at(i, j, k)) << i << " " << j << " " << k;

    Hdf5File in;
    std::string location;
    ASSERT_EQ(in.open(run_communicator(), path), 0);
    ASSERT_EQ(in.read_field(scene.domain, "q", place, block[1]), 0);
    ASSERT_EQ(in.read_attribute("q", "location", &location), 0);
    EXPECT_EQ(location, location_name(place));
    const Domain &domain = scene.domain;
    for (int k = 0; k < domain.cells()[2]; ++k)
      for (int j = 0; j < domain.points_end(1, high_wall && place[1]); ++j)
        for (int i = 0; i < domain.points_end(0, high_wall && place[0]); ++i)
          ASSERT_EQ(block[1](i, j, k), block[0](i, j, k)) << i << " " << j << " " << k;
    if (!high_wall && place[0] && domain.touches_high(0)) {
      EXPECT_EQ(block[1](domain.cells()[0], 0, 0), 0.0) << "not in the file";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Fields,
                         ::testing::Combine(::testing::Values(Int3{7, 13, 1}, Int3{5, 13, 7}, Int3{13, 3, 3}),
                                            ::testing::Values(Stored::float32, Stored::float64, Stored::int32),
                                            ::testing::Bool()));

TEST(Hdf5, ChecksumIsThatOfOneRank) {
  const SharedDirectory directory;
  std::string sums[2];
  for (int alone = 0; alone < 2; ++alone) {
    if (alone && world_rank() > 0) continue;
    const NumberedFields scene({5, 13, 7}, true, alone ? PETSC_COMM_SELF : run_communicator());
    Field block(scene.domain, 1);
    scene.fill(block[0], at_face[1]);
    Hdf5File out, in;
    const std::string path = directory / ("alone_" + std::to_string(alone) + ".h5");
    ASSERT_EQ(out.create(scene.domain.comm(), path), 0);
    ASSERT_EQ(out.write_field(scene.domain, {"q", at_face[1], Stored::float64, true}, {block[0]}), 0);
    ASSERT_EQ(out.commit(), 0);
    ASSERT_EQ(in.open(scene.domain.comm(), path), 0);
    ASSERT_EQ(in.read_attribute("q", "checksum", &sums[alone]), 0);
  }
  if (world_rank() == 0) {
    EXPECT_EQ(sums[0], sums[1]);
  }
}

TEST(Hdf5, DamageIsAnError) {
  const SharedDirectory directory;
  const std::string path = directory / "damaged.h5";
  const NumberedFields scene({5, 13, 7});
  Field block(scene.domain, 1);
  scene.fill(block[0], at_centre);
  {
    Hdf5File out;
    ASSERT_EQ(out.create(run_communicator(), path), 0);
    ASSERT_EQ(out.write_field(scene.domain, {"q"}, {block[0]}), 0);
    ASSERT_EQ(out.write_array("numbers", std::vector<double>{1, 2, 3}), 0);
    ASSERT_EQ(out.commit(), 0);
  }
  const std::string good = text_of(path);
  const auto rewrite = [&](const std::string &bytes) {
    MPI_Barrier(run_communicator());
    if (world_rank() == 0) std::ofstream(path, std::ios::binary) << bytes;
    MPI_Barrier(run_communicator());
  };
  const auto flipped = [&](double value, int bit) {
    std::string bytes = good;
    const std::size_t at = bytes.find(std::string(reinterpret_cast<const char *>(&value), sizeof value));
    EXPECT_NE(at, std::string::npos);
    bytes[at + bit / 8] ^= static_cast<char>(1 << bit % 8);
    return bytes;
  };
  const auto read = [&] {
    PetscFunctionBeginUser;
    Hdf5File in;
    std::vector<double> numbers;
    PetscCall(in.open(run_communicator(), path));
    PetscCall(in.read_field(scene.domain, "q", at_centre, block[0]));
    PetscCall(in.read_array("numbers", &numbers));
    EXPECT_EQ(numbers, (std::vector<double>{1, 2, 3}));
    const BodyRange own = BodyRange::of(3, world_rank(), scene.domain.ranks());
    std::vector<double> mine(own.size());
    PetscCall(in.read_own("numbers", &mine));
    EXPECT_EQ(mine, (std::vector<double>{numbers.begin() + own.begin, numbers.begin() + own.end}));
    PetscFunctionReturn(0);
  };
  EXPECT_EQ(error_of(read), "no error");
  for (const int bit : {0, 13, 63}) {
    rewrite(flipped(value_at(3, 11, 5), bit));
    EXPECT_EQ(error_of(read), path + ": dataset q is damaged: its values do not have its checksum");
  }
  rewrite(flipped(3.0, 1));
  EXPECT_EQ(error_of(read), path + ": dataset numbers is damaged: its values do not have its checksum");
  for (const std::size_t length : {good.size() - 1, good.size() / 2, std::size_t(100), std::size_t(0)}) {
    rewrite(good.substr(0, length));
    EXPECT_NE(error_of(read).find(path + ": is not an HDF5 file, or is damaged or truncated"), std::string::npos);
  }
  rewrite(good);
  EXPECT_EQ(error_of(read), "no error");
}

TEST(Hdf5, WrongInputIsNamed) {
  const SharedDirectory directory;
  const std::string path = directory / "small.h5";
  const NumberedFields scene({5, 13, 7}), other({5, 14, 7}), periodic({4, 13, 7}, false);
  Field block(other.domain, 1), narrow(periodic.domain, 1);
  {
    Field source(scene.domain, 1);
    Hdf5File out;
    ASSERT_EQ(out.create(run_communicator(), path), 0);
    ASSERT_EQ(out.write_field(scene.domain, {"q"}, {source[0]}), 0);
    ASSERT_EQ(out.write_array("numbers", std::vector<long>{1, 2, 3, 4}), 0);
    ASSERT_EQ(out.write_attribute("/", "version", std::string("1.2")), 0);
    ASSERT_EQ(out.commit(), 0);
  }
  Hdf5File in;
  ASSERT_EQ(in.open(run_communicator(), path), 0);
  const auto reading = [&](const Domain &domain, const char *name, const Staggering &s, Field &to) {
    return error_of([&] { return in.read_field(domain, name, s, to[0]); });
  };
  EXPECT_EQ(reading(other.domain, "q", at_centre, block),
            path + ": dataset q is 7 x 13 x 5, the grid needs 7 x 14 x 5 (nz, ny, nx)");
  EXPECT_EQ(reading(other.domain, "p", at_centre, block), path + ": there is no dataset p");
  EXPECT_EQ(reading(other.domain, "numbers", at_centre, block),
            path + ": dataset numbers is 4, the grid needs 7 x 14 x 5 (nz, ny, nx)");
  // One point more is the high wall only where there is one and the field is staggered towards it.
  EXPECT_NE(reading(periodic.domain, "q", at_face[0], narrow), "no error");
  double number;
  EXPECT_EQ(error_of([&] { return in.read_attribute("/", "time", &number); }),
            path + ": there is no attribute time of /");
  EXPECT_NE(error_of([&] { return in.read_attribute("/", "version", &number); }), "no error");
  std::vector<long> numbers;
  ASSERT_EQ(in.read_array("numbers", &numbers), 0);
  EXPECT_EQ(numbers, (std::vector<long>{1, 2, 3, 4}));
  EXPECT_EQ(error_of([&] { return in.read_array("q", &numbers); }),
            path + ": dataset q is 7 x 13 x 5; accepted: a list");
  numbers.resize(5);
  EXPECT_NE(error_of([&] { return in.read_own("numbers", &numbers); }).find("belongs to another case: it is 4, this"),
            std::string::npos);
  Hdf5File missing, nowhere;
  EXPECT_NE(
      error_of([&] { return missing.open(run_communicator(), directory / "none.h5"); }).find("none.h5: No such file"),
      std::string::npos);
  EXPECT_NE(
      error_of([&] { return nowhere.create(run_communicator(), directory / "no/where.h5"); }).find("No such file"),
      std::string::npos);
}

TEST(Hdf5, UnfinishedFilesVanish) {
  const SharedDirectory directory;
  const std::string path = directory / "unfinished.h5";
  {
    Hdf5File out;
    ASSERT_EQ(out.create(run_communicator(), path), 0);
    EXPECT_TRUE(fs::exists(temporary_name(path)));
    MPI_Barrier(run_communicator());
  }
  MPI_Barrier(run_communicator());
  EXPECT_FALSE(fs::exists(temporary_name(path)));
  EXPECT_FALSE(fs::exists(path));
}

TEST(Hdf5, AFullDiskIsAnError) {
  const SharedDirectory directory;
  const std::string path = directory / "full.h5";
  const NumberedFields scene({13, 17, 19});
  const Field block(scene.domain, 1);
  {
    Hdf5File out;
    ASSERT_EQ(out.create(run_communicator(), path), 0);
    std::string error;
    {
      const FullDisk full_disk(10000);
      error = error_of([&] {
        PetscFunctionBeginUser;
        PetscCall(out.write_field(scene.domain, {"q"}, {block[0]}));
        PetscCall(out.commit());
        PetscFunctionReturn(0);
      });
    }
    EXPECT_EQ(error, temporary_name(path) + ": File too large");
  }
  MPI_Barrier(run_communicator());
  EXPECT_FALSE(fs::exists(path));
  EXPECT_FALSE(fs::exists(temporary_name(path)));
}

TEST(FailTogether, EveryRankGetsTheText) {
  int ranks;
  MPI_Comm_size(run_communicator(), &ranks);
  EXPECT_EQ(fail_together(run_communicator(), ""), 0);
  const std::string mine = world_rank() == ranks - 1 ? "the last rank is ill" : "";
  EXPECT_EQ(error_of([&] { return fail_together(run_communicator(), mine); }), "the last rank is ill");
}

}  // namespace
}  // namespace eulastic
