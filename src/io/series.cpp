#include "io/series.hpp"

#include "io/fail_together.hpp"

#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace eulastic {
namespace {

// The bytes of the header and the first `rows` complete rows, or of all there are if there are fewer: then `rows`
// says how many.
std::uintmax_t bytes_of(const std::string &path, long *rows) {
  std::ifstream file(path, std::ios::binary);
  std::string line;
  std::uintmax_t bytes = 0;
  long found = -1;
  while (found < *rows && std::getline(file, line) && !file.eof()) {
    bytes += line.size() + 1;
    ++found;
  }
  *rows = std::max(found, 0L);
  return bytes;
}

}  // namespace

std::string Series::append(const std::string &line) {
  if (std::string problem = stamp_.difference(path_); !problem.empty()) return problem;
  const bool written = std::fwrite(line.data(), 1, line.size(), file_.get()) == line.size();
  if (std::fflush(file_.get()) != 0 || !written) return "cannot write " + path_ + ": " + std::strerror(errno);
  stamp_.take(path_);
  return {};
}

PetscErrorCode Series::open(MPI_Comm comm, const std::string &path, const std::vector<std::string> &columns,
                            long rows_kept) {
  int rank;
  std::string problem, header;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  comm_ = comm;
  path_ = path;
  columns_ = columns.size();
  for (const std::string &column : columns) header += (header.empty() ? "" : ",") + column;
  if (rank == 0) {
    std::string first;
    std::getline(std::ifstream(path), first);
    std::error_code error;
    if (first == header) std::filesystem::resize_file(path, bytes_of(path, &rows_kept), error);
    if (first == header) rows_ = rows_kept;
    file_.reset(std::fopen(path.c_str(), "ae"));
    stamp_.take(path);
    if (error || !file_)
      problem = "cannot open " + path + ": " + (error ? error.message() : std::strerror(errno));
    else if (first.empty())
      problem = append(header + "\n");
    else if (first != header)
      problem = path + " has other columns: " + first + "; accepted: those of this run, " + header;
  }
  PetscCallMPI(MPI_Bcast(&rows_, 1, MPI_LONG, 0, comm));
  PetscCall(fail_together(comm, problem));
  PetscFunctionReturn(0);
}

PetscErrorCode Series::write(const std::vector<double> &values) {
  PetscFunctionBeginUser;
  PetscCall(write_rows({values}));
  PetscFunctionReturn(0);
}

PetscErrorCode Series::write_rows(const std::vector<std::vector<double>> &rows) {
  std::string problem, lines;
  long count = static_cast<long>(rows.size());
  PetscFunctionBeginUser;
  for (std::size_t r = 0; r < rows.size() && file_; ++r) {
    PetscCheck(rows[r].size() == columns_, PETSC_COMM_SELF, PETSC_ERR_ARG_SIZ, "%s: %zu values for %zu columns",
               path_.c_str(), rows[r].size(), columns_);
    std::string line;
    for (const double value : rows[r]) line += (line.empty() ? "" : ",") + format_double(value);
    lines += line + "\n";
  }
  if (!lines.empty()) problem = append(lines);
  PetscCall(fail_together(comm_, problem));
  PetscCallMPI(MPI_Bcast(&count, 1, MPI_LONG, 0, comm_));
  rows_ += count;
  PetscFunctionReturn(0);
}

PetscErrorCode Series::sync() {
  PetscFunctionBeginUser;
  const bool synced = !file_ || ::fsync(::fileno(file_.get())) == 0 || errno == EINVAL;
  PetscCall(fail_together(comm_, synced ? "" : "cannot sync " + path_ + ": " + std::strerror(errno)));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
