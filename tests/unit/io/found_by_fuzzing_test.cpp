// What tests/fuzz has found, one by one.
#include "bodies/body_sums.hpp"
#include "io/hdf5_file.hpp"
#include "io/nrrd_header.hpp"
#include "support/files.hpp"

#include <cmath>
#include <fstream>
#include <limits>

using namespace eulastic;
using namespace eulastic::test;

TEST(FoundByFuzzing, SeveralStringsWhereOneIsExpected) {
  const TemporaryDirectory room;
  {
    const Hdf5FileHandle file(H5Fcreate((room / "a.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
    const hsize_t two = 2;
    const Hdf5Space space(H5Screate_simple(1, &two, nullptr));
    const Hdf5Type type(hdf5_string(9));
    const Hdf5Attribute kind(H5Acreate2(file.get(), "kind", type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT));
    ASSERT_GE(H5Awrite(kind.get(), type.get(), "123456789123456789"), 0);
  }
  Hdf5File file;
  ASSERT_EQ(file.open(PETSC_COMM_SELF, room / "a.h5"), 0);
  std::string kind;
  EXPECT_NE(error_of([&] { return file.read_attribute("/", "kind", &kind); }).find("one string"), std::string::npos);
}

TEST(FoundByFuzzing, SumsOfARunThatHasGoneWrong) {
  BodySums sums(1, 2);
  for (double term : {std::nan(""), -std::numeric_limits<double>::infinity(), 1e300, -1e300})
    for (int n = 0; n < 1000; ++n) sums.add(0, 0, term);
  sums.add(0, 1, 0.25);
  BodyOwners owners;
  ASSERT_EQ(owners.connect(PETSC_COMM_SELF, 1, {0}), 0);
  ASSERT_EQ(sums.reduce(owners), 0);
  EXPECT_GE(std::abs(sums.value(0, 0)), 1e9);
  EXPECT_EQ(sums.value(0, 1), 0.25);
}

TEST(FoundByFuzzing, ControlCharactersInTheHeaderOfAVolume) {
  const TemporaryDirectory room;
  std::ofstream(room / "a.nrrd") << "NRRD0004\ndimension: 3\rsizes: 4 4 3\n\n";
  NrrdHeader header;
  const std::string wrong = read_nrrd_header(room / "a.nrrd", &header);
  EXPECT_NE(wrong.find("dimension \"3?sizes: 4 4 3\""), std::string::npos) << wrong;
}

// Nothing of it is in the file: memory for 2^32 numbers was asked for.
TEST(FoundByFuzzing, AnArrayLargerThanItsFile) {
  const TemporaryDirectory room;
  const hsize_t chunk = 1, count = hsize_t(1) << 32;
  {
    const Hdf5FileHandle file(H5Fcreate((room / "a.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
    const Hdf5Property creation(H5Pcreate(H5P_DATASET_CREATE));
    ASSERT_GE(H5Pset_chunk(creation.get(), 1, &chunk), 0);
    const Hdf5Space space(H5Screate_simple(1, &count, nullptr));
    const Hdf5Dataset dataset(
        H5Dcreate2(file.get(), "numbers", H5T_NATIVE_LONG, space.get(), H5P_DEFAULT, creation.get(), H5P_DEFAULT));
    ASSERT_TRUE(bool(dataset));
  }
  Hdf5File file;
  ASSERT_EQ(file.open(PETSC_COMM_SELF, room / "a.h5"), 0);
  std::vector<long> values;
  const std::string error = error_of([&] { return file.read_array("numbers", &values); });
  EXPECT_NE(error.find("larger than its file"), std::string::npos) << error;
}
