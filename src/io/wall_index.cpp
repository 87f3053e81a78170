#include "io/wall_index.hpp"

#include "io/text_file.hpp"

namespace eulastic {
namespace {

// One wall of one snapshot: a plate of cells behind the wall. One without thickness ParaView's older reader cannot.
std::string one_wall(const Box &box, const std::string &file, const SnapshotField &field) {
  const FieldFormat &format = field.format;
  Int3 cells = box.domain_cells(), points{cells[0] + 1, cells[1] + 1, cells[2] + 1};
  cells[format.plane] = 1;
  points[format.plane] = 2;
  Real3 origin{};
  origin[format.plane] = format.plane_high ? box.domain_shape().length[format.plane] : -box.spacing()[format.plane];
  const auto zyx = [](const auto &x, auto text) { return text(x[2]) + " " + text(x[1]) + " " + text(x[0]); };
  const auto integer = [](int n) { return std::to_string(n); };
  const std::string triple = "<DataItem Dimensions=\"3\" NumberType=\"Float\" Precision=\"8\" Format=\"XML\">";
  return "<Grid Name=\"" + format.name + "\" GridType=\"Uniform\"><Topology TopologyType=\"3DCoRectMesh\" " +
         "Dimensions=\"" + zyx(points, integer) + "\"/><Geometry GeometryType=\"ORIGIN_DXDYDZ\">" + triple +
         zyx(origin, format_double) + "</DataItem>" + triple + zyx(box.spacing(), format_double) +
         "</DataItem></Geometry><Attribute Name=\"wall_shear_stress\" AttributeType=\"Vector\" Center=\"Cell\">" +
         "<DataItem Dimensions=\"" + zyx(cells, integer) + " 3\" NumberType=\"Float\" Precision=\"" +
         (format.stored == Stored::float32 ? "4" : "8") + "\" Format=\"HDF\">" + file + ".h5:/" + format.name +
         "</DataItem></Attribute></Grid>\n";
}

}  // namespace

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
  return "<?xml version=\"1.0\"?>\n<Xdmf Version=\"2.0\">\n<Domain>\n"
         "<Grid Name=\"walls\" GridType=\"Collection\" CollectionType=\"Temporal\">\n" +
         text + "</Grid>\n</Domain>\n</Xdmf>\n";
}

}  // namespace eulastic
