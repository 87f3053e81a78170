#include "io/bodies_file.hpp"

#include "base/body_range.hpp"
#include "base/events.hpp"
#include "io/checksum.hpp"
#include "io/fail_together.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

namespace eulastic {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t waiting_bytes_max = 64u << 20;

// `id` and `species`: who the bodies are.
bool write_bodies(hid_t file, const BodySpecies &bodies) {
  for (const char *name : {"id", "species"})
    if (H5Lexists(file, name, H5P_DEFAULT) > 0 && H5Ldelete(file, name, H5P_DEFAULT) < 0) return false;
  std::vector<long> ids;
  std::size_t width = 1;
  for (int label = 1; label <= bodies.bodies; ++label) {
    ids.push_back(label);
    width = std::max(width, bodies.name(label).size());
  }
  std::string names;
  for (int label = 1; label <= bodies.bodies; ++label) {
    names += bodies.name(label);
    names.resize(label * width);
  }
  const hsize_t count = ids.size();
  const Hdf5Space space(H5Screate_simple(1, &count, nullptr));
  const Hdf5Type text = hdf5_string(width);
  const Hdf5Dataset id(H5Dcreate2(file, "id", H5T_STD_I64LE, space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  const Hdf5Dataset species(
      H5Dcreate2(file, "species", text.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  return H5Dwrite(id.get(), H5T_NATIVE_LONG, H5S_ALL, H5S_ALL, H5P_DEFAULT, ids.data()) >= 0 &&
         H5Dwrite(species.get(), text.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, names.data()) >= 0 &&
         write_text_attribute(id.get(), "checksum", checksum_text(checksum(ids.data(), ids.size(), 0)));
}

// Opens a new file beside the old one, a copy of it on request. Returns an error text, or nothing.
std::string open_new(const std::string &path, bool copies, Hdf5FileHandle *file) {
  const std::string target = temporary_name(path);
  std::error_code error;
  if (copies) fs::copy_file(path, target, fs::copy_options::overwrite_existing, error);
  if (error) return path + ": cannot be copied (disk full? " + error.message() + ")";
  const Hdf5Property access = hdf5_local_access();
  *file = Hdf5FileHandle(copies ? H5Fopen(target.c_str(), H5F_ACC_RDWR, access.get())
                                : H5Fcreate(target.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get()));
  if (*file) return {};
  return copies ? path + ": is damaged, HDF5 cannot open it"
                : path + ": cannot be created (" + std::strerror(errno) + ")";
}

// Closes the new file. It replaces the old one if `wrong` is empty, otherwise it is removed. Returns the first error.
std::string close_new(const std::string &path, std::string wrong, Hdf5FileHandle *file) {
  std::error_code ignored;  // an unfinished file gives its space back, as HDF5 needs some to close it
  if (!wrong.empty()) fs::resize_file(temporary_name(path), 0, ignored);
  if (!file->close() && wrong.empty()) wrong = path + ": cannot be closed (disk full?)";
  return replace_file(path, wrong);
}

}  // namespace

BodiesFile::BodiesFile(MPI_Comm comm, std::string path, const std::vector<BodyColumn> &columns)
    : comm_(comm), path_(std::move(path)) {
  for (const BodyColumn &column : columns) {
    columns_.emplace_back(column.name, column.width > 1 ? 3 : 2, column.width);
    width_ += column.width;
  }
  (void)MPI_Comm_rank(comm, &rank_);
  (void)MPI_Comm_size(comm, &ranks_);
}

PetscErrorCode BodiesFile::add(double time, const BodySpecies &all, const std::vector<double> &owned) {
  PetscFunctionBeginUser;
  const bool fewer = all.bodies < known_.bodies;
  std::string problem = fewer ? path_ + ": the number of bodies must not become smaller" : std::string();
  if (problem.empty() && rank_ == 0 && written_ > 0) problem = stamp_.difference(path_);
  PetscCall(fail_together(comm_, problem));
  if (all.bodies > known_.bodies) {
    PetscCall(flush());  // ranks will own others
    known_ = all;
  }
  if (known_.bodies == 0) PetscFunctionReturn(0);
  times_.push_back(time);
  waiting_.insert(waiting_.end(), owned.begin(), owned.end());
  const std::size_t bytes = times_.size() * (1 + width_ * known_.bodies) * sizeof(double);
  if (4 * times_.size() >= written_ || bytes >= waiting_bytes_max) PetscCall(flush());
  PetscFunctionReturn(0);
}

std::string BodiesFile::cut(std::size_t rows) {
  std::error_code error;
  if (rows == 0) {
    fs::remove(path_, error);
    return error ? path_ + ": cannot be removed (" + error.message() + ")" : "";
  }
  Hdf5FileHandle file;
  std::string problem = open_new(path_, true, &file);
  bool fine = problem.empty() && time_.cut(file.get(), rows);
  for (GrowingDataset &column : columns_) fine = fine && column.cut(file.get(), rows);
  if (problem.empty() && !fine) problem = path_ + ": is damaged, or has fewer rows than the checkpoint says";
  problem = close_new(path_, problem, &file);
  stamp_.take(path_);
  return problem.empty() ? problem : problem + "; if you move the file away, the restart begins a new one";
}

PetscErrorCode BodiesFile::resume(long *rows) {
  PetscFunctionBeginUser;
  std::error_code ignored;
  if (rank_ == 0 && !fs::exists(path_, ignored)) *rows = 0;
  PetscCallMPI(MPI_Bcast(rows, 1, MPI_LONG, 0, comm_));
  PetscCall(fail_together(comm_, rank_ == 0 ? cut(static_cast<std::size_t>(*rows)) : std::string()));
  written_ = static_cast<std::size_t>(*rows);
  PetscFunctionReturn(0);
}

// Buffered rows of bodies [begin, end), in their order on rank 0: (bodies, rows, width).
PetscErrorCode BodiesFile::collect(int begin, int end, std::vector<double> *values) const {
  PetscFunctionBeginUser;
  const std::size_t rows = times_.size();
  const auto share = [&](int rank) { return BodyRange::of(known_.bodies, rank, ranks_).within(begin, end); };
  const BodyRange own = BodyRange::of(known_.bodies, rank_, ranks_), mine = share(rank_);
  std::vector<double> sent;
  for (int b = mine.begin - own.begin; b < mine.end - own.begin; ++b)
    for (std::size_t row = 0; row < rows; ++row) {
      const double *first = waiting_.data() + (row * own.size() + b) * width_;
      sent.insert(sent.end(), first, first + width_);
    }
  std::vector<int> counts(ranks_), begins(ranks_ + 1, 0);
  for (int r = 0; r < ranks_; ++r) {
    counts[r] = share(r).size();
    begins[r + 1] = begins[r] + counts[r];
  }
  if (rank_ == 0) values->resize(begins[ranks_] * rows * width_);
  MpiType body;
  PetscCall(body.create(rows * width_, MPI_DOUBLE));
  PetscCallMPI(MPI_Gatherv(sent.data(), mine.size(), body.get(), values->data(), counts.data(), begins.data(),
                           body.get(), 0, comm_));
  PetscFunctionReturn(0);
}

// Writes the values of bodies [begin, end) that collect() has found.
bool BodiesFile::write_columns(hid_t file, int begin, int end, const std::vector<double> &values) {
  const std::size_t rows = times_.size(), bodies = static_cast<std::size_t>(end - begin);
  std::size_t first = 0;  // of the column
  for (GrowingDataset &column : columns_) {
    std::vector<double> part;
    for (std::size_t row = 0; row < rows; ++row)
      for (std::size_t b = 0; b < bodies; ++b) {
        const double *from = values.data() + (b * rows + row) * width_ + first;
        part.insert(part.end(), from, from + column.width());
      }
    if (!column.write(file, written_, begin, bodies, part)) return false;
    first += column.width();
  }
  return true;
}

PetscErrorCode BodiesFile::flush() {
  PetscFunctionBeginUser;
  if (times_.empty()) PetscFunctionReturn(0);
  EventScope scope(Event::write);
  const hsize_t rows = times_.size(), bodies = known_.bodies;
  std::string problem;
  Hdf5FileHandle file;
  bool fine = true;
  if (rank_ == 0) {
    problem = open_new(path_, written_ > 0, &file);
    fine = problem.empty() && (stored_ == bodies || write_bodies(file.get(), known_));
    for (GrowingDataset &column : columns_) fine = fine && column.resize(file.get(), written_ + rows, bodies);
  }
  std::vector<double> values;
  for (int begin = 0; begin < static_cast<int>(bodies); begin += BodyRange::piece) {
    const int end = std::min(begin + BodyRange::piece, static_cast<int>(bodies));
    PetscCall(collect(begin, end, &values));
    if (rank_ == 0) fine = fine && write_columns(file.get(), begin, end, values);
  }
  if (rank_ == 0) {
    fine = fine && time_.resize(file.get(), written_ + rows, 1) && time_.write(file.get(), written_, 0, 1, times_) &&
           time_.write_checksum(file.get());
    for (const GrowingDataset &column : columns_) fine = fine && column.write_checksum(file.get());
    if (problem.empty() && !fine) problem = path_ + ": cannot be written (disk full?)";
    problem = close_new(path_, problem, &file);
    stamp_.take(path_);
  }
  PetscCall(fail_together(comm_, problem));
  stored_ = bodies;
  written_ += rows;
  times_.clear();
  waiting_.clear();
  PetscFunctionReturn(0);
}

}  // namespace eulastic
