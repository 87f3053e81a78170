// Datasets of HDF5 files that others wrote. Local to a rank.
#pragma once

#include "io/hdf5_handle.hpp"

#include <string>
#include <vector>

namespace eulastic {

/// Splits FILE:DATASET, unless there is a file of that whole name; `dataset` is empty where none is named.
void split_dataset(const std::string &path, std::string *file, std::string *dataset);
/// Whether a file has the signature of HDF5, at its beginning or behind a user block of 512, 1024, 2048, ... bytes.
bool is_hdf5(const std::string &file);

struct Hdf5Input {
  Hdf5FileHandle file;
  Hdf5Dataset dataset;
  std::string name;  ///< of the dataset, from the root of the file
};

/// Opens a dataset: the one of that `name`; if this is empty `usual`, or else the only one of the file, in any group.
/// Datasets whose values lie in other files are refused. Returns what is wrong, or nothing.
std::string open_input(const std::string &file, const std::string &name, const std::string &usual, Hdf5Input *input);

/// From `dataset`, or if this is empty from `velocity` or the only one of the file: one number per cell of a side of
/// `slow` rows of `fast` cells, row by row, from (slow, fast), the normal velocity into the box, or from (slow, fast,
/// 3), x, y, z, of which `component`, times `sign`, is taken; a single row may have no dimension of its own. Returns
/// what is wrong, or nothing.
std::string read_profile_file(const std::string &path, const std::string &dataset, int slow, int fast, int component,
                              double sign, std::vector<double> *values);

}  // namespace eulastic
