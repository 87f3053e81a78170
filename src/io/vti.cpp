#include "io/vti.hpp"

#include "io/fail_together.hpp"
#include "io/text_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

namespace eulastic {
namespace {

constexpr const char *stress_name = "wall_shear_stress";

std::size_t bytes_of(Stored stored) { return stored == Stored::float64 ? 8 : 4; }

const char *vtk_type(Stored stored) {
  return stored == Stored::int32 ? "Int32" : stored == Stored::float32 ? "Float32" : "Float64";
}

// Copies a snapshot of HDF5 into a .vti file, plane by plane. One rank does, without MPI.
class Copy {
public:
  Copy(const Box &box, const std::vector<SnapshotField> &drawn, const std::vector<SnapshotField> &walls)
      : cells_(box.domain_cells()), spacing_(box.spacing()), arrays_(drawn), walls_(walls) {
    const auto is_stress = [](const SnapshotField &array) { return array.format.name == stress_name; };
    if (walls.empty() || std::any_of(drawn.begin(), drawn.end(), is_stress)) return;
    arrays_.push_back(walls[0]);
    arrays_.back().format.name = stress_name;
  }

  // Empty, or what went wrong.
  std::string make(const std::string &from, const std::string &to, double time) {
    from_ = Hdf5FileHandle(H5Fopen(from.c_str(), H5F_ACC_RDONLY, hdf5_local_access().get()));
    if (!from_) return "cannot read " + from;
    to_.reset(std::fopen(temporary_name(to).c_str(), "we"));
    if (!to_) return "cannot create " + to + ": " + std::strerror(errno);
    bool written = write(head(time));
    for (const SnapshotField &array : arrays_) written = written && write_array(array);
    written = written && write("\n  </AppendedData>\n</VTKFile>\n");
    const bool closed = std::fclose(to_.release()) == 0;
    return replace_file(to, closed && written ? "" : "cannot write " + to + ": " + std::strerror(errno));
  }

private:
  std::size_t values_of_plane(const SnapshotField &array) const {
    return std::size_t(cells_[0]) * std::size_t(cells_[1]) * array.components.size();
  }
  std::uint64_t bytes_of(const SnapshotField &array) const {
    return std::uint64_t(cells_[2]) * values_of_plane(array) * eulastic::bytes_of(array.format.stored);
  }
  // Counts of bytes have 4 bytes in files of version 0.1, which older programs read, and 8 in those of version 1.0.
  bool is_large() const {
    for (const SnapshotField &array : arrays_)
      if (bytes_of(array) > UINT32_MAX) return true;
    return false;
  }

  std::string head(double time) const {
    const auto number = [](long long n) { return std::to_string(n); };
    const std::string extent = "0 " + number(cells_[0]) + " 0 " + number(cells_[1]) + " 0 " + number(cells_[2]);
    std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=";
    text += is_large() ? "\"1.0\" header_type=\"UInt64\"" : "\"0.1\"";
    text += " byte_order=\"LittleEndian\">\n  <ImageData WholeExtent=\"" + extent + "\" Origin=\"0 0 0\" Spacing=\"" +
            format_double(spacing_[0]) + " " + format_double(spacing_[1]) + " " + format_double(spacing_[2]) +
            "\">\n    <FieldData>\n      <DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" "
            "format=\"ascii\">" +
            format_double(time) + "</DataArray>\n    </FieldData>\n    <Piece Extent=\"" + extent +
            "\">\n      <CellData>\n";
    std::uint64_t offset = 0;
    for (const SnapshotField &array : arrays_) {
      text += std::string("        <DataArray type=\"") + vtk_type(array.format.stored) + "\" Name=\"" +
              array.format.name + "\" NumberOfComponents=\"" + std::to_string(array.components.size()) +
              "\" format=\"appended\" offset=\"" + std::to_string(offset) + "\"/>\n";
      offset += bytes_of(array) + (is_large() ? 8 : 4);
    }
    return text + "      </CellData>\n    </Piece>\n  </ImageData>\n  <AppendedData encoding=\"raw\">\n   _";
  }

  bool write(const void *data, std::size_t bytes) { return std::fwrite(data, 1, bytes, to_.get()) == bytes; }
  bool write(const std::string &text) { return write(text.data(), text.size()); }

