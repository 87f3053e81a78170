// What tests of files need: directories that vanish, full disks, error messages, datasets as others see them.
#pragma once

#include "base/petsc.hpp"
#include "base/rank_zero.hpp"
#include "io/hdf5_handle.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace eulastic::test {

namespace fs = std::filesystem;

inline int world_rank() {
  int rank;
  MPI_Comm_rank(run_communicator(), &rank);
  return rank;
}

// A directory of this process.
class TemporaryDirectory {
public:
  TemporaryDirectory() {
    std::string name = (fs::temp_directory_path() / "eulastic_io_test_XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~TemporaryDirectory() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  std::string operator/(const std::string &name) const { return (path_ / name).string(); }

private:
  fs::path path_;
};

// A directory that all ranks share and rank 0 removes.
class SharedDirectory {
public:
  SharedDirectory() {
    int id = ::getpid();
    MPI_Bcast(&id, 1, MPI_INT, 0, run_communicator());
    path_ = fs::temp_directory_path() / ("eulastic_mpi_test_" + std::to_string(id));
    if (world_rank() == 0) fs::create_directories(path_);
    MPI_Barrier(run_communicator());
  }
  ~SharedDirectory() {
    MPI_Barrier(run_communicator());
    std::error_code ignored;
    if (world_rank() == 0) fs::remove_all(path_, ignored);
  }
  std::string operator/(const std::string &name) const { return (path_ / name).string(); }

private:
  fs::path path_;
};

// No file may grow beyond so many bytes.
class FullDisk {
public:
  explicit FullDisk(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit limit{bytes, old_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, handler_);
  }

private:
  rlimit old_;
  void (*handler_)(int);
};

inline std::string text_of(const std::string &path) {
  std::stringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

// The message of a call that must fail, with PETSc's traceback off.
template <class Call>
std::string error_of(Call call) {
  const char *text;
  char *specific = nullptr;
  PetscPushErrorHandler(PetscReturnErrorHandler, nullptr);
  const PetscErrorCode code = call();
  PetscPopErrorHandler();
  if (code == 0) return "no error";
  PetscErrorMessage(code, &text, &specific);
  return specific;
}

// The dataset as one process sees it, through plain serial HDF5.
inline std::vector<double> whole(const std::string &path, const std::string &name, std::vector<hsize_t> *shape) {
  const Hdf5FileHandle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  const Hdf5Dataset dataset(H5Dopen2(file.get(), name.c_str(), H5P_DEFAULT));
  *shape = hdf5_shape(dataset.get());
  std::size_t count = 1;
  for (const hsize_t n : *shape) count *= n;
  std::vector<double> values(count);
  EXPECT_GE(H5Dread(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
  return values;
}

}  // namespace eulastic::test
