// Rank 0 alone reads files and broadcasts their contents, because a file system serves one reader better than all
// ranks at once. Everything here is collective over run_communicator() and needs MPI, but not PETSc.
#pragma once

#include "base/petsc.hpp"

#include <mpi.h>

#include <cstddef>
#include <string>
#include <type_traits>

namespace eulastic {

/// Returns the communicator of the ranks that run one case: MPI_COMM_WORLD, or that of the RunOnRanks that exists.
MPI_Comm run_communicator() noexcept;

/// During its lifetime cases are parsed and run on `comm` instead of MPI_COMM_WORLD, so that one process can run cases
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

/// Broadcasts bytes of rank 0 in pieces of bounded size. Returns MPI's error code.
int broadcast_bytes(void *bytes, std::size_t count, MPI_Comm comm = run_communicator());

/// Broadcasts `value` of rank 0: a trivially copyable type, or a string or vector of such, which is resized.
template <class T>
void share(T *value) {
  if constexpr (std::is_trivially_copyable_v<T>) {
    (void)broadcast_bytes(value, sizeof *value);
  } else {
    std::size_t count = value->size();
    share(&count);
    value->resize(count);
    (void)broadcast_bytes(value->data(), count * sizeof *value->data());
  }
}

/// Calls `read` on rank 0 only and returns its result on all ranks.
template <class Read>
auto on_rank_0(Read read) {
  int rank;
  (void)MPI_Comm_rank(run_communicator(), &rank);
  decltype(read()) result{};
  if (rank == 0) result = read();
  share(&result);
  return result;
}

/// Whether `path` is a regular file, as rank 0 sees it. Collective.
bool is_file(const std::string &path);
/// Reads all bytes of a regular file on the calling rank. Returns false if it is no regular file or cannot be read.
bool read_file_locally(const std::string &path, std::string *bytes);
/// Reads all bytes of a regular file on rank 0 and broadcasts them. Returns false if it is no regular file or cannot be
/// read. Collective.
bool read_file(const std::string &path, std::string *bytes);

}  // namespace eulastic