  bool write_array(const SnapshotField &array) {
    const std::uint64_t bytes = bytes_of(array);
    const auto less = static_cast<std::uint32_t>(bytes);
    if (!(is_large() ? write(&bytes, sizeof bytes) : write(&less, sizeof less))) return false;
    return array.format.stored == Stored::float32   ? write_planes<float>(array)
           : array.format.stored == Stored::float64 ? write_planes<double>(array)
                                                    : write_planes<int>(array);
  }

  template <class T>
  bool write_planes(const SnapshotField &array) {
    std::vector<T> plane(values_of_plane(array));
    const bool there = H5Lexists(from_.get(), array.format.name.c_str(), H5P_DEFAULT) > 0;
    for (int k = 0; k < cells_[2]; ++k) {
      if (there && !read(array.format.name, k, cells_[1], cells_[0], array, &plane)) return false;
      if (!there) std::fill(plane.begin(), plane.end(), T{});
      if (array.format.name == stress_name)
        for (const SnapshotField &wall : walls_)
          if (!add_wall(array, wall.format, k, &plane)) return false;
      if (!write(plane.data(), plane.size() * sizeof(T))) return false;
    }
    return true;
  }

  // Reads nx x ny values of plane k of a dataset.
  template <class T>
  bool read(const std::string &name, int k, int ny, int nx, const SnapshotField &array, std::vector<T> *values) const {
    const Hdf5Dataset dataset(H5Dopen2(from_.get(), name.c_str(), H5P_DEFAULT));
    const Hdf5Block plane{
        array.components.size() > 1 ? 4 : 3, {hsize_t(k)}, {1, hsize_t(ny), hsize_t(nx), array.components.size()}};
    return read_block(dataset.get(), plane, hdf5_type<T>(), values->data());
  }

  // The stress on a wall of the box where it is larger than what the cell beside it holds.
  template <class T>
  bool add_wall(const SnapshotField &array, const FieldFormat &wall, int k, std::vector<T> *plane) const {
    const int d = wall.plane, edge = wall.plane_high ? cells_[d] - 1 : 0;
    if (d == 2 && k != edge) return true;
    const int nx = d == 0 ? 1 : cells_[0], ny = d == 1 ? 1 : cells_[1];
    std::vector<T> stress(std::size_t(nx) * std::size_t(ny) * 3);
    if (!read(wall.name, d == 2 ? 0 : k, ny, nx, array, &stress)) return false;
    const auto squared = [](const T *v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; };
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        const T *here = &stress[3 * (std::size_t(j) * std::size_t(nx) + std::size_t(i))];
        T *cell =
            &(*plane)[3 * (std::size_t(d == 1 ? edge : j) * std::size_t(cells_[0]) + std::size_t(d == 0 ? edge : i))];
        if (squared(here) > squared(cell)) std::copy_n(here, 3, cell);
      }
    return true;
  }

  Int3 cells_;
  Real3 spacing_;
  std::vector<SnapshotField> arrays_, walls_;
  Hdf5FileHandle from_;
  std::unique_ptr<std::FILE, int (*)(std::FILE *)> to_{nullptr, std::fclose};
};

}  // namespace

PetscErrorCode write_vti(const Domain &domain, const std::string &directory, const std::string &name, double time,
                         const std::vector<SnapshotField> &drawn, const std::vector<SnapshotField> &walls) {
  PetscFunctionBeginUser;
  const std::string path = directory + "/" + name;
  std::string problem;
  if (domain.rank() == 0) problem = Copy(domain, drawn, walls).make(path + ".h5", path + ".vti", time);
  PetscCall(fail_together(domain.comm(), problem));
  PetscFunctionReturn(0);
}

PetscErrorCode write_pvd(MPI_Comm comm, const std::string &directory, const std::vector<SnapshotEntry> &entries) {
  int rank;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n  <Collection>\n";
  for (const SnapshotEntry &entry : entries) {
    std::error_code error;
    if (rank > 0 || !std::filesystem::exists(directory + "/" + entry.name + ".vti", error)) continue;  // rank 0 writes
    text +=
        "    <DataSet timestep=\"" + format_double(entry.time) + "\" part=\"0\" file=\"" + entry.name + ".vti\"/>\n";
  }
  PetscCall(write_text_file(comm, directory + "/snapshots.pvd", text + "  </Collection>\n</VTKFile>\n"));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
