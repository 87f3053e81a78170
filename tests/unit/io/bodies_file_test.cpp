// bodies.h5 grows, and is readable all the time.
#include "io/bodies_file.hpp"
#include "io/checksum.hpp"
#include "support/files.hpp"

#include <sys/resource.h>
#include <cmath>
#include <csignal>

namespace eulastic {
namespace {

using namespace test;

struct BodyTable {
  explicit BodyTable(const std::string &path) : file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT)) {}
  std::vector<double> read(const std::string &name, std::vector<hsize_t> *shape) const {
    const Hdf5Dataset dataset(H5Dopen2(file.get(), name.c_str(), H5P_DEFAULT));
    *shape = hdf5_shape(dataset.get());
    std::size_t count = 1;
    for (const hsize_t n : *shape) count *= n;
    std::vector<double> values(count);
    EXPECT_GE(H5Dread(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
    const Hdf5Attribute attribute(H5Aopen(dataset.get(), "checksum", H5P_DEFAULT));
    std::string sum(16, ' ');
    EXPECT_GE(H5Aread(attribute.get(), hdf5_string(16).get(), sum.data()), 0);
    if (name != "id") {
      EXPECT_EQ(sum, checksum_text(checksum(values.data(), count, 0))) << name;
    }
    return values;
  }
  hsize_t rows() const {
    std::vector<hsize_t> shape;
    (void)read("time", &shape);
    return shape[0];
  }
  Hdf5FileHandle file;
};

const std::vector<BodyColumn> columns{{"centroid", 3},         {"velocity", 3},    {"volume", 1},
                                      {"rest_deformation", 1}, {"inclination", 1}, {"elastic_energy", 1}};
constexpr int width = 10;

std::vector<double> bodies_at(int row) {
  std::vector<double> values;
  for (int b = 0; b < 3; ++b)
    for (int n = 0; n < width; ++n) values.push_back(100 * row + 10 * b + n);
  return values;
}

const std::string &name_of(int label) {
  static const std::string rbc = "rbc", platelet = "platelet";
  return label < 3 ? rbc : platelet;
}
const BodySpecies three{3, name_of}, two{2, name_of};

TEST(BodiesFile, GrowsAndIsReadableAllTheTime) {
  const TemporaryDirectory base;
  const std::string path = base / "bodies.h5";
  BodiesFile file(PETSC_COMM_SELF, path, columns);
  constexpr int rows = 100;
  for (int n = 0; n < rows; ++n) {
    ASSERT_EQ(file.add(0.5 * n, three, bodies_at(n)), 0);
    EXPECT_FALSE(fs::exists(path + ".tmp"));
    const BodyTable table(path);
    ASSERT_TRUE(bool(table.file));
    EXPECT_GE(5 * table.rows(), hsize_t(4 * (n + 1))) << "a kill loses at most a fifth";
  }
  EXPECT_LT(BodyTable(path).rows(), hsize_t(rows)) << "rows wait, or the cost would be quadratic";
  ASSERT_EQ(file.flush(), 0);
  const BodyTable table(path);
  std::vector<hsize_t> shape;
  EXPECT_EQ(table.read("id", &shape), (std::vector<double>{1, 2, 3}));
  const std::vector<double> time = table.read("time", &shape);
  ASSERT_EQ(shape, (std::vector<hsize_t>{rows}));
  const std::vector<double> centroid = table.read("centroid", &shape);
  ASSERT_EQ(shape, (std::vector<hsize_t>{rows, 3, 3}));
  const std::vector<double> velocity = table.read("velocity", &shape);
  const char *const scalars[] = {"volume", "rest_deformation", "inclination", "elastic_energy"};
  for (int n = 0; n < rows; ++n) {
    EXPECT_EQ(time[n], 0.5 * n);
    for (int b = 0; b < 3; ++b)
      for (int d = 0; d < 3; ++d) {
        EXPECT_EQ(centroid[(n * 3 + b) * 3 + d], 100 * n + 10 * b + d);
        EXPECT_EQ(velocity[(n * 3 + b) * 3 + d], 100 * n + 10 * b + d + 3);
      }
  }
  for (int s = 0; s < 4; ++s) {
    const std::vector<double> values = table.read(scalars[s], &shape);
    ASSERT_EQ(shape, (std::vector<hsize_t>{rows, 3}));
    for (int n = 0; n < rows; ++n)
      for (int b = 0; b < 3; ++b) EXPECT_EQ(values[n * 3 + b], 100 * n + 10 * b + 6 + s);
  }
  const Hdf5Dataset species(H5Dopen2(table.file.get(), "species", H5P_DEFAULT));
  char names[24];
  ASSERT_GE(H5Dread(species.get(), hdf5_string(8).get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, names), 0);
  EXPECT_EQ(std::string(names, 8), std::string("rbc\0\0\0\0\0", 8));
  EXPECT_EQ(std::string(names + 16, 8), "platelet");
}

TEST(BodiesFile, SaysWhatIsWrong) {
  const TemporaryDirectory base;
  BodiesFile nowhere(PETSC_COMM_SELF, base / "no/bodies.h5", columns),
      changing(PETSC_COMM_SELF, base / "bodies.h5", columns), empty(PETSC_COMM_SELF, base / "empty.h5", columns);
  EXPECT_NE(error_of([&] { return nowhere.add(0, three, bodies_at(0)); }).find("(No such file"), std::string::npos);
  ASSERT_EQ(changing.add(0, three, bodies_at(0)), 0);
  {
    const FullDisk full_disk(1024);
    EXPECT_NE(error_of([&] { return changing.add(1, three, bodies_at(1)); }), "no error");
  }
  EXPECT_EQ(BodyTable(base / "bodies.h5").rows(), 1u) << "the old file stays";
  EXPECT_NE(error_of([&] { return changing.add(0, {}, {}); }).find("number of bodies"), std::string::npos);
  ASSERT_EQ(empty.add(0, {}, {}), 0);
  ASSERT_EQ(empty.flush(), 0);
  EXPECT_FALSE(fs::exists(base / "empty.h5"));
}

// Those that come in have columns of their own, also after a restart from before or after that.
TEST(BodiesFile, BodiesComeIn) {
  const TemporaryDirectory base;
  const std::string path = base / "bodies.h5";
  const auto some = [](int row, int count) {
    std::vector<double> bodies = bodies_at(row);
    bodies.resize(count * width);
    return bodies;
  };
  const auto check = [&](int rows, int first, int later, int change) {
    const BodyTable table(path);
    std::vector<hsize_t> shape;
    EXPECT_EQ(table.read("id", &shape).size(), std::size_t(later));
    const std::vector<double> volume = table.read("volume", &shape);
    ASSERT_EQ(shape, (std::vector<hsize_t>{hsize_t(rows), hsize_t(later)}));
    const std::vector<double> centroid = table.read("centroid", &shape);
    for (int n = 0; n < rows; ++n)
      for (int b = 0; b < later; ++b) {
        const bool there = b < first || n >= change;
        EXPECT_EQ(volume[n * later + b], there ? 100 * n + 10 * b + 6 : 0);
        const double x = centroid[(n * later + b) * 3 + 1];
        if (there)
          EXPECT_EQ(x, 100 * n + 10 * b + 1);
        else
          EXPECT_TRUE(std::isnan(x));
      }
  };
  {
    BodiesFile file(PETSC_COMM_SELF, path, columns);
    for (int n = 0; n < 30; ++n) ASSERT_EQ(file.add(n, n < 13 ? two : three, some(n, n < 13 ? 2 : 3)), 0);
    ASSERT_EQ(file.flush(), 0);
    check(30, 2, 3, 13);
  }
  for (const auto &[kept, change] : {std::pair{20L, 13}, std::pair{8L, 11}}) {
    BodiesFile file(PETSC_COMM_SELF, path, columns);
    long rows = kept;
    ASSERT_EQ(file.resume(&rows), 0);
    ASSERT_EQ(rows, kept);
    for (int n = static_cast<int>(kept); n < 25; ++n)
      ASSERT_EQ(file.add(n, n < change ? two : three, some(n, n < change ? 2 : 3)), 0);
    ASSERT_EQ(file.flush(), 0);
    check(25, 2, 3, change);
  }
}

// A copy that cannot grow is not left behind, and the file stays what it was.
TEST(BodiesFile, NothingUnfinishedStays) {
  const TemporaryDirectory base;
  const std::string path = base / "bodies.h5";
  BodiesFile file(PETSC_COMM_SELF, path, columns);
  for (int n = 0; n < 8; ++n) ASSERT_EQ(file.add(n, three, bodies_at(n)), 0);
  ASSERT_EQ(file.flush(), 0);
  const hsize_t before = BodyTable(path).rows();
  struct rlimit old {};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &old), 0);
  struct rlimit low = old;
  low.rlim_cur = fs::file_size(path) / 2;
  (void)std::signal(SIGXFSZ, SIG_IGN);
  (void)PetscPushErrorHandler(PetscReturnErrorHandler, nullptr);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &low), 0);
  ASSERT_EQ(file.add(8, three, bodies_at(8)), 0) << "it waits";
  EXPECT_NE(file.flush(), 0);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &old), 0);
  (void)PetscPopErrorHandler();
  EXPECT_FALSE(fs::exists(path + ".tmp"));
  EXPECT_EQ(BodyTable(path).rows(), before);
}

}  // namespace
}  // namespace eulastic
