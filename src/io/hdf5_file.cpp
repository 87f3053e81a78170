#include "io/hdf5_file.hpp"

#include "io/deadline.hpp"
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
  if (::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode)) return path + ": not a regular file";
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

PetscErrorCode Hdf5File::check(bool fine, const std::string &what) const {
  PetscFunctionBeginUser;
  PetscCall(fail_together(comm_, fine ? std::string() : path_ + ": " + what));
  PetscFunctionReturn(0);
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
  PetscCall(check(bool(file_), "cannot create this HDF5 file"));
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
  PetscCall(check(bool(file_), "not an HDF5 file, or a damaged or truncated one"));
  PetscFunctionReturn(0);
}

PetscErrorCode Hdf5File::commit() {
  PetscFunctionBeginUser;
  // The flush syncs every rank's part, which rank 0 could not do for other nodes.
  PetscCall(check(H5Fflush(file_.get(), H5F_SCOPE_GLOBAL) >= 0, "cannot be completed (disk full?)"));
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

PetscErrorCode Hdf5File::create_group(const std::string &name) {
  PetscFunctionBeginUser;
  Hdf5Object group(H5Gcreate2(file_.get(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  PetscCall(check(bool(group), "cannot create group " + name));
  PetscCall(check(group.close(), "cannot close group " + name));
  PetscFunctionReturn(0);
}

PetscErrorCode Hdf5File::link(const std::string &name, const std::string &file, const std::string &dataset) {
  PetscFunctionBeginUser;
  const bool linked =
      H5Lcreate_external(file.c_str(), dataset.c_str(), file_.get(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT) >= 0;
  PetscCall(check(linked, "cannot link " + name + " to " + file));
  PetscFunctionReturn(0);
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

}  // namespace eulastic
