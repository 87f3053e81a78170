// HDF5 files on 1-4 ranks: what is in the file depends on the global index alone, damage is an error, and the XDMF
// index names what is there.
#include "field/ghost_exchange.hpp"
#include "io/fail_together.hpp"
#include "io/snapshot_fields.hpp"
#include "io/text_file.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

namespace eulastic {
namespace {

namespace fs = std::filesystem;

int world_rank() {
  int rank;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  return rank;
}

// A directory that all ranks share and rank 0 removes.
class SharedDirectory {
public:
  SharedDirectory() {
    int id = ::getpid();
    MPI_Bcast(&id, 1, MPI_INT, 0, PETSC_COMM_WORLD);
    path_ = fs::temp_directory_path() / ("eulastic_mpi_test_" + std::to_string(id));
    if (world_rank() == 0) fs::create_directories(path_);
    MPI_Barrier(PETSC_COMM_WORLD);
  }
  ~SharedDirectory() {
    MPI_Barrier(PETSC_COMM_WORLD);
    std::error_code ignored;
    if (world_rank() == 0) fs::remove_all(path_, ignored);
  }
  std::string operator/(const std::string &name) const { return (path_ / name).string(); }

private:
  fs::path path_;
};

// The message of a call that must fail, with PETSc's traceback off.
template <class Call>
std::string error_of(Call call) {
  const char *text;
  char *specific = nullptr;
  PetscPushErrorHandler(PetscReturnErrorHandler, nullptr);
  const PetscErrorCode code = call();
  PetscPopErrorHandler();
  if (code == 0) return "no error";
  PetscErrorMessage(code, &text, &specific);
  return specific;
}

// Distinct at every point, exact in single precision.
double value_at(int i, int j, int k, int component = 0) { return i + 32 * j + 1024 * k + 0.25 * component - 500; }

struct Scene {
  explicit Scene(const Int3 &cells, bool walls = true, MPI_Comm comm = PETSC_COMM_WORLD) {
    GridSpec spec;
    spec.cells = cells;
    spec.length = {1.0, 2.0, 3.0};
    if (walls) spec.boundary = {Boundary::wall, Boundary::wall, Boundary::periodic};
    grid.create(comm, spec);
  }
  // Owned points, and the high wall of staggered directions.
  void fill(View q, const Staggering &s, int component = 0) const {
    for (int k = 0; k < grid.points_end(2, s[2]); ++k)
      for (int j = 0; j < grid.points_end(1, s[1]); ++j)
        for (int i = 0; i < grid.points_end(0, s[0]); ++i) {
          const Int3 &begin = grid.layout().begin;
          q(i, j, k) = value_at(begin[0] + i, begin[1] + j, begin[2] + k, component);
        }
  }
  Grid grid;
};

// The dataset as one process sees it, through plain serial HDF5.
std::vector<double> whole(const std::string &path, const std::string &name, std::vector<hsize_t> *shape) {
  const Hdf5FileHandle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  const Hdf5Dataset dataset(H5Dopen2(file.get(), name.c_str(), H5P_DEFAULT));
  *shape = hdf5_shape(dataset.get());
  std::size_t count = 1;
  for (const hsize_t n : *shape) count *= n;
  std::vector<double> values(count);
  EXPECT_GE(H5Dread(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
  return values;
}

class Fields : public ::testing::TestWithParam<std::tuple<Int3, Stored, bool>> {};

TEST_P(Fields, RoundTrip) {
  const auto [cells, stored, high_wall] = GetParam();
  const SharedDirectory directory;
  const Scene scene(cells);
  const Staggering places[] = {at_centre, at_face[0], at_face[1], {true, true, false}};
  for (const Staggering &place : places) {
    SCOPED_TRACE(location_name(place));
    FieldBlock block(scene.grid, 2);
    scene.fill(block[0], place);
    const std::string path = directory / ("field_" + location_name(place) + ".h5");
    Hdf5File out;
    ASSERT_EQ(out.create(PETSC_COMM_WORLD, path), 0);
    const ConstView view = block[0];
    ASSERT_EQ(out.write_field(scene.grid, {"q", place, stored, high_wall}, {view}), 0);
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
    ASSERT_EQ(in.open(PETSC_COMM_WORLD, path), 0);
    ASSERT_EQ(in.read_field(scene.grid, "q", place, block[1]), 0);
    ASSERT_EQ(in.read_attribute("q", "location", &location), 0);
    EXPECT_EQ(location, location_name(place));
    const Grid &grid = scene.grid;
    for (int k = 0; k < grid.owned()[2]; ++k)
      for (int j = 0; j < grid.points_end(1, high_wall && place[1]); ++j)
        for (int i = 0; i < grid.points_end(0, high_wall && place[0]); ++i)
          ASSERT_EQ(block[1](i, j, k), block[0](i, j, k)) << i << " " << j << " " << k;
    if (!high_wall && place[0] && grid.touches_high(0)) {
      EXPECT_EQ(block[1](grid.owned()[0], 0, 0), 0.0) << "not in the file";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Fields,
                         ::testing::Combine(::testing::Values(Int3{7, 13, 1}, Int3{5, 13, 7}, Int3{13, 3, 3}),
                                            ::testing::Values(Stored::float32, Stored::float64, Stored::int32),
                                            ::testing::Bool()));

std::string bytes_of(const std::string &path) {
  std::stringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

TEST(Hdf5, ChecksumIsThatOfOneRank) {
  const SharedDirectory directory;
  std::string sums[2];
  for (int alone = 0; alone < 2; ++alone) {
    if (alone && world_rank() > 0) continue;
    const Scene scene({5, 13, 7}, true, alone ? PETSC_COMM_SELF : PETSC_COMM_WORLD);
    FieldBlock block(scene.grid, 1);
    scene.fill(block[0], at_face[1]);
    Hdf5File out, in;
    const std::string path = directory / ("alone_" + std::to_string(alone) + ".h5");
    ASSERT_EQ(out.create(scene.grid.comm(), path), 0);
    ASSERT_EQ(out.write_field(scene.grid, {"q", at_face[1], Stored::float64, true}, {block[0]}), 0);
    ASSERT_EQ(out.commit(), 0);
    ASSERT_EQ(in.open(scene.grid.comm(), path), 0);
    ASSERT_EQ(in.read_attribute("q", "checksum", &sums[alone]), 0);
  }
  if (world_rank() == 0) {
    EXPECT_EQ(sums[0], sums[1]);
  }
}

TEST(Hdf5, DamageIsAnError) {
  const SharedDirectory directory;
  const std::string path = directory / "damaged.h5";
  const Scene scene({5, 13, 7});
  FieldBlock block(scene.grid, 1);
  scene.fill(block[0], at_centre);
  {
    Hdf5File out;
    ASSERT_EQ(out.create(PETSC_COMM_WORLD, path), 0);
    ASSERT_EQ(out.write_field(scene.grid, {"q"}, {block[0]}), 0);
    ASSERT_EQ(out.write_array("numbers", {3}, std::vector<double>{1, 2, 3}), 0);
    ASSERT_EQ(out.commit(), 0);
  }
  const std::string good = bytes_of(path);
  const auto rewrite = [&](const std::string &bytes) {
    MPI_Barrier(PETSC_COMM_WORLD);
    if (world_rank() == 0) std::ofstream(path, std::ios::binary) << bytes;
    MPI_Barrier(PETSC_COMM_WORLD);
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
    std::vector<hsize_t> shape;
    std::vector<double> numbers;
    PetscCall(in.open(PETSC_COMM_WORLD, path));
    PetscCall(in.read_field(scene.grid, "q", at_centre, block[0]));
    PetscCall(in.read_array("numbers", &shape, &numbers));
    PetscFunctionReturn(0);
  };
  EXPECT_EQ(error_of(read), "no error");
  for (const int bit : {0, 13, 63}) {
    rewrite(flipped(value_at(3, 11, 5), bit));
    EXPECT_EQ(error_of(read), path + ": dataset q is damaged (its checksum differs)");
  }
  rewrite(flipped(3.0, 1));
  EXPECT_EQ(error_of(read), path + ": dataset numbers is damaged (its checksum differs)");
  for (const std::size_t length : {good.size() - 1, good.size() / 2, std::size_t(100), std::size_t(0)}) {
    rewrite(good.substr(0, length));
    EXPECT_NE(error_of(read).find(path + ": not an HDF5 file, or a damaged or truncated one"), std::string::npos);
  }
  rewrite(good);
  EXPECT_EQ(error_of(read), "no error");
}

TEST(Hdf5, WrongInputIsNamed) {
  const SharedDirectory directory;
  const std::string path = directory / "small.h5";
  const Scene scene({5, 13, 7}), other({5, 14, 7}), periodic({4, 13, 7}, false);
  FieldBlock block(other.grid, 1), narrow(periodic.grid, 1);
  {
    FieldBlock source(scene.grid, 1);
    Hdf5File out;
    ASSERT_EQ(out.create(PETSC_COMM_WORLD, path), 0);
    ASSERT_EQ(out.write_field(scene.grid, {"q"}, {source[0]}), 0);
    ASSERT_EQ(out.write_array("numbers", {2, 2}, std::vector<long>{1, 2, 3, 4}), 0);
    ASSERT_EQ(out.write_attribute("/", "version", std::string("1.2")), 0);
    ASSERT_EQ(out.commit(), 0);
  }
  Hdf5File in;
  ASSERT_EQ(in.open(PETSC_COMM_WORLD, path), 0);
  const auto reading = [&](const Grid &grid, const char *name, const Staggering &s, FieldBlock &to) {
    return error_of([&] { return in.read_field(grid, name, s, to[0]); });
  };
  EXPECT_EQ(reading(other.grid, "q", at_centre, block),
            path + ": dataset q is 7 x 13 x 5, the grid needs 7 x 14 x 5 (nz, ny, nx)");
  EXPECT_EQ(reading(other.grid, "p", at_centre, block), path + ": there is no dataset p");
  EXPECT_EQ(reading(other.grid, "numbers", at_centre, block),
            path + ": dataset numbers is 2 x 2, the grid needs 7 x 14 x 5 (nz, ny, nx)");
  // One point more is the high wall only where there is one and the field is staggered towards it.
  EXPECT_NE(reading(periodic.grid, "q", at_face[0], narrow), "no error");
  double number;
  EXPECT_EQ(error_of([&] { return in.read_attribute("/", "time", &number); }),
            path + ": there is no attribute time of /");
  EXPECT_NE(error_of([&] { return in.read_attribute("/", "version", &number); }), "no error");
  std::vector<hsize_t> shape;
  std::vector<long> numbers;
  ASSERT_EQ(in.read_array("numbers", &shape, &numbers), 0);
  EXPECT_EQ(shape, (std::vector<hsize_t>{2, 2}));
  EXPECT_EQ(numbers, (std::vector<long>{1, 2, 3, 4}));
  Hdf5File missing, nowhere;
  EXPECT_NE(
      error_of([&] { return missing.open(PETSC_COMM_WORLD, directory / "none.h5"); }).find("none.h5: No such file"),
      std::string::npos);
  EXPECT_NE(error_of([&] { return nowhere.create(PETSC_COMM_WORLD, directory / "no/where.h5"); }).find("No such file"),
            std::string::npos);
}

TEST(Hdf5, UnfinishedFilesVanish) {
  const SharedDirectory directory;
  const std::string path = directory / "unfinished.h5";
  {
    Hdf5File out;
    ASSERT_EQ(out.create(PETSC_COMM_WORLD, path), 0);
    EXPECT_TRUE(fs::exists(temporary_name(path)));
    MPI_Barrier(PETSC_COMM_WORLD);
  }
  MPI_Barrier(PETSC_COMM_WORLD);
  EXPECT_FALSE(fs::exists(temporary_name(path)));
  EXPECT_FALSE(fs::exists(path));
}

TEST(Hdf5, AFullDiskIsAnError) {
  const SharedDirectory directory;
  const std::string path = directory / "full.h5";
  const Scene scene({13, 17, 19});
  const FieldBlock block(scene.grid, 1);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit old_limit;
  ::getrlimit(RLIMIT_FSIZE, &old_limit);
  const rlimit limit{10000, old_limit.rlim_max};
  {
    Hdf5File out;
    ASSERT_EQ(out.create(PETSC_COMM_WORLD, path), 0);
    ::setrlimit(RLIMIT_FSIZE, &limit);
    const std::string error = error_of([&] {
      PetscFunctionBeginUser;
      PetscCall(out.write_field(scene.grid, {"q"}, {block[0]}));
      PetscCall(out.commit());
      PetscFunctionReturn(0);
    });
    ::setrlimit(RLIMIT_FSIZE, &old_limit);
    EXPECT_EQ(error, temporary_name(path) + ": File too large");
  }
  std::signal(SIGXFSZ, old_handler);
  MPI_Barrier(PETSC_COMM_WORLD);
  EXPECT_FALSE(fs::exists(path));
  EXPECT_FALSE(fs::exists(temporary_name(path)));
}

TEST(FailTogether, EveryRankGetsTheText) {
  int ranks;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  EXPECT_EQ(fail_together(PETSC_COMM_WORLD, ""), 0);
  const std::string mine = world_rank() == ranks - 1 ? "the last rank is ill" : "";
  EXPECT_EQ(error_of([&] { return fail_together(PETSC_COMM_WORLD, mine); }), "the last rank is ill");
}

// One phase, then two that share cells.
Phase make_phase(const Scene &scene, const std::string &name, double fraction, int label) {
  const auto &components = tensor_components(scene.grid.dimension());
  Phase phase;
  phase.species = name;
  phase.fraction = FieldBlock(scene.grid, 1);
  phase.tensor = FieldBlock(scene.grid, static_cast<int>(components.size()));
  phase.label = FieldBlock(scene.grid, 1);
  phase.fraction.fill(0, fraction);
  phase.label.fill(0, label);
  for (int c = 0; c < phase.tensor.count(); ++c) scene.fill(phase.tensor[c], components[c].staggering(), c);
  return phase;
}

void check_index(const SharedDirectory &directory, int snapshots) {
  const std::string text = bytes_of(directory / "snapshots.xdmf");
  std::vector<std::string> open;
  const std::regex tag("<(/?)([A-Za-z]+)((?: [A-Za-z]+=\"[^\"<>&]*\")*)(/?)>");
  std::size_t tags = 0, end = text.find("?>") + 2;
  for (std::sregex_iterator it(text.begin() + end, text.end(), tag), last; it != last; ++it, ++tags) {
    if ((*it)[1].length()) {
      ASSERT_FALSE(open.empty());
      ASSERT_EQ(open.back(), (*it)[2].str());
      open.pop_back();
    } else if (!(*it)[4].length())
      open.push_back((*it)[2].str());
  }
  EXPECT_TRUE(open.empty());
  EXPECT_EQ(tags, std::size_t(std::count(text.begin() + end, text.end(), '<')));
  const std::regex item(
      "Dimensions=\"([0-9 ]+)\" NumberType=\"([A-Za-z]+)\" Precision=\"([48])\" Format=\"HDF\">"
      "([a-z0-9_]+\\.h5):/([a-z_]+)<");
  int items = 0;
  for (std::sregex_iterator it(text.begin(), text.end(), item), last; it != last; ++it, ++items) {
    std::vector<hsize_t> shape;
    whole(directory / (*it)[4].str(), (*it)[5].str(), &shape);
    std::string dimensions;
    for (const hsize_t n : shape) dimensions += (dimensions.empty() ? "" : " ") + std::to_string(n);
    EXPECT_EQ((*it)[1].str(), dimensions) << (*it)[5].str();
  }
  EXPECT_GT(items, 0);
  EXPECT_EQ(items % snapshots, 0);
  int hdf = 0;
  for (std::size_t at = 0; (at = text.find("Format=\"HDF\"", at)) != std::string::npos; ++at) ++hdf;
  EXPECT_EQ(items, hdf);
}

void check_snapshot(const Int3 &cells, int phase_count) {
  const SharedDirectory directory;
  const Scene scene(cells);
  const int dimension = scene.grid.dimension();
  FieldBlock velocity(scene.grid, dimension), pressure(scene.grid, 1), read(scene.grid, 1);
  for (int c = 0; c < dimension; ++c) scene.fill(velocity[c], at_face[c], c);
  scene.fill(pressure[0], at_centre);
  GhostExchange exchange(scene.grid);
  ASSERT_EQ(exchange.update(velocity, 1), 0);
  std::vector<Phase> phases;
  phases.push_back(make_phase(scene, "cell", 0.5, 3));
  if (phase_count > 1) phases.push_back(make_phase(scene, "vessel", 0.75, 4));

  SnapshotSelection selection;
  selection.left_cauchy_green = true;
  SnapshotFields fields(scene.grid);
  SnapshotWriter writer(scene.grid, directory / "");
  for (int n = 0; n < 2; ++n)
    ASSERT_EQ(writer.write(0.5 * n, 10 * n, fields.collect(selection, velocity, pressure, phases)), 0);
  check_index(directory, 2);

  Hdf5File file;
  ASSERT_EQ(file.open(PETSC_COMM_WORLD, directory / "snapshot_000001.h5"), 0);
  double time, step;
  std::vector<double> spacing, length;
  ASSERT_EQ(file.read_attribute("/", "time", &time), 0);
  ASSERT_EQ(file.read_attribute("/", "step", &step), 0);
  ASSERT_EQ(file.read_attribute("/", "spacing", &spacing), 0);
  ASSERT_EQ(file.read_attribute("/", "length", &length), 0);
  EXPECT_EQ(time, 0.5);
  EXPECT_EQ(step, 10);
  EXPECT_EQ(spacing, std::vector<double>(scene.grid.spacing().begin(), scene.grid.spacing().end()));
  EXPECT_EQ(length, (std::vector<double>{1, 2, 3}));

  const auto first_value = [&](const std::string &name, const Staggering &s) {
    read.fill(0, -1);
    EXPECT_EQ(file.read_field(scene.grid, name, s, read[0]), 0) << name;
    return read[0](0, 0, 0);
  };
  const Int3 &begin = scene.grid.layout().begin;
  const double here = value_at(begin[0], begin[1], begin[2]);
  const char *const faces[] = {"velocity_x", "velocity_y", "velocity_z"};
  for (int c = 0; c < dimension; ++c) EXPECT_EQ(first_value(faces[c], at_face[c]), here + 0.25 * c);
  EXPECT_EQ(first_value("pressure", at_centre), here);
  EXPECT_EQ(first_value("solid_fraction", at_centre), phase_count == 1 ? 0.5 : 1.0);
  EXPECT_EQ(first_value("body", at_centre), phase_count == 1 ? 3 : 4);
  const auto &components = tensor_components(dimension);
  for (std::size_t c = 0; c < components.size(); ++c) {
    const std::string name = std::string("left_cauchy_green_") + "xyz"[components[c].a] + "xyz"[components[c].b];
    const double identity = components[c].a == components[c].b, b = here + 0.25 * c;
    if (phase_count == 1) {
      EXPECT_EQ(first_value(name, components[c].staggering()), b);
    } else {
      EXPECT_EQ(first_value(name, components[c].staggering()), static_cast<float>(identity + 1.25 * (b - identity)));
      EXPECT_EQ(first_value(name + "_vessel", components[c].staggering()), b);
    }
  }
  if (phase_count > 1) {
    EXPECT_EQ(first_value("solid_fraction_cell", at_centre), 0.5);
    EXPECT_EQ(first_value("solid_fraction_vessel", at_centre), 0.75);
    EXPECT_EQ(first_value("body_cell", at_centre), 3);
  }

  // At centres the mean of two faces: value_at is linear, so half a step in the component's own direction.
  std::vector<hsize_t> shape;
  const std::vector<double> centred = whole(directory / "snapshot_000000.h5", "velocity", &shape);
  ASSERT_EQ(shape, (std::vector<hsize_t>{hsize_t(cells[2]), hsize_t(cells[1]), hsize_t(cells[0]), 3}));
  const double half_step[] = {0.5, 16, 512};
  for (int k = 0; k < cells[2]; ++k)
    for (int j = 0; j < cells[1]; ++j)
      for (int i = 0; i < cells[0]; ++i)
        for (int c = 0; c < 3; ++c) {
          const double *value = &centred[3 * (i + std::size_t(cells[0]) * (j + std::size_t(cells[1]) * k)) + c];
          double expected = c < dimension ? value_at(i, j, k, c) + half_step[c] : 0;
          if (c == 2 && dimension == 3 && k == cells[2] - 1)  // z is periodic
            expected = 0.5 * (value_at(i, j, k, c) + value_at(i, j, 0, c));
          ASSERT_EQ(*value, expected) << i << " " << j << " " << k << " " << c;
        }
}

TEST(Snapshot, OnePhase) { check_snapshot({5, 13, 7}, 1); }
TEST(Snapshot, TwoPhases) { check_snapshot({5, 13, 7}, 2); }
TEST(Snapshot, Flat) { check_snapshot({7, 13, 1}, 2); }

}  // namespace
}  // namespace eulastic
