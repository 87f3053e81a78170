#include "io/hdf5_file.hpp"

#include "base/rank_zero.hpp"
#include "io/checksum.hpp"
#include "io/fail_together.hpp"
#include "io/text_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cerrno>
#include <cstring>

namespace eulastic {
namespace {

Hdf5Property parallel_access(MPI_Comm comm) {
  (void)H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // the user sees our line
  Hdf5Property access(H5Pcreate(H5P_FILE_ACCESS));
  (void)H5Pset_fapl_mpio(access.get(), comm, MPI_INFO_NULL);
  (void)H5Pset_libver_bounds(access.get(), H5F_LIBVER_V18, H5F_LIBVER_LATEST);  // its metadata have checksums
  (void)H5Pset_all_coll_metadata_ops(access.get(), true);
  (void)H5Pset_coll_metadata_write(access.get(), true);
  return access;
}

// MPI-IO does not say why it cannot open a file; the system does. Every rank tries: one that alone does not see the
// directory would wait inside MPI-IO, and the others elsewhere.
std::string try_to_open(const std::string &path, int flags) {
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode))
    return path + " is not a file; accepted: an HDF5 file";
  const int file = ::open(path.c_str(), flags | O_CLOEXEC, 0666);
  if (file < 0) return "cannot open " + path + ": " + std::strerror(errno);
  (void)::close(file);
  return {};
}

// Whether some ranks can write behind the end of `path` and others cannot.
bool ranks_differ(MPI_Comm comm, const std::string &path) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  const off_t behind = file < 0 ? 0 : ::lseek(file, 0, SEEK_END) + (1 << 20);
  int ends[2];  // least of "can" and of "cannot"
  ends[0] = file >= 0 && ::pwrite(file, "", 1, behind) == 1;
  ends[1] = 1 - ends[0];
  if (file >= 0) (void)::close(file);
  (void)MPI_Allreduce(MPI_IN_PLACE, ends, 2, MPI_INT, MPI_MIN, comm);
  return ends[0] == 0 && ends[1] == 0;
}

}  // namespace

PetscErrorCode Hdf5File::check(bool fine, const std::string &problem) const {
  return fail_together(comm_, fine ? std::string() : path_ + ": " + problem);
}

PetscErrorCode Hdf5File::create(MPI_Comm comm, const std::string &path) {
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &mpi_rank_));
  comm_ = comm;
  path_ = path;
  const std::string target = temporary_name(path);
  PetscCall(fail_together(comm, mpi_rank_ == 0 ? try_to_open(target, O_WRONLY | O_CREAT | O_TRUNC) : std::string()));
  writing_ = true;
  PetscCall(fail_together(comm, try_to_open(target, O_WRONLY)));
  const Hdf5Property access = parallel_access(comm);
  const Deadline deadline(mpi_rank_, path);
  file_ = Hdf5FileHandle(H5Fcreate(target.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get()));
  PetscCall(check(bool(file_), "HDF5 cannot create this file"));
  PetscFunctionReturn(0);
}

PetscErrorCode Hdf5File::open(MPI_Comm comm, const std::string &path) {
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &mpi_rank_));
  comm_ = comm;
  path_ = path;
  PetscCall(fail_together(comm, try_to_open(path, O_RDONLY)));
  const Hdf5Property access = parallel_access(comm);
  const Deadline deadline(mpi_rank_, path);
  file_ = Hdf5FileHandle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.get()));
  PetscCall(check(bool(file_), "is not an HDF5 file, or is damaged or truncated"));
  PetscFunctionReturn(0);
}

PetscErrorCode Hdf5File::commit() {
  PetscFunctionBeginUser;
  // The flush syncs every rank's part, which rank 0 could not do for other nodes.
  PetscCall(check(H5Fflush(file_.get(), H5F_SCOPE_GLOBAL) >= 0, "cannot be written to the end (disk full?)"));
  PetscCall(check(file_.close(), "cannot be closed (disk full?)"));
  PetscCall(fail_together(comm_, mpi_rank_ == 0 ? replace_file(path_) : std::string()));
  writing_ = false;
  PetscFunctionReturn(0);
}

// A rank that alone cannot write would leave the others waiting in H5Fclose: then the file stays open.
// HDF5 1.10 crashes in MPI_Finalize if a file cannot be closed. So an unfinished one first gives its space back: then
// there is room for what a full disk had no room for.
Hdf5File::~Hdf5File() {
  if (writing_ && file_) {
    if (ranks_differ(comm_, temporary_name(path_))) {
      file_.forget();
    }
    if (mpi_rank_ == 0) (void)!::truncate(temporary_name(path_).c_str(), 0);
    (void)MPI_Barrier(comm_);
  }
  (void)file_.close();
  if (writing_ && mpi_rank_ == 0) (void)::unlink(temporary_name(path_).c_str());
}

