#include "io/series.hpp"

#include "io/fail_together.hpp"
#include "io/text_file.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>

namespace eulastic {

std::string Series::append(const std::string &line) {
  const bool written = std::fwrite(line.data(), 1, line.size(), file_.get()) == line.size();
  if (std::fflush(file_.get()) == 0 && written) return {};
  return "cannot write " + path_ + ": " + std::strerror(errno);
}

PetscErrorCode Series::open(MPI_Comm comm, const std::string &path, const std::vector<std::string> &columns) {
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
    file_.reset(std::fopen(path.c_str(), "ae"));
    if (!file_)
      problem = "cannot open " + path + ": " + std::strerror(errno);
    else if (first.empty())
      problem = append(header + "\n");
    else if (first != header)
      problem = path + ": has other columns (" + first + "), expected " + header;
  }
  PetscCall(fail_together(comm, problem));
  PetscFunctionReturn(0);
}

PetscErrorCode Series::write(const std::vector<double> &values) {
  std::string problem;
  PetscFunctionBeginUser;
  if (file_) {
    PetscCheck(values.size() == columns_, PETSC_COMM_SELF, PETSC_ERR_ARG_SIZ, "%s: %zu values for %zu columns",
               path_.c_str(), values.size(), columns_);
    std::string line;
    for (const double value : values) line += (line.empty() ? "" : ",") + format_double(value);
    problem = append(line + "\n");
  }
  PetscCall(fail_together(comm_, problem));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
