#include "io/bodies_file.hpp"

#include "base/events.hpp"
#include "io/checksum.hpp"
#include "io/fail_together.hpp"
#include "io/hdf5_handle.hpp"
#include "io/text_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>

namespace eulastic {
namespace {

constexpr std::size_t waiting_bytes_max = 64u << 20;

// The directory is locked, and not all file systems can.
Hdf5Property unlocked_access() {
  Hdf5Property access(H5Pcreate(H5P_FILE_ACCESS));
  (void)H5Pset_file_locking(access.get(), false, true);
  return access;
}

bool write_text_attribute(hid_t object, const char *name, const std::string &text) {
  const Hdf5Type type = hdf5_string(text.size());
  const Hdf5Space space(H5Screate(H5S_SCALAR));
  const Hdf5Attribute attribute(H5Aexists(object, name) > 0
                                    ? H5Aopen(object, name, H5P_DEFAULT)
                                    : H5Acreate2(object, name, type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT));
  return H5Awrite(attribute.get(), type.get(), text.c_str()) >= 0;
}

// `id` and `species`: who the bodies are.
bool write_bodies(hid_t file, const std::vector<BodyRecord> &bodies) {
  for (const char *name : {"id", "species"})
    if (H5Lexists(file, name, H5P_DEFAULT) > 0 && H5Ldelete(file, name, H5P_DEFAULT) < 0) return false;
  std::vector<long> ids;
  std::size_t width = 1;
  for (const BodyRecord &body : bodies) {
    ids.push_back(body.id);
    width = std::max(width, body.species.size());
  }
  std::string names;
  for (const BodyRecord &body : bodies) names += body.species + std::string(width - body.species.size(), '\0');
  const hsize_t count = bodies.size();
  const Hdf5Space space(H5Screate_simple(1, &count, nullptr));
  const Hdf5Type text = hdf5_string(width);
  const Hdf5Dataset id(H5Dcreate2(file, "id", H5T_STD_I64LE, space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  const Hdf5Dataset species(
      H5Dcreate2(file, "species", text.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  return H5Dwrite(id.get(), H5T_NATIVE_LONG, H5S_ALL, H5S_ALL, H5P_DEFAULT, ids.data()) >= 0 &&
         H5Dwrite(species.get(), text.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, names.data()) >= 0 &&
         write_text_attribute(id.get(), "checksum", checksum_text(checksum(ids.data(), ids.size(), 0)));
}

// What is said of a body in rows from before it came in.
double before_it_came(const std::string &column) { return column == "volume" ? 0 : std::nan(""); }

// Rows [begin, begin + count) of a dataset of shape (rows), (rows, bodies) or (rows, bodies, width).
bool append_rows(hid_t file, const char *name, hsize_t begin, hsize_t count, hsize_t bodies, hsize_t width,
                 const std::vector<double> &values, const std::string &sum) {
  const int rank = width == 0 ? 1 : width == 1 ? 2 : 3;
  const hsize_t row = std::max<hsize_t>(1, bodies * width);
  const hsize_t start[3] = {begin, 0, 0}, size[3] = {count, bodies, width}, total[3] = {begin + count, bodies, width};
  Hdf5Dataset dataset;
  if (begin == 0) {
    const hsize_t limit[3] = {H5S_UNLIMITED, H5S_UNLIMITED, width};
    const hsize_t chunk[3] = {std::clamp<hsize_t>(8192 / row, 1, 1024), bodies, width};  // 64 kB
    const Hdf5Space space(H5Screate_simple(rank, total, limit));
    const Hdf5Property creation(H5Pcreate(H5P_DATASET_CREATE));
    (void)H5Pset_chunk(creation.get(), rank, chunk);
    const double before = before_it_came(name);
    (void)H5Pset_fill_value(creation.get(), H5T_NATIVE_DOUBLE, &before);
    dataset =
        Hdf5Dataset(H5Dcreate2(file, name, H5T_IEEE_F64LE, space.get(), H5P_DEFAULT, creation.get(), H5P_DEFAULT));
  } else {
    dataset = Hdf5Dataset(H5Dopen2(file, name, H5P_DEFAULT));
    if (H5Dset_extent(dataset.get(), total) < 0) return false;
  }
  const Hdf5Space file_space(H5Dget_space(dataset.get())), memory_space(H5Screate_simple(rank, size, nullptr));
  return H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, start, nullptr, size, nullptr) >= 0 &&
         H5Dwrite(dataset.get(), H5T_NATIVE_DOUBLE, memory_space.get(), file_space.get(), H5P_DEFAULT, values.data()) >=
             0 &&
         write_text_attribute(dataset.get(), "checksum", sum) && dataset.close();
}

// Gives all rows of a dataset another number of bodies.
bool set_bodies(hid_t file, const char *name, hsize_t bodies, std::uint64_t *sum) {
  Hdf5Dataset dataset(H5Dopen2(file, name, H5P_DEFAULT));
  std::vector<hsize_t> shape = hdf5_shape(dataset.get());
  if (shape.size() < 2) return false;
  shape[1] = bodies;
  if (H5Dset_extent(dataset.get(), shape.data()) < 0) return false;
  const Hdf5Space file_space(H5Dget_space(dataset.get()));
  std::vector<hsize_t> start(shape.size(), 0), one = shape;
  one[0] = 1;
  const Hdf5Space memory_space(H5Screate_simple(static_cast<int>(one.size()), one.data(), nullptr));
  std::vector<double> values(bodies * (shape.size() == 3 ? shape[2] : 1));
  *sum = 0;
  for (; start[0] < shape[0]; ++start[0]) {
    if (H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, start.data(), nullptr, one.data(), nullptr) < 0 ||
        H5Dread(dataset.get(), H5T_NATIVE_DOUBLE, memory_space.get(), file_space.get(), H5P_DEFAULT, values.data()) < 0)
      return false;
    *sum += checksum(values.data(), values.size(), start[0] * values.size());
  }
  return dataset.close();
}

// Shortens a dataset to its first `rows` rows; its checksum loses what the others had given.
bool cut_rows(hid_t file, const char *name, hsize_t rows, std::uint64_t *sum) {
  Hdf5Dataset dataset(H5Dopen2(file, name, H5P_DEFAULT));
  std::vector<hsize_t> shape = hdf5_shape(dataset.get());
  char text[17] = "";
  const Hdf5Attribute attribute(H5Aopen(dataset.get(), "checksum", H5P_DEFAULT));
  if (shape.empty() || shape[0] < rows || H5Aread(attribute.get(), hdf5_string(16).get(), text) < 0) return false;
  *sum = std::strtoull(text, nullptr, 16);
  hsize_t row = 1, start[3] = {rows, 0, 0};
  for (std::size_t d = 1; d < shape.size(); ++d) row *= shape[d];
  std::vector<hsize_t> one = shape;
  one[0] = 1;
  std::vector<double> values(row);
  const Hdf5Space file_space(H5Dget_space(dataset.get()));
  const Hdf5Space memory_space(H5Screate_simple(static_cast<int>(one.size()), one.data(), nullptr));
  for (; start[0] < shape[0]; ++start[0]) {
    if (H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, start, nullptr, one.data(), nullptr) < 0 ||
        H5Dread(dataset.get(), H5T_NATIVE_DOUBLE, memory_space.get(), file_space.get(), H5P_DEFAULT, values.data()) < 0)
      return false;
    *sum -= checksum(values.data(), row, start[0] * row);
  }
  shape[0] = rows;
  return H5Dset_extent(dataset.get(), shape.data()) >= 0 &&
         write_text_attribute(dataset.get(), "checksum", checksum_text(*sum)) && dataset.close();
}

// Empty, or what was wrong: then nothing is left of the copy.
std::string copy_file(const std::string &path, const std::string &target) {
  std::error_code error, ignored;
  std::filesystem::copy_file(path, target, std::filesystem::copy_options::overwrite_existing, error);
  if (!error) return {};
  std::filesystem::remove(target, ignored);
  return path + ": cannot be copied (disk full? " + error.message() + ")";
}

}  // namespace

BodiesFile::BodiesFile(MPI_Comm comm, std::string path, bool membranes, bool loads)
    : comm_(comm), path_(std::move(path)), membranes_(membranes), loads_(loads) {
  columns_ = {{"time", 0, {}, 0}, {"centroid", 3, {}, 0}, {"velocity", 3, {}, 0}};
  for (const char *name :
       {"volume", "taylor_deformation", "inclination", "elastic_energy", "largest_stretch", "rest_deformation"})
    columns_.push_back({name, 1, {}, 0});
  for (const char *name : {"surface_area", "shear_energy", "area_energy", "bending_energy", "turning_rate"})
    if (membranes) columns_.push_back({name, 1, {}, 0});
  for (const char *name : {"force", "torque"})
    if (loads) columns_.push_back({name, 3, {}, 0});
  (void)MPI_Comm_rank(comm, &rank_);
}

std::vector<double> BodiesFile::scalars(const BodyRecord &body) const {
  std::vector<double> values{body.volume,         body.taylor_deformation, body.inclination,
                             body.elastic_energy, body.largest_stretch,    body.rest_deformation};
  if (membranes_)
    values.insert(values.end(),
                  {body.surface_area, body.shear_energy, body.area_energy, body.bending_energy, body.turning_rate});
  return values;
}

PetscErrorCode BodiesFile::add(double time, const std::vector<BodyRecord> &bodies) {
  std::string problem;
  PetscFunctionBeginUser;
  if (rank_ == 0 && bodies.size() > known_.size()) get_to_know(bodies);
  if (bodies.size() != known_.size() && rank_ == 0) {
    problem = path_ + ": the number of bodies has become smaller";
  } else if (!known_.empty()) {
    columns_[0].waiting.push_back(time);
    for (const BodyRecord &body : bodies) {
      columns_[1].waiting.insert(columns_[1].waiting.end(), body.centroid.begin(), body.centroid.end());
      columns_[2].waiting.insert(columns_[2].waiting.end(), body.velocity.begin(), body.velocity.end());
      const std::vector<double> values = scalars(body);
      for (std::size_t c = 0; c < values.size(); ++c) columns_[3 + c].waiting.push_back(values[c]);
      for (std::size_t c = 0; loads_ && c < 2; ++c) {
        const Real3 &load = c == 0 ? body.force : body.torque;
        std::vector<double> &waiting = columns_[3 + values.size() + c].waiting;
        waiting.insert(waiting.end(), load.begin(), load.end());
      }
    }
    ++waiting_;
    const std::size_t bytes =
        waiting_ * (1 + (12 + (membranes_ ? 5 : 0) + (loads_ ? 6 : 0)) * bodies.size()) * sizeof(double);
    if (4 * waiting_ >= written_ || bytes >= waiting_bytes_max) problem = write_waiting();
  }
  PetscCall(fail_together(comm_, problem));
  PetscFunctionReturn(0);
}

void BodiesFile::get_to_know(const std::vector<BodyRecord> &bodies) {
  for (Column &column : columns_) {
    if (column.width == 0) continue;
    const std::size_t more = (bodies.size() - known_.size()) * column.width;
    for (std::size_t row = 1; row <= waiting_; ++row)
      column.waiting.insert(
          column.waiting.begin() + static_cast<std::ptrdiff_t>(row * bodies.size() * column.width - more), more,
          before_it_came(column.name));
  }
  known_ = bodies;
}

std::string BodiesFile::cut(std::size_t rows) {
  std::error_code error;
  if (rows == 0) {
    std::filesystem::remove(path_, error);
    return error ? path_ + ": cannot be removed (" + error.message() + ")" : "";
  }
  (void)H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const std::string target = temporary_name(path_);
  if (std::string problem = copy_file(path_, target); !problem.empty()) return problem;
  Hdf5FileHandle file(H5Fopen(target.c_str(), H5F_ACC_RDWR, unlocked_access().get()));
  bool fine = bool(file);
  for (Column &column : columns_) fine = fine && cut_rows(file.get(), column.name, rows, &column.checksum);
  if (!file.close() || !fine) {
    std::filesystem::remove(target, error);
    return path_ +
           ": damaged, or has fewer rows than the checkpoint says; moving it away lets the restart begin a new one";
  }
  written_ = rows;
  stored_ = unknown;
  return replace_file(path_);
}

PetscErrorCode BodiesFile::resume(long *rows) {
  PetscFunctionBeginUser;
  std::error_code ignored;
  if (rank_ == 0 && !std::filesystem::exists(path_, ignored)) *rows = 0;
  PetscCallMPI(MPI_Bcast(rows, 1, MPI_LONG, 0, comm_));
  PetscCall(fail_together(comm_, rank_ == 0 ? cut(static_cast<std::size_t>(*rows)) : std::string()));
  PetscFunctionReturn(0);
}

PetscErrorCode BodiesFile::flush() {
  PetscFunctionBeginUser;
  PetscCall(fail_together(comm_, rank_ == 0 && waiting_ > 0 ? write_waiting() : std::string()));
  PetscFunctionReturn(0);
}

std::string BodiesFile::write_waiting() {
  VerbScope scope(Verb::write);
  (void)H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const std::string target = temporary_name(path_);
  std::error_code error;
  if (std::string problem = written_ > 0 ? copy_file(path_, target) : ""; !problem.empty()) return problem;
  const Hdf5Property access = unlocked_access();
  Hdf5FileHandle file(written_ == 0 ? H5Fcreate(target.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get())
                                    : H5Fopen(target.c_str(), H5F_ACC_RDWR, access.get()));
  if (!file) return path_ + ": cannot be opened (" + std::strerror(errno) + ")";
  bool fine = stored_ == known_.size() || write_bodies(file.get(), known_);
  for (Column &column : columns_) {
    if (written_ > 0 && stored_ != known_.size() && column.width > 0)
      fine = fine && set_bodies(file.get(), column.name, known_.size(), &column.checksum);
    const std::size_t row = column.width == 0 ? 1 : column.width * known_.size();
    column.checksum += checksum(column.waiting.data(), column.waiting.size(), written_ * row);
    fine = fine && append_rows(file.get(), column.name, written_, waiting_, known_.size(), column.width, column.waiting,
                               checksum_text(column.checksum));
    column.waiting.clear();
  }
  if (!file.close() || !fine) {
    std::filesystem::remove(target, error);
    return path_ + ": cannot be written (disk full?)";
  }
  stored_ = known_.size();
  written_ += std::exchange(waiting_, 0);
  return replace_file(path_);
}

}  // namespace eulastic