bool Hdf5File::has(const std::string &dataset) const {
  return H5Lexists(file_.get(), dataset.c_str(), H5P_DEFAULT) > 0;
}

std::vector<std::string> Hdf5File::datasets() const {
  std::vector<std::string> names;
  const auto add = [](hid_t, const char *name, const H5L_info_t *, void *list) -> herr_t {
    static_cast<std::vector<std::string> *>(list)->emplace_back(name);
    return 0;
  };
  // In the order of the file: for any other one HDF5 makes a table of the links, which it cannot free where one is
  // damaged.
  (void)H5Literate(file_.get(), H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, add, &names);
  std::sort(names.begin(), names.end());
  return names;
}

bool Hdf5File::has_attribute(const std::string &object, const std::string &name) const {
  return H5Aexists_by_name(file_.get(), object.c_str(), name.c_str(), H5P_DEFAULT) > 0;
}

PetscErrorCode Hdf5File::open_dataset(const std::string &name, Hdf5Dataset *dataset) const {
  PetscFunctionBeginUser;
  PetscCall(check(has(name), "there is no dataset " + name));
  *dataset = Hdf5Dataset(H5Dopen2(file_.get(), name.c_str(), H5P_DEFAULT));
  PetscCall(check(bool(*dataset), name + " is not a dataset"));
  PetscFunctionReturn(0);
}

// Attributes.

PetscErrorCode Hdf5File::write_raw_attribute(const std::string &object, const std::string &name, hid_t type,
                                             hsize_t count, const void *values) {
  PetscFunctionBeginUser;
  const Hdf5Space space(count > 1 ? H5Screate_simple(1, &count, nullptr) : H5Screate(H5S_SCALAR));
  Hdf5Attribute attribute(H5Acreate_by_name(file_.get(), object.c_str(), name.c_str(), type, space.get(), H5P_DEFAULT,
                                            H5P_DEFAULT, H5P_DEFAULT));
  const bool written = attribute && H5Awrite(attribute.get(), type, values) >= 0;
  PetscCall(check(attribute.close() && written, "cannot write attribute " + name + " of " + object));
  PetscFunctionReturn(0);
}

PetscErrorCode Hdf5File::open_attribute(const std::string &object, const std::string &name, Hdf5Attribute *attribute) {
  PetscFunctionBeginUser;
  *attribute = Hdf5Attribute(H5Aopen_by_name(file_.get(), object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT));
  PetscCall(check(bool(*attribute), "there is no attribute " + name + " of " + object));
  PetscFunctionReturn(0);
}

PetscErrorCode Hdf5File::read_attribute(const std::string &object, const std::string &name, std::string *value) {
  Hdf5Attribute attribute;
  PetscFunctionBeginUser;
  PetscCall(open_attribute(object, name, &attribute));
  const Hdf5Type type(H5Aget_type(attribute.get()));
  const Hdf5Space space(H5Aget_space(attribute.get()));
  const bool fixed = H5Tget_class(type.get()) == H5T_STRING && H5Tis_variable_str(type.get()) == 0 &&
                     H5Sget_simple_extent_npoints(space.get()) == 1;
  value->assign(fixed ? H5Tget_size(type.get()) : 0, '\0');
  PetscCall(check(fixed && H5Aread(attribute.get(), type.get(), value->data()) >= 0,
                  "cannot read attribute " + name + " of " + object + " as one string of fixed length"));
  value->resize(std::char_traits<char>::length(value->c_str()));
  PetscFunctionReturn(0);
}

PetscErrorCode Hdf5File::read_attribute(const std::string &object, const std::string &name, double *values, int count) {
  Hdf5Attribute attribute;
  PetscFunctionBeginUser;
  PetscCall(open_attribute(object, name, &attribute));
  const Hdf5Space space(H5Aget_space(attribute.get()));
  PetscCall(check(
      H5Sget_simple_extent_npoints(space.get()) == count && H5Aread(attribute.get(), H5T_NATIVE_DOUBLE, values) >= 0,
      "attribute " + name + " of " + object + " is not " + std::to_string(count) + " numbers"));
  PetscFunctionReturn(0);
}

