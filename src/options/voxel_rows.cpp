#include "options/voxel_rows.hpp"

namespace eulastic {

void add_voxel_rows(Rows &rows, VoxelSpec &voxels) {
  Option &path =
      rows.path("voxels", voxels.path,
                "file with solid fractions or a mask (HDF5, NRRD), or a closed surface (STL): docs/voxels.md");
  path.accepted = "a path, of HDF5 also FILE:DATASET";
  path.required = true;
  path.names_file = any_file;
  const auto unless_not_given = [](Option &option, const Real3 &value, const char *note) {
    option.default_note = note;
    option.text = [text = option.text, &value] { return value[0] == value[0] ? text() : std::string(); };
  };
  unless_not_given(rows.real("voxels_spacing", voxels.spacing, positive, "length", "size of a voxel; unit of an STL"),
                   voxels.spacing, "from the file, else the volume fills the box; 1,1,1 for an STL");
  unless_not_given(rows.real("voxels_origin", voxels.origin, any_number, "length",
                             "low corner of the first voxel; position of the point 0,0,0 of an STL"),
                   voxels.origin, "from the file if the spacing is, else 0,0,0");
  rows.boolean("voxels_invert", voxels.invert, "exchange solid and fluid of the file, for a mask of a lumen");
}

void add_anchored_row(Rows &rows, SpeciesSpec &spec) {
  bool unused = false;
  Option &row = rows.boolean(
      "anchored", unused,
      "whether the body is anchored, a wall that hardly moves (slab, tube, vessel): B is extrapolated linearly, with "
      "second order at rest");
  row.default_note = "true for slab and tubes, else false";
  row.read = [&spec](const std::string &value) {
    bool anchored = false;
    std::string wrong = read_boolean(value, &anchored);
    if (wrong.empty()) spec.anchored = anchored;
    return wrong;
  };
  row.text = [&spec] { return spec.anchored.value_or(is_anchored(spec.shape)) ? "true" : "false"; };
}

}  // namespace eulastic
