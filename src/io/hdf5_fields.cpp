// Hdf5File: fields.
#include "io/checksum.hpp"
#include "io/fail_together.hpp"
#include "io/hdf5_file.hpp"
#include "io/text_file.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <cerrno>
#include <cstring>

namespace eulastic {
namespace {

std::string shape_text(const std::vector<hsize_t> &shape) {
  std::string text;
  for (const hsize_t n : shape) text += (text.empty() ? "" : " x ") + std::to_string(n);
  return text.empty() ? "a scalar" : text;
}

// Takes the disk space of a dataset before it is written: Open MPI's collective writes may lose the error of a full
// disk. Empty, or what went wrong. Not every file system can.
std::string reserve(const std::string &path, haddr_t offset, hsize_t bytes) {
  const int file = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  const bool refused = ::fallocate(file, 0, static_cast<off_t>(offset), static_cast<off_t>(bytes)) != 0 &&
                       (errno == ENOSPC || errno == EDQUOT || errno == EFBIG);
  const std::string problem = refused ? path + ": " + std::strerror(errno) : std::string();
  (void)::close(file);
  return problem;
}

}  // namespace

std::string location_name(const Staggering &staggering) {
  std::string axes;
  for (int d = 0; d < 3; ++d)
    if (staggering[d]) axes += "xyz"[d];
  return axes.empty() ? "centre" : (axes.size() == 1 ? "face_" : axes.size() == 2 ? "edge_" : "vertex_") + axes;
}

Hdf5File::Hyperslab Hdf5File::owned_box(const Box &box, const Int3 &extra, std::size_t components) {
  Hyperslab slab;
  for (int d = 0; d < 3; ++d) {
    slab.total[2 - d] = box.domain_cells()[d] + extra[d];
    slab.begin[2 - d] = box.layout().begin[d];
    slab.count[2 - d] = box.cells()[d] + (box.touches_high(d) ? extra[d] : 0);
  }
  if (components > 1) {
    slab.rank = 4;
    slab.begin[3] = 0;
    slab.total[3] = slab.count[3] = components;
  }
  return slab;
}

namespace {

// This rank's share of the checksum; `values` fill the box, rows of the last dimension(s) are contiguous.
template <class T, class Hyperslab>
std::uint64_t box_checksum(const Hyperslab &slab, const std::vector<T> &values) {
  const hsize_t width = slab.rank == 4 ? slab.total[3] : 1, row = slab.count[2] * width;
  std::uint64_t sum = 0;
  for (hsize_t k = 0; k < slab.count[0]; ++k)
    for (hsize_t j = 0; j < slab.count[1]; ++j) {
      const hsize_t first =
          (((slab.begin[0] + k) * slab.total[1] + slab.begin[1] + j) * slab.total[2] + slab.begin[2]) * width;
      sum += checksum(values.data() + (k * slab.count[1] + j) * row, row, first);
    }
  return sum;
}

}  // namespace

template <class T>
PetscErrorCode Hdf5File::write_values(const std::string &name, const Hyperslab &slab, hid_t file_type,
                                      const std::vector<T> &values) {
  PetscFunctionBeginUser;
  const Hdf5Space file_space(H5Screate_simple(slab.rank, slab.total, nullptr));
  const Hdf5Space memory_space(H5Screate_simple(slab.rank, slab.count, nullptr));
  const Hdf5Property creation(H5Pcreate(H5P_DATASET_CREATE));
  (void)H5Pset_fill_time(creation.get(), H5D_FILL_TIME_NEVER);  // every point is written
  Hdf5Dataset dataset(
      H5Dcreate2(file_.get(), name.c_str(), file_type, file_space.get(), H5P_DEFAULT, creation.get(), H5P_DEFAULT));
  PetscCall(check(bool(dataset), "cannot create dataset " + name));
  const haddr_t offset = H5Dget_offset(dataset.get());
  const hsize_t bytes = H5Dget_storage_size(dataset.get());
  PetscCall(fail_together(comm_, mpi_rank_ == 0 ? reserve(temporary_name(path_), offset, bytes) : std::string()));
  const Hdf5Property transfer = hdf5_collective();
  const bool written =
      H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, slab.begin, nullptr, slab.count, nullptr) >= 0 &&
      H5Dwrite(dataset.get(), hdf5_type<T>(), memory_space.get(), file_space.get(), transfer.get(), values.data()) >= 0;
  PetscCall(check(dataset.close() && written, "cannot write dataset " + name + " (disk full?)"));
  std::uint64_t sum = box_checksum(slab, values);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_UINT64_T, MPI_SUM, comm_));
  PetscCall(write_attribute(name, "checksum", checksum_text(sum)));
  PetscFunctionReturn(0);
}