// Fields, records and arrays.

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
  Hyperslab slab{{components > 1 ? 4 : 3, {0, 0, 0, 0}, {0, 0, 0, components}}, {0, 0, 0, components}};
  for (int d = 0; d < 3; ++d) {
    slab.total[2 - d] = box.domain_cells()[d] + extra[d];
    slab.begin[2 - d] = box.layout().begin[d];
    slab.count[2 - d] = box.cells()[d] + (box.touches_high(d) ? extra[d] : 0);
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
PetscErrorCode Hdf5File::write_values(const std::string &name, const Hyperslab &slab, const std::vector<T> &values) {
  PetscFunctionBeginUser;
  const Hdf5Space file_space(H5Screate_simple(slab.rank, slab.total, nullptr));
  const Hdf5Property creation(H5Pcreate(H5P_DATASET_CREATE));
  (void)H5Pset_fill_time(creation.get(), H5D_FILL_TIME_NEVER);  // every point is written
  Hdf5Dataset dataset(H5Dcreate2(file_.get(), name.c_str(), hdf5_type<T>(), file_space.get(), H5P_DEFAULT,
                                 creation.get(), H5P_DEFAULT));
  PetscCall(check(bool(dataset), "cannot create dataset " + name));
  const haddr_t offset = H5Dget_offset(dataset.get());
  const hsize_t bytes = H5Dget_storage_size(dataset.get());
  PetscCall(fail_together(comm_, mpi_rank_ == 0 ? reserve(temporary_name(path_), offset, bytes) : std::string()));
  const bool written = write_block(dataset.get(), slab, hdf5_type<T>(), values.data(), hdf5_collective().get());
  PetscCall(check(dataset.close() && written, "cannot write dataset " + name + " (disk full?)"));
  std::uint64_t sum = box_checksum(slab, values);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_UINT64_T, MPI_SUM, comm_));
  PetscCall(write_attribute(name, "checksum", checksum_text(sum)));
  PetscFunctionReturn(0);
}

template <class T>
PetscErrorCode Hdf5File::write_field_as(const Box &box, const FieldFormat &format,
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
  PetscCall(write_values(format.name, slab, values));
  PetscCall(write_attribute(
      format.name, "location",
      format.plane < 0 ? location_name(format.staggering) : "wall_" + side_name(format.plane, format.plane_high)));
  PetscFunctionReturn(0);
}

PetscErrorCode Hdf5File::write_field(const Box &box, const FieldFormat &format,
                                     const std::vector<ConstView> &components) {
  PetscFunctionBeginUser;
  if (format.stored == Stored::float32)
    PetscCall(write_field_as<float>(box, format, components));
  else if (format.stored == Stored::float64)
    PetscCall(write_field_as<double>(box, format, components));
  else
    PetscCall(write_field_as<int>(box, format, components));
  PetscFunctionReturn(0);
}

template <class T>
PetscErrorCode Hdf5File::read_values(const std::string &name, hid_t dataset, const Hyperslab &slab,
                                     std::vector<T> *values) {
  PetscFunctionBeginUser;
  values->resize(slab.count[0] * slab.count[1] * slab.count[2]);
  const bool read = read_block(dataset, slab, hdf5_type<T>(), values->data(), hdf5_collective().get());
  PetscCall(check(read, "cannot read dataset " + name));
  std::uint64_t sum = box_checksum(slab, *values);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_UINT64_T, MPI_SUM, comm_));
  if (!has_attribute(name, "checksum")) PetscFunctionReturn(0);
  std::string stored;
  PetscCall(read_attribute(name, "checksum", &stored));
  PetscCall(
      check(stored == checksum_text(sum), "dataset " + name + " is damaged: its values do not have its checksum"));
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
      for (int i = 0; i < int(slab.count[2]); ++i) {  // what is equal is not written: Field::on_demand
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
  PetscCall(check(kind == H5T_FLOAT || kind == H5T_INTEGER,
                  "dataset " + name + " has no numbers; accepted: integers or floating-point numbers"));
  const Hyperslab slab = owned_box(box, extra, 1);
  if (H5Tget_size(type.get()) != 4)
    PetscCall(read_field_as<double>(name, dataset.get(), slab, field));
  else if (kind == H5T_FLOAT)
    PetscCall(read_field_as<float>(name, dataset.get(), slab, field));
  else
    PetscCall(read_field_as<int>(name, dataset.get(), slab, field));
  PetscFunctionReturn(0);
}

// The position of this rank's `mine` rows among those of all ranks, in the order of the ranks.
PetscErrorCode Hdf5File::own_rows(hsize_t mine, hsize_t *begin, hsize_t *all) const {
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Scan(&mine, begin, 1, MPI_UINT64_T, MPI_SUM, comm_));
  PetscCallMPI(MPI_Allreduce(&mine, all, 1, MPI_UINT64_T, MPI_SUM, comm_));
  *begin -= mine;
  PetscFunctionReturn(0);
}

