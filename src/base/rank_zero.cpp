#include "base/rank_zero.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>

namespace eulastic {
namespace {

MPI_Comm current = MPI_COMM_NULL;  // null: MPI_COMM_WORLD

}  // namespace

MPI_Comm run_communicator() noexcept { return current == MPI_COMM_NULL ? MPI_COMM_WORLD : current; }

RunOnRanks::RunOnRanks(MPI_Comm comm) noexcept : before_(current) { current = comm; }
RunOnRanks::~RunOnRanks() { current = before_; }

int broadcast_bytes(void *bytes, std::size_t count, MPI_Comm comm) {
  constexpr std::size_t piece = std::size_t{1} << 26;
  for (std::size_t begin = 0; begin < count; begin += piece) {
    const int length = static_cast<int>(std::min(piece, count - begin));
    if (const int error = MPI_Bcast(static_cast<char *>(bytes) + begin, length, MPI_BYTE, 0, comm)) return error;
  }
  return MPI_SUCCESS;
}

bool is_file(const std::string &path) {
  return on_rank_0([&] {
    std::error_code ignored;
    return std::filesystem::is_regular_file(path, ignored);
  });
}

bool read_file_locally(const std::string &path, std::string *bytes) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;  // reading a FIFO or a device might never end
  std::FILE *file = std::fopen(path.c_str(), "re");
  if (!file) return false;
  char piece[1 << 14];
  bytes->clear();
  while (const std::size_t length = std::fread(piece, 1, sizeof piece, file)) bytes->append(piece, length);
  const bool complete = std::ferror(file) == 0;
  return std::fclose(file) == 0 && complete;
}

bool read_file(const std::string &path, std::string *bytes) {
  const bool success = on_rank_0([&] { return read_file_locally(path, bytes); });
  share(bytes);
  return success;
}

}  // namespace eulastic
