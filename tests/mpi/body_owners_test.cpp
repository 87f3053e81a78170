// Sums of bodies go to the ranks that own them, and bodies.h5 is the same whoever they are.
#include "base/rank_zero.hpp"
#include "bodies/body_sums.hpp"
#include "io/bodies_file.hpp"
#include "support/files.hpp"

#include <cmath>

namespace eulastic {
namespace {

using namespace test;

struct Ranks {
  int rank = 0, ranks = 1;
  Ranks() {
    (void)MPI_Comm_rank(run_communicator(), &rank);
    (void)MPI_Comm_size(run_communicator(), &ranks);
  }
};

TEST(BodyOwners, ReduceAndBring) {
  const Ranks world;
  for (const int bodies : {1, 2, 11}) {
    std::vector<int> here;
    for (int b = 0; b < bodies; ++b)
      if ((b + world.rank) % 3 != 1) here.push_back(b);
    const auto holders = [&](int body) {
      int count = 0;
      for (int r = 0; r < world.ranks; ++r) count += (body + r) % 3 != 1;
      return count;
    };
    BodyOwners owners;
    ASSERT_EQ(owners.connect(run_communicator(), bodies, here), 0);
    const BodyRange &own = owners.owned();
    int all = own.size();
    ASSERT_EQ(MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPI_INT, MPI_SUM, run_communicator()), 0);
    EXPECT_EQ(all, bodies);
    BodySums sums(here.size(), 2);
    std::vector<double> largest, owned(static_cast<std::size_t>(own.size()), -1), brought(here.size());
    for (std::size_t slot = 0; slot < here.size(); ++slot) {
      EXPECT_EQ(owners.slot(here[slot]), static_cast<int>(slot));
      sums.add(static_cast<int>(slot), 0, -1 - 0x1p-48 * here[slot]);
      for (int n = 0; n < 1000; ++n) sums.add(static_cast<int>(slot), 1, 0x1p30);
      largest.push_back(100 * here[slot] + world.rank);
    }
    EXPECT_EQ(owners.slot(bodies), -1);
    EXPECT_EQ(owners.slot(-1), -1);
    ASSERT_EQ(sums.reduce(owners), 0);
    ASSERT_EQ(owners.reduce(1, MPI_MAX, largest, &owned), 0);
    for (int b = own.begin; b < own.end; ++b) {
      EXPECT_EQ(sums.value(b - own.begin, 0), holders(b) * (-1 - 0x1p-48 * b));
      EXPECT_EQ(sums.value(b - own.begin, 1), holders(b) * 1000 * 0x1p30);
      int last = -1;
      for (int r = 0; r < world.ranks; ++r)
        if ((b + r) % 3 != 1) last = r;
      EXPECT_EQ(owned[b - own.begin], last < 0 ? -1 : 100 * b + last);
      owned[b - own.begin] = b;
    }
    ASSERT_EQ(owners.bring(1, owned, &brought), 0);
    for (std::size_t slot = 0; slot < here.size(); ++slot) EXPECT_EQ(brought[slot], here[slot]);
    std::vector<double> first;
    ASSERT_EQ(gather_bodies(run_communicator(), bodies, 5, owned, &first), 0);
    ASSERT_EQ(first.size(), static_cast<std::size_t>(world.rank == 0 ? std::min(5, bodies) : 0));
    for (std::size_t b = 0; b < first.size(); ++b) EXPECT_EQ(first[b], double(b));
  }
}

std::vector<double> column(const std::string &path, const char *name, std::vector<hsize_t> *shape) {
  const Hdf5FileHandle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  const Hdf5Dataset dataset(H5Dopen2(file.get(), name, H5P_DEFAULT));
  *shape = hdf5_shape(dataset.get());
  std::size_t count = 1;
  for (const hsize_t n : *shape) count *= n;
  std::vector<double> values(count);
  EXPECT_GE(H5Dread(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
  return values;
}

TEST(BodyOwners, WriteOneFile) {
  const Ranks world;
  const TemporaryDirectory base;
  std::string path = base / "bodies.h5";
  char shared[1000] = "";
  std::snprintf(shared, sizeof shared, "%s", path.c_str());
  ASSERT_EQ(MPI_Bcast(shared, sizeof shared, MPI_CHAR, 0, run_communicator()), 0);
  BodiesFile file(run_communicator(), shared, {{"centroid", 3}, {"volume", 1}, {"turning_rate", 1}, {"torque", 3}});
  constexpr int rows = 23, before = 7, after = 9, change = 11;
  const auto value = [](int row, int body, int n) { return 1000. * row + 100 * body + n; };
  for (int row = 0; row < rows; ++row) {
    const int bodies = row < change ? before : after;
    static const std::string cell = "cell";
    const BodySpecies all{bodies, [](int) -> const std::string & { return cell; }};
    const BodyRange own = BodyRange::of(bodies, world.rank, world.ranks);
    std::vector<double> values;
    for (int b = own.begin; b < own.end; ++b)
      for (int n = 0; n < 8; ++n) values.push_back(value(row, b, n));
    ASSERT_EQ(file.add(0.5 * row, all, values), 0);
  }
  ASSERT_EQ(file.flush(), 0);
  if (world.rank > 0) return;
  std::vector<hsize_t> shape;
  EXPECT_EQ(column(shared, "id", &shape).size(), std::size_t(after));
  for (const auto &[name, first, width] :
       {std::tuple{"centroid", 0, 3}, {"volume", 3, 1}, {"turning_rate", 4, 1}, {"torque", 5, 3}}) {
    const std::vector<double> values = column(shared, name, &shape);
    ASSERT_EQ(values.size(), std::size_t(rows) * after * width) << name;
    for (int row = 0; row < rows; ++row)
      for (int b = 0; b < after; ++b)
        for (int d = 0; d < width; ++d) {
          const double found = values[(std::size_t(row) * after + b) * width + d];
          if (b < before || row >= change)
            EXPECT_EQ(found, value(row, b, first + d)) << name << row << b;
          else
            EXPECT_TRUE(first == 3 ? found == 0 : std::isnan(found)) << name;
        }
  }
}

}  // namespace
}  // namespace eulastic
