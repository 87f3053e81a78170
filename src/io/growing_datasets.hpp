// Datasets of bodies.h5, (rows), (rows, bodies) or (rows, bodies, width), that grow by rows and by bodies. Each carries
// a checksum. All of this is local and returns false where HDF5 fails.
#pragma once

#include "io/hdf5_handle.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace eulastic {

/// Part of such a dataset: its first row and body, and how many of each; `width` is 0 for (rows), 1 for (rows, bodies).
struct RowsPart {
  hsize_t row, rows, body, bodies, width;
  int rank() const { return width == 0 ? 1 : width == 1 ? 2 : 3; }
};

bool write_text_attribute(hid_t object, const char *name, const std::string &text);
bool write_checksum(hid_t file, const char *name, std::uint64_t sum);
/// Makes the dataset long enough for `whole`, or creates it.
bool set_rows(hid_t file, const char *name, const RowsPart &whole);
bool write_part(hid_t file, const char *name, const RowsPart &part, const std::vector<double> &values);
/// Gives all rows another number of bodies. `sum`: the new checksum.
bool set_bodies(hid_t file, const char *name, hsize_t bodies, std::uint64_t *sum);
/// Shortens a dataset to its first `rows` rows; its checksum loses what the others had given.
bool cut_rows(hid_t file, const char *name, hsize_t rows, std::uint64_t *sum);

}  // namespace eulastic