PetscErrorCode Hdf5File::write_records(const std::string &name, std::size_t numbers,
                                       const std::vector<double> &values) {
  const hsize_t mine = values.size() / numbers;
  hsize_t begin, all;
  PetscFunctionBeginUser;
  PetscCall(own_rows(mine, &begin, &all));
  if (all > 0) PetscCall(write_values(name, {{3, {begin, 0, 0}, {mine, 1, numbers}}, {all, 1, numbers}}, values));
  PetscFunctionReturn(0);
}

PetscErrorCode Hdf5File::read_records(const std::string &name, std::size_t numbers, std::vector<double> *values) {
  Hdf5Dataset dataset;
  int ranks;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_size(comm_, &ranks));
  PetscCall(open_dataset(name, &dataset));
  const std::vector<hsize_t> shape = hdf5_shape(dataset.get());
  PetscCall(
      check(shape.size() == 3 && shape[1] == 1 && shape[2] == numbers,
            "dataset " + name + " is " + shape_text(shape) + "; accepted: records x 1 x " + std::to_string(numbers)));
  const hsize_t begin = shape[0] * hsize_t(mpi_rank_) / hsize_t(ranks),
                end = shape[0] * hsize_t(mpi_rank_ + 1) / hsize_t(ranks);
  PetscCall(read_values(name, dataset.get(), {{3, {begin, 0, 0}, {end - begin, 1, numbers}}, {shape[0], 1, numbers}},
                        values));
  PetscFunctionReturn(0);
}

template <class T>
PetscErrorCode Hdf5File::read_own(const std::string &name, std::vector<T> *values) {
  const hsize_t mine = values->size();
  hsize_t begin, all;
  Hdf5Dataset dataset;
  PetscFunctionBeginUser;
  PetscCall(own_rows(mine, &begin, &all));
  PetscCall(open_dataset(name, &dataset));
  const std::vector<hsize_t> shape = hdf5_shape(dataset.get()), array{all}, records{all, 1, 1};
  PetscCall(check(shape == array || shape == records, "dataset " + name + " belongs to another case: it is " +
                                                          shape_text(shape) + ", this case needs " +
                                                          std::to_string(all)));
  const int rank = static_cast<int>(shape.size());
  PetscCall(read_values(name, dataset.get(), {{rank, {begin, 0, 0}, {mine, 1, 1}}, {all, 1, 1}}, values));
  PetscFunctionReturn(0);
}

template <class T>
PetscErrorCode Hdf5File::write_array(const std::string &name, const std::vector<T> &values) {
  hsize_t all = values.size();
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Bcast(&all, 1, MPI_UINT64_T, 0, comm_));
  const hsize_t mine = mpi_rank_ == 0 ? all : 0;
  PetscCall(write_values(name, {{1, {0, 0, 0}, {mine, 1, 1}}, {all, 1, 1}}, values));
  PetscFunctionReturn(0);
}

template <class T>
PetscErrorCode Hdf5File::read_array(const std::string &name, std::vector<T> *values) {
  Hdf5Dataset dataset;
  hsize_t file_bytes = 0;
  PetscFunctionBeginUser;
  PetscCall(open_dataset(name, &dataset));
  const std::vector<hsize_t> shape = hdf5_shape(dataset.get());
  PetscCall(check(shape.size() == 1, "dataset " + name + " is " + shape_text(shape) + "; accepted: a list"));
  PetscCall(check(H5Fget_filesize(file_.get(), &file_bytes) >= 0 && shape[0] <= file_bytes,
                  "dataset " + name + " is damaged: it would be larger than its file"));
  const hsize_t mine = mpi_rank_ == 0 ? shape[0] : 0;
  PetscCall(read_values(name, dataset.get(), {{1, {0, 0, 0}, {mine, 1, 1}}, {shape[0], 1, 1}}, values));
  values->resize(shape[0]);
  PetscCallMPI(broadcast_bytes(values->data(), values->size() * sizeof(T), comm_));
  PetscFunctionReturn(0);
}

template PetscErrorCode Hdf5File::read_own(const std::string &, std::vector<double> *);
template PetscErrorCode Hdf5File::read_own(const std::string &, std::vector<long> *);
template PetscErrorCode Hdf5File::write_array(const std::string &, const std::vector<double> &);
template PetscErrorCode Hdf5File::write_array(const std::string &, const std::vector<long> &);
template PetscErrorCode Hdf5File::write_array(const std::string &, const std::vector<unsigned char> &);
template PetscErrorCode Hdf5File::read_array(const std::string &, std::vector<double> *);
template PetscErrorCode Hdf5File::read_array(const std::string &, std::vector<long> *);
template PetscErrorCode Hdf5File::read_array(const std::string &, std::vector<unsigned char> *);

}  // namespace eulastic
