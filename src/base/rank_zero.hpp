// Rank 0 alone reads files and broadcasts their contents, because a file system serves one reader better than all
// ranks at once. Everything here is collective over run_communicator() and needs MPI, but not PETSc.
#pragma once

#include "base/petsc.hpp"

#include <mpi.h>

#include <cstddef>
#include <string>
#include <type_traits>

namespace eulastic {

/// The communicator of the ranks that run one case: MPI_COMM_WORLD, except within the life of a RunOnRanks.
MPI_Comm run_communicator() noexcept;

/// Parses and runs cases on `comm` instead of MPI_COMM_WORLD until it is destroyed, so that one process can run cases
/// on several numbers of ranks.
class RunOnRanks {
public:
  explicit RunOnRanks(MPI_Comm comm) noexcept;
  ~RunOnRanks();
  RunOnRanks(const RunOnRanks &) = delete;
  RunOnRanks &operator=(const RunOnRanks &) = delete;

private:
  MPI_Comm before_;
};

/// Makes the bytes of rank 0 everybody's, in pieces of bounded size. Returns MPI's error code.
int share_bytes(void *bytes, std::size_t count, MPI_Comm comm = run_communicator());

/// Makes `value` of rank 0 everybody's: plain bytes, or a string or vector of such, which takes its size.
template <class T>
void share(T *value) {
  if constexpr (std::is_trivially_copyable_v<T>) {
    (void)share_bytes(value, sizeof *value);
  } else {
    std::size_t count = value->size();
    share(&count);
    value->resize(count);
    (void)share_bytes(value->data(), count * sizeof *value->data());
  }
}

/// What `look` returns on rank 0, where alone it is called.
template <class Look>
auto on_rank_0(Look look) {
  int rank;
  (void)MPI_Comm_rank(run_communicator(), &rank);
  decltype(look()) found{};
  if (rank == 0) found = look();
  share(&found);
  return found;
}

bool is_file(const std::string &path);
/// All bytes of a regular file, read by this rank for itself; false if it is none or cannot be read.
bool read_file_here(const std::string &path, std::string *bytes);
/// All bytes of a regular file; false if it is none or cannot be read.
bool read_file(const std::string &path, std::string *bytes);

}  // namespace eulastic
