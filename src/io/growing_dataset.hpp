// A dataset of bodies.h5 that grows by rows and by bodies, and its checksum.
#pragma once

#include "io/hdf5_handle.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace eulastic {

bool write_text_attribute(hid_t object, const char *name, const std::string &text);

/// (rows), (rows, bodies) or (rows, bodies, width), of doubles. Everything here is local and returns false where HDF5
/// fails.
class GrowingDataset {
public:
  GrowingDataset(const char *name, int rank, std::size_t width) : name_(name), rank_(rank), width_(width) {}

  /// Values of a body in a row.
  std::size_t width() const { return width_; }

  /// Creates the dataset, or changes its numbers of rows and bodies.
  bool resize(hid_t file, hsize_t rows, hsize_t bodies);
  /// Writes `values` of `bodies` bodies from `body` on, in rows from `row` on.
  bool write(hid_t file, hsize_t row, hsize_t body, hsize_t bodies, const std::vector<double> &values);
  /// Shortens the dataset to its first `rows` rows and reads its checksum.
  bool cut(hid_t file, hsize_t rows);
  bool write_checksum(hid_t file) const;

private:
  Hdf5Dataset open(hid_t file) const { return Hdf5Dataset(H5Dopen2(file, name_, H5P_DEFAULT)); }
  bool create(hid_t file, hsize_t rows, hsize_t bodies) const;

  const char *name_;
  int rank_;
  hsize_t width_;
  std::uint64_t checksum_ = 0;
};

}  // namespace eulastic
