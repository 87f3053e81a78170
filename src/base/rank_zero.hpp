// What files hold is read by rank 0 alone and told to the others: a file system serves one reader, not all ranks at
// once. Everything here is collective over all ranks of the program, from MPI_Init on; PETSc need not be there yet.
#pragma once

#include <mpi.h>

#include <cstddef>
#include <string>
#include <type_traits>

namespace eulastic {

/// Makes the bytes of rank 0 everybody's, in pieces of bounded size. Returns MPI's error code.
int share_bytes(void *bytes, std::size_t count, MPI_Comm comm = MPI_COMM_WORLD);

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
  (void)MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  decltype(look()) found{};
  if (rank == 0) found = look();
  share(&found);
  return found;
}

bool is_file(const std::string &path);
/// All bytes of a file; false if it cannot be read.
bool read_file(const std::string &path, std::string *bytes);

}  // namespace eulastic
