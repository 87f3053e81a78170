#include "io/snapshot.hpp"

#include "base/events.hpp"
#include "base/one_line.hpp"
#include "base/rank_zero.hpp"
#include "io/text_file.hpp"
#include "io/vti.hpp"

#include <cstdio>
#include <filesystem>

namespace eulastic {
namespace {

std::string index_head(const std::string &name) {
  return "<?xml version=\"1.0\"?>\n<Xdmf Version=\"2.0\">\n<Domain>\n<Grid Name=\"" + name +
         "\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
}
constexpr const char *index_tail = "</Grid>\n</Domain>\n</Xdmf>\n";

// Slowest direction first, as everywhere in XDMF.
template <class T, class Text>
std::string zyx(const std::array<T, 3> &xyz, Text text) {
  return text(xyz[2]) + " " + text(xyz[1]) + " " + text(xyz[0]);
}

std::string integer(int n) { return std::to_string(n); }

std::string file_name(int n) { return print("snapshot_%06d", n); }

std::string number_type(Stored stored) {
  return stored == Stored::int32     ? "NumberType=\"Int\" Precision=\"4\""
         : stored == Stored::float32 ? "NumberType=\"Float\" Precision=\"4\""
                                     : "NumberType=\"Float\" Precision=\"8\"";
}

// A mesh of cells of this spacing, with a line end behind each element or without.
std::string mesh(const Int3 &points, const Real3 &origin, const Real3 &spacing, const char *end) {
  const std::string triple = "<DataItem Dimensions=\"3\" NumberType=\"Float\" Precision=\"8\" Format=\"XML\">";
  return "<Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"" + zyx(points, integer) + "\"/>" + end +
         "<Geometry GeometryType=\"ORIGIN_DXDYDZ\">" + end + triple + zyx(origin, format_double) + "</DataItem>" + end +
         triple + zyx(spacing, format_double) + "</DataItem>" + end + "</Geometry>" + end;
}

// A field of cells in the file of a snapshot.
std::string attribute(const std::string &name, const SnapshotField &field, const Int3 &cells, const std::string &file) {
  const bool vector = field.components.size() == 3;
  return "<Attribute Name=\"" + name + "\" AttributeType=\"" + (vector ? "Vector" : "Scalar") +
         "\" Center=\"Cell\"><DataItem Dimensions=\"" + zyx(cells, integer) + (vector ? " 3" : "") + "\" " +
         number_type(field.format.stored) + " Format=\"HDF\">" + file + ".h5:/" + field.format.name +
         "</DataItem></Attribute>";
}

// One wall of one snapshot: a plate of cells behind the wall. One without thickness ParaView's older reader cannot.
std::string one_wall(const Box &box, const std::string &file, const SnapshotField &field) {
  const FieldFormat &format = field.format;
  Int3 cells = box.domain_cells(), points{cells[0] + 1, cells[1] + 1, cells[2] + 1};
  cells[format.plane] = 1;
  points[format.plane] = 2;
  Real3 origin{};
  origin[format.plane] = format.plane_high ? box.domain_shape().length[format.plane] : -box.spacing()[format.plane];
  return "<Grid Name=\"" + format.name + "\" GridType=\"Uniform\">" + mesh(points, origin, box.spacing(), "") +
         attribute("wall_shear_stress", field, cells, file) + "</Grid>\n";
}

// The index of the fields on walls (SnapshotField with a plane) in all snapshots `entries`; empty if there are none.
std::string wall_index(const Box &box, const std::vector<SnapshotEntry> &entries,
                       const std::vector<SnapshotField> &fields) {
  std::string text;
  for (const SnapshotEntry &entry : entries) {
    std::string walls;
    for (const SnapshotField &field : fields)
      if (field.format.plane >= 0) walls += one_wall(box, entry.name, field);
    if (walls.empty()) return {};
    text += "<Grid Name=\"walls\" GridType=\"Collection\" CollectionType=\"Spatial\"><Time Value=\"" +
            format_double(entry.time) + "\"/>\n" + walls + "</Grid>\n";
  }
  return index_head("walls") + text + index_tail;
}

// Whether visualisation tools get this field as cell data: staggered fields would be drawn half a cell too high, and
// `velocity` replaces the staggered velocity.
bool is_drawn(const FieldFormat &format) {
  const Staggering &s = format.staggering;
  return s[0] + s[1] + s[2] != 1 && format.plane < 0;
}

std::string grid_of(const Box &box, const std::string &name, double time, const std::vector<SnapshotField> &fields) {
  const Int3 &cells = box.domain_cells();
  std::string text = "<Grid Name=\"" + name + "\" GridType=\"Uniform\">\n<Time Value=\"" + format_double(time) +
                     "\"/>\n" + mesh({cells[0] + 1, cells[1] + 1, cells[2] + 1}, {0, 0, 0}, box.spacing(), "\n");
  for (const SnapshotField &field : fields)
    if (is_drawn(field.format)) text += attribute(field.format.name, field, cells, name) + "\n";
  return text + "</Grid>\n";
}

// The first `count` snapshots in the index of an earlier run, as far as it is intact.
std::vector<SnapshotEntry> read_index(const std::string &path, int count) {
  std::vector<SnapshotEntry> entries;
  std::string text;
  (void)read_file_locally(path, &text);
  const std::string head = index_head("snapshots"), tail = "</Grid>\n";
  std::size_t begin = text.compare(0, head.size(), head) == 0 ? head.size() : text.size();
  for (std::size_t end = 0; (end = text.find(tail, begin)) != std::string::npos; begin = end) {
    int number = 0;
    double time = 0;
    end += tail.size();
    const std::string grid = text.substr(begin, end - begin);
    const char *const form = "<Grid Name=\"snapshot_%d\" GridType=\"Uniform\"> <Time Value=\"%lf";
    if (std::sscanf(grid.c_str(), form, &number, &time) != 2 || number >= count) break;
    entries.push_back({file_name(number), time, grid});
  }
  return entries;
}

}  // namespace

PetscErrorCode SnapshotWriter::resume(int count, bool same_directory) {
  PetscFunctionBeginUser;
  count_ = count;
  if (!same_directory || domain_->rank() > 0) PetscFunctionReturn(0);
  index_ = read_index(directory_ + "/snapshots.xdmf", count);
  std::error_code error;  // one that stays is written over
  for (int n = count; std::filesystem::remove(directory_ + "/" + file_name(n) + ".h5", error); ++n)
    std::filesystem::remove(directory_ + "/" + file_name(n) + ".vti", error);
  PetscFunctionReturn(0);
}

PetscErrorCode SnapshotWriter::write(double time, long step, const std::vector<SnapshotField> &fields) {
  PetscFunctionBeginUser;
  EventScope scope(Event::write);
  const std::string name = file_name(count_);
  const Real3 &h = domain_->spacing(), &length = domain_->domain_shape().length;
  Hdf5File file;
  PetscCall(file.create(domain_->comm(), directory_ + "/" + name + ".h5"));
  PetscCall(file.write_attribute("/", "version", std::string(EULASTIC_VERSION)));
  PetscCall(file.write_attribute("/", "time", time));
  PetscCall(file.write_attribute("/", "step", step));
  PetscCall(file.write_attribute("/", "spacing", h));
  PetscCall(file.write_attribute("/", "length", length));
  for (const SnapshotField &field : fields) PetscCall(file.write_field(*domain_, field.format, field.components));
  PetscCall(file.commit());
  std::vector<SnapshotField> drawn, on_walls;
  for (const SnapshotField &field : fields) {
    if (is_drawn(field.format)) drawn.push_back(field);
    if (field.format.plane >= 0) on_walls.push_back(field);
  }
  if (vti_) PetscCall(write_vti(*domain_, directory_, name, time, drawn, on_walls));
  ++count_;
  index_.push_back({name, time, grid_of(*domain_, name, time, fields)});
  std::string grids;
  for (const SnapshotEntry &entry : index_) grids += entry.grid;
  PetscCall(
      write_text_file(domain_->comm(), directory_ + "/snapshots.xdmf", index_head("snapshots") + grids + index_tail));
  const std::string walls = wall_index(*domain_, index_, fields);
  if (!walls.empty()) PetscCall(write_text_file(domain_->comm(), directory_ + "/walls.xdmf", walls));
  if (vti_) PetscCall(write_pvd(domain_->comm(), directory_, index_));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