template <class T>
PetscErrorCode Hdf5File::write_field_as(const Box &box, const FieldFormat &format, hid_t file_type,
                                        const std::vector<ConstView> &components) {
  PetscFunctionBeginUser;
  Int3 extra{};
  for (int d = 0; d < 3; ++d) extra[d] = format.high_wall && format.staggering[d] && box.is_wall(d);
  Hyperslab slab = owned_box(box, extra, components.size());
  if (const int d = format.plane; d >= 0) {
    slab.total[2 - d] = 1;
    slab.begin[2 - d] = 0;
    slab.count[2 - d] = box.touches(d, format.plane_high) ? 1 : 0;
  }
  std::vector<T> values;
  values.reserve(slab.count[0] * slab.count[1] * slab.count[2] * components.size());
  for (int k = 0; k < int(slab.count[0]); ++k)
    for (int j = 0; j < int(slab.count[1]); ++j)
      for (int i = 0; i < int(slab.count[2]); ++i)
        for (const ConstView &component : components) values.push_back(static_cast<T>(component(i, j, k)));
  PetscCall(write_values(format.name, slab, file_type, values));
  PetscCall(write_attribute(format.name, "location",
                            format.plane < 0
                                ? location_name(format.staggering)
                                : std::string("wall_") + "xyz"[format.plane] + (format.plane_high ? "max" : "min")));
  PetscFunctionReturn(0);
}

PetscErrorCode Hdf5File::write_field(const Box &box, const FieldFormat &format,
                                     const std::vector<ConstView> &components) {
  PetscFunctionBeginUser;
  switch (format.stored) {
    case Stored::float32:
      PetscCall(write_field_as<float>(box, format, H5T_IEEE_F32LE, components));
      break;
    case Stored::float64:
      PetscCall(write_field_as<double>(box, format, H5T_IEEE_F64LE, components));
      break;
    case Stored::int32:
      PetscCall(write_field_as<int>(box, format, H5T_STD_I32LE, components));
      break;
  }
  PetscFunctionReturn(0);
}

template <class T>
PetscErrorCode Hdf5File::read_values(const std::string &name, hid_t dataset, const Hyperslab &slab,
                                     std::vector<T> *values) {
  PetscFunctionBeginUser;
  const Hdf5Space file_space(H5Dget_space(dataset)), memory_space(H5Screate_simple(slab.rank, slab.count, nullptr));
  const Hdf5Property transfer = hdf5_collective();
  values->resize(slab.count[0] * slab.count[1] * slab.count[2]);
  const bool read =
      H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, slab.begin, nullptr, slab.count, nullptr) >= 0 &&
      H5Dread(dataset, hdf5_type<T>(), memory_space.get(), file_space.get(), transfer.get(), values->data()) >= 0;
  PetscCall(check(read, "cannot read dataset " + name));
  std::uint64_t sum = box_checksum(slab, *values);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_UINT64_T, MPI_SUM, comm_));
  PetscCall(verify(name, sum));
  PetscFunctionReturn(0);
}

template <class T>
PetscErrorCode Hdf5File::read_field_as(const std::string &name, hid_t dataset, const Hyperslab &slab, View field) {
  std::vector<T> values;
  PetscFunctionBeginUser;
  PetscCall(read_values(name, dataset, slab, &values));
  const T *value = values.data();
  for (int k = 0; k < int(slab.count[0]); ++k)
    for (int j = 0; j < int(slab.count[1]); ++j, value += slab.count[2])
      for (int i = 0; i < int(slab.count[2]); ++i) {  // what is equal is not written: Field::at_rest
        const double found = static_cast<double>(value[i]);
        if (std::memcmp(&found, &field(i, j, k), sizeof found) != 0) field(i, j, k) = found;
      }
  PetscFunctionReturn(0);
}

