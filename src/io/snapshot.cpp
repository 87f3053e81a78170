#include "io/snapshot.hpp"

#include "base/events.hpp"
#include "io/text_file.hpp"
#include "io/vti.hpp"
#include "io/vtkhdf.hpp"
#include "io/wall_index.hpp"

#include <charconv>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

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

std::string file_name(int n) {
  char name[32];
  std::snprintf(name, sizeof name, "snapshot_%06d", n);
  return name;
}

std::string number_type(Stored stored) {
  return stored == Stored::int32     ? "NumberType=\"Int\" Precision=\"4\""
         : stored == Stored::float32 ? "NumberType=\"Float\" Precision=\"4\""
                                     : "NumberType=\"Float\" Precision=\"8\"";
}

// Whether visualisation tools get this field as cell data: staggered fields would be drawn half a cell too high, and
// `velocity` replaces the staggered velocity.
bool is_drawn(const FieldFormat &format) {
  const Staggering &s = format.staggering;
  return s[0] + s[1] + s[2] != 1 && format.plane < 0;
}

}  // namespace

std::string SnapshotWriter::index_entry(const std::string &name, double time,
                                        const std::vector<SnapshotField> &fields) const {
  const auto integer = [](int n) { return std::to_string(n); };
  const auto point = [](int n) { return std::to_string(n + 1); };
  const std::string cells = zyx(domain_->domain_cells(), integer);
  const std::string triple = "<DataItem Dimensions=\"3\" NumberType=\"Float\" Precision=\"8\" Format=\"XML\">";
  std::string text = "<Grid Name=\"" + name + "\" GridType=\"Uniform\">\n<Time Value=\"" + format_double(time) +
                     "\"/>\n<Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"" +
                     zyx(domain_->domain_cells(), point) + "\"/>\n<Geometry GeometryType=\"ORIGIN_DXDYDZ\">\n" +
                     triple + "0 0 0</DataItem>\n" + triple + zyx(domain_->spacing(), format_double) +
                     "</DataItem>\n</Geometry>\n";
  for (const SnapshotField &field : fields) {
    if (!is_drawn(field.format)) continue;
    const bool vector = field.components.size() == 3;
    text += "<Attribute Name=\"" + field.format.name + "\" AttributeType=\"" + (vector ? "Vector" : "Scalar") +
            "\" Center=\"Cell\"><DataItem Dimensions=\"" + cells + (vector ? " 3" : "") + "\" " +
            number_type(field.format.stored) + " Format=\"HDF\">" + name + ".h5:/" + field.format.name +
            "</DataItem></Attribute>\n";
  }
  return text + "</Grid>\n";
}

std::vector<SnapshotEntry> SnapshotWriter::entries() const {
  static const std::regex entry("<Grid Name=\"([^\"]*)\"[^>]*>\\s*<Time Value=\"([^\"]*)\"");
  std::vector<SnapshotEntry> entries;
  for (std::sregex_iterator it(index_.begin(), index_.end(), entry), end; it != end; ++it) {
    const std::string time = (*it)[2];
    SnapshotEntry &one = entries.emplace_back(SnapshotEntry{(*it)[1], 0});
    (void)std::from_chars(time.data(), time.data() + time.size(), one.time);
  }
  return entries;
}

PetscErrorCode SnapshotWriter::resume(int count, bool same_directory) {
  PetscFunctionBeginUser;
  count_ = count;
  if (!same_directory || domain_->rank() > 0) PetscFunctionReturn(0);
  std::stringstream text;
  text << std::ifstream(directory_ + "/snapshots.xdmf").rdbuf();
  const std::string head = index_head, entry_tail = "</Grid>\n";
  std::size_t end = text.str().compare(0, head.size(), head) == 0 ? head.size() : 0;
  for (int n = 0; n < count && end != 0; ++n) {
    const std::size_t tail = text.str().find(entry_tail, end);
    end = tail == std::string::npos ? 0 : tail + entry_tail.size();
  }
  if (end != 0) index_ = text.str().substr(head.size(), end - head.size());
  std::error_code error;  // one that stays is written over
  for (int n = count; std::filesystem::remove(directory_ + "/" + file_name(n) + ".h5", error); ++n)
    for (const char *shown : {".vtkhdf", ".vti"})
      std::filesystem::remove(directory_ + "/" + file_name(n) + shown, error);
  PetscFunctionReturn(0);
}

PetscErrorCode SnapshotWriter::write(double time, long step, const std::vector<SnapshotField> &fields) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::write);
  const std::string name = file_name(count_);
  const Real3 &h = domain_->spacing(), &length = domain_->domain_shape().length;
  Hdf5File file;
  PetscCall(file.create(domain_->comm(), directory_ + "/" + name + ".h5"));
  PetscCall(file.write_attribute("/", "version", std::string(EULASTIC_VERSION)));
  PetscCall(file.write_attribute("/", "time", time));
  PetscCall(file.write_attribute("/", "step", step));
  PetscCall(file.write_attribute("/", "spacing", std::vector<double>(h.begin(), h.end())));
  PetscCall(file.write_attribute("/", "length", std::vector<double>(length.begin(), length.end())));
  for (const SnapshotField &field : fields) PetscCall(file.write_field(*domain_, field.format, field.components));
  PetscCall(file.commit());
  std::vector<SnapshotField> drawn, on_walls;
  for (const SnapshotField &field : fields) {
    if (is_drawn(field.format)) drawn.push_back(field);
    if (field.format.plane >= 0) on_walls.push_back(field);
  }
  if (shown_ == SnapshotFormat::vtkhdf) PetscCall(write_vtkhdf(*domain_, directory_, name, drawn));
  if (shown_ == SnapshotFormat::vti) PetscCall(write_vti(*domain_, directory_, name, time, drawn, on_walls));
  ++count_;
  index_ += index_entry(name, time, fields);
  PetscCall(write_text_file(domain_->comm(), directory_ + "/snapshots.xdmf", index_head + index_ + index_tail));
  const std::vector<SnapshotEntry> all = entries();
  const std::string walls = wall_index(*domain_, all, fields);
  if (!walls.empty()) PetscCall(write_text_file(domain_->comm(), directory_ + "/walls.xdmf", walls));
  if (shown_ == SnapshotFormat::vtkhdf) PetscCall(write_vtkhdf_series(domain_->comm(), directory_, all));
  if (shown_ == SnapshotFormat::vti) PetscCall(write_pvd(domain_->comm(), directory_, all));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
