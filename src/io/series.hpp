// A table that grows by a row now and then: series.csv.
#pragma once

#include "base/petsc.hpp"
#include "io/text_file.hpp"

#include <cstdio>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace eulastic {

class Series {
public:
  /// Collective. Opens `path` for appending on rank 0; a new file gets the header, an old one must have the same.
  /// Of an old one only the first `rows_kept` rows stay.
  PetscErrorCode open(MPI_Comm comm, const std::string &path, const std::vector<std::string> &columns,
                      long rows_kept = std::numeric_limits<long>::max());
  /// Collective. One value per column, rank 0's count; 17 digits, and in the file when this returns.
  PetscErrorCode write(const std::vector<double> &values);
  /// Collective. The same of the rows that rank 0 has.
  PetscErrorCode write_rows(const std::vector<std::vector<double>> &rows);
  /// Collective. All rows survive a power cut when this returns.
  PetscErrorCode sync();
  /// Rank 0 has renamed the file.
  void moved_to(const std::string &path) { path_ = path; }
  /// In the file.
  long rows() const { return rows_; }

private:
  std::string append(const std::string &line);  ///< empty, or what went wrong

  MPI_Comm comm_ = MPI_COMM_NULL;
  std::string path_;
  FileStamp stamp_;
  std::size_t columns_ = 0;
  long rows_ = 0;
  std::unique_ptr<std::FILE, int (*)(std::FILE *)> file_{nullptr, std::fclose};
};

}  // namespace eulastic
