// Snapshots on 1-4 ranks: every dataset at its place, and an XDMF index that names what is there.
#include "base/rank_zero.hpp"
#include "field/ghost_exchange.hpp"
#include "io/snapshot_fields.hpp"
#include "io/text_file.hpp"
#include "support/files.hpp"
#include "support/numbered_fields.hpp"

#include <algorithm>
#include <regex>

namespace eulastic {
namespace {

using namespace test;

// One phase, then two that share cells.
Phase make_phase(const NumberedFields &scene, const std::string &name, double fraction, int label) {
  const auto &components = tensor_components(scene.domain.dimension());
  Phase phase;
  phase.species = name;
  phase.fraction = Field(scene.domain, 1);
  phase.tensor.field = Field(scene.domain, static_cast<int>(components.size()));
  phase.label = Field(scene.domain, 1);
  phase.fraction.fill(0, fraction);
  phase.label.fill(0, label);
  for (int c = 0; c < phase.tensor.field.count(); ++c) scene.fill(phase.tensor.field[c], components[c].at, c);
  return phase;
}

void check_index(const SharedDirectory &directory, int snapshots) {
  const std::string text = text_of(directory / "snapshots.xdmf");
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
  const NumberedFields scene(cells);
  const int dimension = scene.domain.dimension();
  Field velocity(scene.domain, dimension), pressure(scene.domain, 1), read(scene.domain, 1);
  for (int c = 0; c < dimension; ++c) scene.fill(velocity[c], at_face[c], c);
  scene.fill(pressure[0], at_centre);
  GhostExchange exchange(scene.domain);
  ASSERT_EQ(exchange.update_ghosts(velocity, 1), 0);
  std::vector<Phase> phases;
  phases.push_back(make_phase(scene, "cell", 0.5, 3));
  if (phase_count > 1) phases.push_back(make_phase(scene, "vessel", 0.75, 4));

  const std::vector<std::string> wanted{"velocity", "pressure", "solid_fraction", "left_cauchy_green", "body"};
  SnapshotFields fields(scene.domain);
  SnapshotWriter writer(scene.domain, directory / "", true);
  for (int n = 0; n < 2; ++n)
    ASSERT_EQ(writer.write(0.5 * n, 10 * n, fields.collect(wanted, Stored::float32, velocity, pressure, phases)), 0);
  check_index(directory, 2);

  Hdf5File file;
  ASSERT_EQ(file.open(run_communicator(), directory / "snapshot_000001.h5"), 0);
  double time, step;
  Real3 spacing, length;
  ASSERT_EQ(file.read_attribute("/", "time", &time), 0);
  ASSERT_EQ(file.read_attribute("/", "step", &step), 0);
  ASSERT_EQ(file.read_attribute("/", "spacing", spacing.data(), 3), 0);
  ASSERT_EQ(file.read_attribute("/", "length", length.data(), 3), 0);
  EXPECT_EQ(time, 0.5);
  EXPECT_EQ(step, 10);
  EXPECT_EQ(spacing, scene.domain.spacing());
  EXPECT_EQ(length, (Real3{1, 2, 3}));

  const auto first_value = [&](const std::string &name, const Staggering &s) {
    read.fill(0, -1);
    EXPECT_EQ(file.read_field(scene.domain, name, s, read[0]), 0) << name;
    return read[0](0, 0, 0);
  };
  const Int3 &begin = scene.domain.layout().begin;
  const double here = value_at(begin[0], begin[1], begin[2]);
  const char *const faces[] = {"velocity_x", "velocity_y", "velocity_z"};
  for (int c = 0; c < dimension; ++c) EXPECT_EQ(first_value(faces[c], at_face[c]), here + 0.25 * c);
  EXPECT_EQ(first_value("pressure", at_centre), here);
  EXPECT_EQ(first_value("solid_fraction", at_centre), phase_count == 1 ? 0.5 : 1.25);
  EXPECT_EQ(first_value("body", at_centre), phase_count == 1 ? 3 : 4);
  const auto &components = tensor_components(dimension);
  for (std::size_t c = 0; c < components.size(); ++c) {
    const std::string name = std::string("left_cauchy_green_") + "xyz"[components[c].a] + "xyz"[components[c].b];
    const double identity = components[c].a == components[c].b, b = here + 0.25 * c;
    if (phase_count == 1) {
      EXPECT_EQ(first_value(name, components[c].at), b);
    } else {
      EXPECT_EQ(first_value(name, components[c].at), static_cast<float>(identity + 1.25 * (b - identity)));
      EXPECT_EQ(first_value(name + "_vessel", components[c].at), b);
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

// Two runs, one after the other, with snapshots of the pressure in one directory.
class SnapshotRuns : public testing::Test {
protected:
  SnapshotRuns() {
    field.format.name = "pressure";
    field.components = {pressure[0]};
  }
  const SharedDirectory directory;
  const NumberedFields scene{{5, 13, 7}};
  const Field pressure{scene.domain, 1};
  SnapshotField field;
  SnapshotWriter first{scene.domain, directory / "", true}, second{scene.domain, directory / "", true};
};

TEST_F(SnapshotRuns, LaterOnesOfAnEarlierRunAreRemoved) {
  for (int n = 0; n < 4; ++n) ASSERT_EQ(first.write(n, n, {field}), 0);
  ASSERT_EQ(second.resume(1, true), 0);
  ASSERT_EQ(second.write(0.25, 9, {field}), 0);
  EXPECT_TRUE(fs::exists(directory / "snapshot_000001.vti"));
  EXPECT_FALSE(fs::exists(directory / "snapshot_000002.vti"));
  const std::string list = text_of(directory / "snapshots.pvd");
  EXPECT_NE(list.find("timestep=\"0\" part=\"0\" file=\"snapshot_000000.vti\""), std::string::npos) << list;
  EXPECT_NE(list.find("timestep=\"0.25\" part=\"0\" file=\"snapshot_000001.vti\""), std::string::npos) << list;
  EXPECT_EQ(list.find("000002"), std::string::npos) << list;
}

// A run that was restarted into a directory of its own begins there with a later number.
TEST_F(SnapshotRuns, TheIndexKeepsAllOfItsDirectory) {
  ASSERT_EQ(first.resume(3, false), 0);
  for (int n = 3; n < 6; ++n) ASSERT_EQ(first.write(n, n, {field}), 0);
  ASSERT_EQ(second.resume(5, true), 0);
  ASSERT_EQ(second.write(5.5, 9, {field}), 0);
  check_index(directory, 3);
  const std::string list = text_of(directory / "snapshots.pvd");
  for (const char *entry :
       {"\"3\" part=\"0\" file=\"snapshot_000003.vti\"", "\"4\" part=\"0\" file=\"snapshot_000004.vti\"",
        "\"5.5\" part=\"0\" file=\"snapshot_000005.vti\""})
    EXPECT_NE(list.find(entry), std::string::npos) << entry;
}

TEST(Snapshot, OnePhase) { check_snapshot({5, 13, 7}, 1); }
TEST(Snapshot, TwoPhases) { check_snapshot({5, 13, 7}, 2); }
TEST(Snapshot, Flat) { check_snapshot({7, 13, 1}, 2); }

}  // namespace
}  // namespace eulastic
