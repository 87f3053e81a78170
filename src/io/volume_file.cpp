#include "io/volume_file.hpp"

#include "base/number_rows.hpp"
#include "base/one_line.hpp"
#include "io/hdf5_input.hpp"
#include "io/stl_file.hpp"

#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

namespace eulastic {
namespace {

namespace fs = std::filesystem;

constexpr unsigned long long most_voxels = 1 << 20;  // in one direction

}  // namespace

const double VolumeFile::not_given = std::numeric_limits<double>::quiet_NaN();

std::string find_volume(const std::string &path, VolumeFormat *format, std::string *file, std::string *dataset) {
  split_dataset(path, file, dataset);
  std::error_code ignored;
  if (!fs::is_regular_file(*file, ignored)) return *file + " is not a file; accepted: an HDF5, NRRD or STL file";
  char magic[11] = "";
  std::ifstream stream(*file, std::ios::binary);
  stream.read(magic, sizeof magic - 1);
  if (!stream && stream.gcount() == 0) return *file + " is empty or cannot be read";
  const std::string suffix = lower_case(fs::path(*file).extension().string());
  if (is_hdf5(*file))
    *format = VolumeFormat::hdf5;
  else if (std::strncmp(magic + byte_order_mark_length(magic), "NRRD000", 7) == 0)
    *format = VolumeFormat::nrrd;
  else if (is_stl(*file) || suffix == ".stl")  // the reader says what is wrong with a damaged one
    *format = VolumeFormat::stl;
  else
    return *file + " is not an HDF5, NRRD or STL file, or is damaged at its beginning";
  if (!dataset->empty() && *format != VolumeFormat::hdf5)
    return *file + " has no datasets; accepted: FILE:DATASET for HDF5 only";
  return {};
}

std::string VolumeFile::set_count(const std::vector<unsigned long long> &slowest_last, double bytes,
                                  double most_bytes) {
  count_ = {1, 1, 1};
  for (std::size_t d = 0; d < slowest_last.size(); ++d) {
    const unsigned long long n = slowest_last[d];
    if (n < 1 || n > most_voxels)
      return file_ + ": " + std::to_string(n) + " voxels in " + "xyz"[d] + "; accepted: 1 ... " +
             std::to_string(most_voxels);
    count_[d] = static_cast<int>(n);
    bytes *= double(n);
  }
  if (bytes > most_bytes || bytes > 9e18) {
    return file_ + print(": %d x %d x %d voxels do not fit into what the file holds, it is truncated or damaged",
                         count_[0], count_[1], count_[2]);
  }
  return {};
}

std::string VolumeFile::set_spacing(const std::vector<double> &spacing) {
  for (std::size_t d = 0; d < spacing.size(); ++d) {
    if (!std::isfinite(spacing[d]) || spacing[d] <= 0)
      return file_ + ": spacing in " + "xyz"[d] + " is not positive and finite; accepted: finite numbers > 0";
    spacing_[d] = spacing[d];
  }
  return {};
}

std::string VolumeFile::read(const Int3 &begin, const Int3 &end, double *fractions) {
  if (std::string wrong = read_values(begin, end, fractions); !wrong.empty()) return file_ + ": " + wrong;
  const double *value = fractions;
  for (int k = begin[2]; k < end[2]; ++k)
    for (int j = begin[1]; j < end[1]; ++j)
      for (int i = begin[0]; i < end[0]; ++i, ++value)
        if (!(*value >= 0 && *value <= 1)) {
          return file_ +
                 print(": voxel [%d, %d, %d] is %.9g; accepted: 0 ... 1, or integers as a mask", k, j, i, *value);
        }
  return {};
}

}  // namespace eulastic
