// bodies.h5: the history of every body, as extendible datasets.
//
// An HDF5 file that is open when its process is killed cannot be read. So rows wait in memory, each rank's of the
// bodies that it owns, and now and then rank 0 collects them: the file is copied, extended, synced and renamed whenever
// the rows have grown by a quarter, or wait in 64 MB, when bodies come in, and on flush(). Cost: at most about five
// times the bytes of the final file; a kill loses at most a fifth of the rows. Rank 0 holds what waits of some 100,000
// bodies at a time.
#pragma once

#include "base/petsc.hpp"
#include "io/growing_dataset.hpp"
#include "io/text_file.hpp"

#include <functional>
#include <string>
#include <vector>

namespace eulastic {

/// All bodies: how many there are, and the name of the species of each, by its label.
struct BodySpecies {
  int bodies = 0;
  std::function<const std::string &(int label)> name;
};

/// A quantity of every body: the name of its dataset, a literal, and the number of its values.
struct BodyColumn {
  const char *name;
  int width;
};

class BodiesFile {
public:
  BodiesFile(MPI_Comm comm, std::string path, const std::vector<BodyColumn> &columns);

  /// Collective. One row; every rank has the values of all columns of the bodies that it owns (BodyRange), one body
  /// after the other, always the same bodies in the same order; others may follow: in earlier rows those have the
  /// volume 0 and no other number. No bodies, no file.
  PetscErrorCode add(double time, const BodySpecies &all, const std::vector<double> &owned);
  void moved_to(const std::string &path) { path_ = path; }
  /// Collective. All rows so far are on disk when this returns.
  PetscErrorCode flush();
  /// Collective, before the first add(): goes on with the file that is there, after its first `rows` rows. If it has
  /// been taken away a new one begins and `rows` becomes 0.
  PetscErrorCode resume(long *rows);

private:
  std::string cut(std::size_t rows);  ///< rank 0; empty, or what went wrong
  PetscErrorCode collect(int begin, int end, std::vector<double> *values) const;
  bool write_columns(hid_t file, int begin, int end, const std::vector<double> &values);

  MPI_Comm comm_;
  int rank_ = 0, ranks_ = 1;
  std::string path_;
  FileStamp stamp_;    ///< of the file as rank 0 has written it
  BodySpecies known_;  ///< who the bodies are
  GrowingDataset time_{"time", 1, 1};
  std::vector<GrowingDataset> columns_;  ///< values of bodies
  int width_ = 0;                        ///< values of a body in a row
  std::vector<double> times_, waiting_;  ///< rows that wait: (rows), (rows, owned bodies, width_)
  std::size_t written_ = 0;              ///< rows
  std::size_t stored_ = 0;               ///< bodies that `id` and `species` of the file name
};

}  // namespace eulastic