PetscErrorCode Hdf5File::read_field(const Box &box, const std::string &name, const Staggering &staggering, View field) {
  Hdf5Dataset dataset;
  PetscFunctionBeginUser;
  PetscCall(open_dataset(name, &dataset));
  const std::vector<hsize_t> shape = hdf5_shape(dataset.get());
  Int3 extra{};
  bool fits = shape.size() == 3;
  for (int d = 0; d < 3 && fits; ++d) {
    extra[d] = static_cast<long long>(shape[2 - d]) - box.domain_cells()[d] == 1 && staggering[d] && box.is_wall(d);
    fits = shape[2 - d] == hsize_t(box.domain_cells()[d]) + hsize_t(extra[d]);
  }
  const Int3 &n = box.domain_cells();
  PetscCall(check(fits, "dataset " + name + " is " + shape_text(shape) + ", the grid needs " +
                            shape_text({hsize_t(n[2]), hsize_t(n[1]), hsize_t(n[0])}) + " (nz, ny, nx)"));
  // In the stored type, so that the checksum sees the stored bits.
  const Hdf5Type type(H5Dget_type(dataset.get()));
  const H5T_class_t kind = H5Tget_class(type.get());
  PetscCall(check(kind == H5T_FLOAT || kind == H5T_INTEGER, "dataset " + name + " is not numeric"));
  const Hyperslab slab = owned_box(box, extra, 1);
  if (H5Tget_size(type.get()) != 4)
    PetscCall(read_field_as<double>(name, dataset.get(), slab, field));
  else if (kind == H5T_FLOAT)
    PetscCall(read_field_as<float>(name, dataset.get(), slab, field));
  else
    PetscCall(read_field_as<int>(name, dataset.get(), slab, field));
  PetscFunctionReturn(0);
}

PetscErrorCode Hdf5File::write_records(const std::string &name, std::size_t numbers,
                                       const std::vector<double> &values) {
  unsigned long long mine = values.size() / numbers, end = 0, all = 0;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Scan(&mine, &end, 1, MPI_UNSIGNED_LONG_LONG, MPI_SUM, comm_));
  PetscCallMPI(MPI_Allreduce(&mine, &all, 1, MPI_UNSIGNED_LONG_LONG, MPI_SUM, comm_));
  PetscCall(write_values(name, {3, {all, 1, numbers}, {end - mine, 0, 0}, {mine, 1, numbers}}, H5T_IEEE_F64LE, values));
  PetscFunctionReturn(0);
}

PetscErrorCode Hdf5File::read_records(const std::string &name, std::size_t numbers, std::vector<double> *values) {
  Hdf5Dataset dataset;
  int ranks;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_size(comm_, &ranks));
  PetscCall(open_dataset(name, &dataset));
  const std::vector<hsize_t> shape = hdf5_shape(dataset.get());
  PetscCall(check(shape.size() == 3 && shape[1] == 1 && shape[2] == numbers,
                  "dataset " + name + " is " + shape_text(shape) + ", not records of " + std::to_string(numbers)));
  const hsize_t begin = shape[0] * hsize_t(mpi_rank_) / hsize_t(ranks),
                end = shape[0] * hsize_t(mpi_rank_ + 1) / hsize_t(ranks);
  PetscCall(
      read_values(name, dataset.get(), {3, {shape[0], 1, numbers}, {begin, 0, 0}, {end - begin, 1, numbers}}, values));
  PetscFunctionReturn(0);
}

PetscErrorCode Hdf5File::read_own_records(const std::string &name, std::size_t numbers, std::vector<double> *values) {
  unsigned long long mine = values->size() / numbers, end = 0, all = 0;
  Hdf5Dataset dataset;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Scan(&mine, &end, 1, MPI_UNSIGNED_LONG_LONG, MPI_SUM, comm_));
  PetscCallMPI(MPI_Allreduce(&mine, &all, 1, MPI_UNSIGNED_LONG_LONG, MPI_SUM, comm_));
  PetscCall(open_dataset(name, &dataset));
  PetscCall(check(hdf5_shape(dataset.get()) == std::vector<hsize_t>{all, 1, numbers}, name + " is of another scene"));
  PetscCall(read_values(name, dataset.get(), {3, {all, 1, numbers}, {end - mine, 0, 0}, {mine, 1, numbers}}, values));
  PetscFunctionReturn(0);
}

template <class T>
PetscErrorCode Hdf5File::read_share(const std::string &name, hsize_t total, hsize_t begin, std::vector<T> *values) {
  Hdf5Dataset dataset;
  PetscFunctionBeginUser;
  PetscCall(open_dataset(name, &dataset));
  PetscCall(check(hdf5_shape(dataset.get()) == std::vector<hsize_t>{total}, name + " is of another scene"));
  PetscCall(read_values(name, dataset.get(), {1, {total, 1, 1}, {begin, 0, 0}, {values->size(), 1, 1}}, values));
  PetscFunctionReturn(0);
}

template PetscErrorCode Hdf5File::read_share(const std::string &, hsize_t, hsize_t, std::vector<double> *);
template PetscErrorCode Hdf5File::read_share(const std::string &, hsize_t, hsize_t, std::vector<long> *);

}  // namespace eulastic
