// bodies.h5: the history of every body, as extendible datasets.
//
// An HDF5 file that is open when its process is killed cannot be read. So rows wait in memory, and now and then the
// file is copied, extended, synced and renamed: whenever the rows have grown by a quarter, or wait in 64 MB, and on
// flush(). Cost: at most about five times the bytes of the final file; a kill loses at most a fifth of the rows.
#pragma once

#include "io/body_record.hpp"

#include <cstdint>
#include <vector>

namespace eulastic {

class BodiesFile {
public:
  /// `membranes`: with what is known of those alone; `loads`: with force and torque, where there are bodies that bear
  /// loads.
  BodiesFile(MPI_Comm comm, std::string path, bool membranes = false, bool loads = false);

  /// Collective. One row; rank 0's records count, always the same bodies in the same order, others may follow: in
  /// earlier rows those have the volume 0 and no other number. No bodies, no file.
  PetscErrorCode add(double time, const std::vector<BodyRecord> &bodies);
  void moved_to(const std::string &path) { path_ = path; }
  /// Collective. All rows so far are on disk when this returns.
  PetscErrorCode flush();
  /// Collective, before the first add(): goes on with the file that is there, after its first `rows` rows. If it has
  /// been taken away a new one begins and `rows` becomes 0.
  PetscErrorCode resume(long *rows);

private:
  std::vector<double> scalars(const BodyRecord &body) const;  ///< of the columns behind the vectors
  struct Column {
    const char *name;
    int width;  ///< values per body; 0 = one per row
    std::vector<double> waiting;
    std::uint64_t checksum;
  };
  void get_to_know(const std::vector<BodyRecord> &bodies);
  std::string cut(std::size_t rows);  ///< rank 0; empty, or what went wrong
  std::string write_waiting();        ///< rank 0; empty, or what went wrong

  MPI_Comm comm_;
  int rank_ = 0;
  std::string path_;
  std::vector<BodyRecord> known_;  ///< who the bodies are
  std::vector<Column> columns_;
  bool membranes_, loads_;
  static constexpr std::size_t unknown = ~std::size_t(0);
  std::size_t written_ = 0, waiting_ = 0;  ///< rows
  std::size_t stored_ = unknown;           ///< bodies of the rows that are written
};

}  // namespace eulastic
