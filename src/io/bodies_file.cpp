#include "io/bodies_file.hpp"

#include "base/body_range.hpp"
#include "base/events.hpp"
#include "io/checksum.hpp"
#include "io/fail_together.hpp"
#include "io/growing_datasets.hpp"

#include <algorithm>
#include <cerrno>
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

// Returns an error text, or nothing; after an error the copy is removed.
std::string copy_file(const std::string &path, const std::string &target) {
  std::error_code error, ignored;
  std::filesystem::copy_file(path, target, std::filesystem::copy_options::overwrite_existing, error);
  if (!error) return {};
  std::filesystem::remove(target, ignored);
  return path + ": cannot be copied (disk full? " + error.message() + ")";
}

}  // namespace

BodiesFile::BodiesFile(MPI_Comm comm, std::string path, const std::vector<BodyColumn> &columns)
    : comm_(comm), path_(std::move(path)) {
  for (const BodyColumn &column : columns) {
    columns_.push_back({column.name, column.width, 0});
    width_ += column.width;
  }
  (void)MPI_Comm_rank(comm, &rank_);
  (void)MPI_Comm_size(comm, &ranks_);
}

PetscErrorCode BodiesFile::add(double time, const BodySpecies &all, const std::vector<double> &owned) {
  PetscFunctionBeginUser;
  const bool fewer = all.bodies < known_.bodies;
  std::string problem = fewer ? path_ + ": the number of bodies has become smaller" : std::string();
  if (problem.empty() && rank_ == 0 && written_ > 0) problem = stamp_.difference(path_);
  PetscCall(fail_together(comm_, problem));
  if (all.bodies > known_.bodies) {
    PetscCall(write_waiting());  // ranks will own others
    known_ = all;
  }
  if (known_.bodies == 0) PetscFunctionReturn(0);
  times_.push_back(time);
  waiting_.insert(waiting_.end(), owned.begin(), owned.end());
  const std::size_t bytes = times_.size() * (1 + width_ * known_.bodies) * sizeof(double);
  if (4 * times_.size() >= written_ || bytes >= waiting_bytes_max) PetscCall(write_waiting());
  PetscFunctionReturn(0);
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
  fine = fine && cut_rows(file.get(), "time", rows, &time_checksum_);
  for (Column &column : columns_) fine = fine && cut_rows(file.get(), column.name, rows, &column.checksum);
  if (!file.close() || !fine) {
    std::filesystem::remove(target, error);
    return path_ +
           ": damaged, or has fewer rows than the checkpoint says; moving it away lets the restart begin a new one";
  }
  stored_ = unknown;
  std::string problem = replace_file(path_);
  stamp_.take(path_);
  return problem;
}

PetscErrorCode BodiesFile::resume(long *rows) {
  PetscFunctionBeginUser;
  std::error_code ignored;
  if (rank_ == 0 && !std::filesystem::exists(path_, ignored)) *rows = 0;
  PetscCallMPI(MPI_Bcast(rows, 1, MPI_LONG, 0, comm_));
  PetscCall(fail_together(comm_, rank_ == 0 ? cut(static_cast<std::size_t>(*rows)) : std::string()));
  written_ = static_cast<std::size_t>(*rows);
  PetscFunctionReturn(0);
}

PetscErrorCode BodiesFile::flush() { return write_waiting(); }

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

// Of bodies [begin, end), as collected.
bool BodiesFile::write_block(hid_t file, int begin, int end, const std::vector<double> &values) {
  const std::size_t rows = times_.size(), bodies = static_cast<std::size_t>(end - begin), all = known_.bodies;
  std::size_t first = 0;  // of the column
  for (Column &column : columns_) {
    const auto width = static_cast<std::size_t>(column.width);
    std::vector<double> part(rows * bodies * width);
    for (std::size_t row = 0; row < rows; ++row) {
      double *const to = part.data() + row * bodies * width;
      for (std::size_t b = 0; b < bodies; ++b)
        std::copy_n(values.data() + (b * rows + row) * width_ + first, width, to + b * width);
      column.checksum += checksum(to, bodies * width, ((written_ + row) * all + begin) * width);
    }
    if (!write_part(file, column.name, {written_, rows, static_cast<hsize_t>(begin), bodies, width}, part))
      return false;
    first += width;
  }
  return true;
}

PetscErrorCode BodiesFile::write_waiting() {
  PetscFunctionBeginUser;
  if (times_.empty()) PetscFunctionReturn(0);
  EventScope scope(Event::write);
  const hsize_t rows = times_.size(), bodies = known_.bodies;
  const std::string target = temporary_name(path_);
  std::error_code error;
  std::string problem;
  Hdf5FileHandle file;
  bool fine = true;
  if (rank_ == 0) {
    (void)H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    problem = written_ > 0 ? copy_file(path_, target) : "";
    const Hdf5Property access = unlocked_access();
    if (problem.empty())
      file = Hdf5FileHandle(written_ == 0 ? H5Fcreate(target.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get())
                                          : H5Fopen(target.c_str(), H5F_ACC_RDWR, access.get()));
    if (problem.empty() && !file) problem = path_ + ": cannot be opened (" + std::strerror(errno) + ")";
    fine = problem.empty() && (stored_ == bodies || write_bodies(file.get(), known_));
    for (Column &column : columns_) {
      if (written_ > 0 && stored_ != bodies)
        fine = fine && set_bodies(file.get(), column.name, bodies, &column.checksum);
      fine = fine && set_rows(file.get(), column.name, {written_, rows, 0, bodies, static_cast<hsize_t>(column.width)});
    }
  }
  std::vector<double> values;
  for (int begin = 0; begin < static_cast<int>(bodies); begin += BodyRange::piece) {
    const int end = std::min(begin + BodyRange::piece, static_cast<int>(bodies));
    PetscCall(collect(begin, end, &values));
    if (rank_ == 0) fine = fine && write_block(file.get(), begin, end, values);
  }
  if (rank_ == 0 && problem.empty()) {
    time_checksum_ += checksum(times_.data(), rows, written_);
    fine = fine && set_rows(file.get(), "time", {written_, rows, 0, 0, 0}) &&
           write_part(file.get(), "time", {written_, rows, 0, 0, 0}, times_) &&
           write_checksum(file.get(), "time", time_checksum_);
    for (const Column &column : columns_) fine = fine && write_checksum(file.get(), column.name, column.checksum);
    if (!fine) std::filesystem::resize_file(target, 0, error);  // gives its space back, as HDF5 needs some to close it
    if (!file.close() || !fine) problem = path_ + ": cannot be written (disk full?)";
    if (problem.empty())
      problem = replace_file(path_);
    else
      std::filesystem::remove(target, error);
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
