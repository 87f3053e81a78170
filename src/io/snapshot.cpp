#include "io/snapshot.hpp"

#include "base/events.hpp"
#include "io/text_file.hpp"

#include <cstdio>

namespace eulastic {
namespace {

constexpr const char *index_head =
    "<?xml version=\"1.0\"?>\n<Xdmf Version=\"2.0\">\n<Domain>\n"
    "<Grid Name=\"snapshots\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
constexpr const char *index_tail = "</Grid>\n</Domain>\n</Xdmf>\n";

// Slowest direction first, as everywhere in XDMF.
template <class T, class Text>
std::string zyx(const std::array<T, 3> &xyz, Text text) {
  return text(xyz[2]) + " " + text(xyz[1]) + " " + text(xyz[0]);
}

std::string number_type(Stored stored) {
  return stored == Stored::int32     ? "NumberType=\"Int\" Precision=\"4\""
         : stored == Stored::float32 ? "NumberType=\"Float\" Precision=\"4\""
                                     : "NumberType=\"Float\" Precision=\"8\"";
}

}  // namespace

// A grid of cells, every field at their centres: one that is staggered is drawn half a cell too high, and the
// staggered velocity is left to `velocity`.
std::string SnapshotWriter::index_entry(const std::string &name, double time,
                                        const std::vector<SnapshotField> &fields) const {
  const auto integer = [](int n) { return std::to_string(n); };
  const auto point = [](int n) { return std::to_string(n + 1); };
  const std::string cells = zyx(grid_->cells(), integer);
  const std::string triple = "<DataItem Dimensions=\"3\" NumberType=\"Float\" Precision=\"8\" Format=\"XML\">";
  std::string text = "<Grid Name=\"" + name + "\" GridType=\"Uniform\">\n<Time Value=\"" + format_double(time) +
                     "\"/>\n<Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"" + zyx(grid_->cells(), point) +
                     "\"/>\n<Geometry GeometryType=\"ORIGIN_DXDYDZ\">\n" + triple + "0 0 0</DataItem>\n" + triple +
                     zyx(grid_->spacing(), format_double) + "</DataItem>\n</Geometry>\n";
  for (const SnapshotField &field : fields) {
    const Staggering &s = field.format.staggering;
    if (s[0] + s[1] + s[2] == 1) continue;
    const bool vector = field.components.size() == 3;
    text += "<Attribute Name=\"" + field.format.name + "\" AttributeType=\"" + (vector ? "Vector" : "Scalar") +
            "\" Center=\"Cell\"><DataItem Dimensions=\"" + cells + (vector ? " 3" : "") + "\" " +
            number_type(field.format.stored) + " Format=\"HDF\">" + name + ".h5:/" + field.format.name +
            "</DataItem></Attribute>\n";
  }
  return text + "</Grid>\n";
}

PetscErrorCode SnapshotWriter::write(double time, long step, const std::vector<SnapshotField> &fields) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::write);
  char name[32];
  std::snprintf(name, sizeof name, "snapshot_%06d", count_);
  const Real3 &h = grid_->spacing(), &length = grid_->spec().length;
  Hdf5File file;
  PetscCall(file.create(grid_->comm(), directory_ + "/" + name + ".h5"));
  PetscCall(file.write_attribute("/", "version", std::string(EULASTIC_VERSION)));
  PetscCall(file.write_attribute("/", "time", time));
  PetscCall(file.write_attribute("/", "step", step));
  PetscCall(file.write_attribute("/", "spacing", std::vector<double>(h.begin(), h.end())));
  PetscCall(file.write_attribute("/", "length", std::vector<double>(length.begin(), length.end())));
  for (const SnapshotField &field : fields) PetscCall(file.write_field(*grid_, field.format, field.components));
  PetscCall(file.commit());
  ++count_;
  index_ += index_entry(name, time, fields);
  PetscCall(write_text_file(grid_->comm(), directory_ + "/snapshots.xdmf", index_head + index_ + index_tail));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
