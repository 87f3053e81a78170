// Volumes of voxels in files: HDF5 datasets and NRRD (raw, gzip or ascii). Local to a rank.
//
// Integers (and booleans) are masks, non-zero is solid; floats are solid fractions, 0 ... 1. Headers that promise more
// than the file can hold are refused, and values are read piece by piece.
#pragma once

#include "grid/voxels.hpp"

#include <memory>

namespace eulastic {

enum class VolumeFormat { hdf5, nrrd, stl };

/// Finds the format of a file by its content alone. `path` may be FILE:DATASET if there is no file of that whole name.
/// Returns what is wrong, or nothing.
std::string find_volume(const std::string &path, VolumeFormat *format, std::string *file, std::string *dataset);

class VolumeFile {
public:
  virtual ~VolumeFile() = default;

  /// Voxels along x, y, z; a plane has 1 along z.
  const Int3 &count() const { return count_; }
  /// Spacing and low corner of the first voxel as given in the file; nan if the file does not give them.
  const Real3 &spacing() const { return spacing_; }
  const Real3 &corner() const { return corner_; }

  /// Implements ReadVoxels; refuses values outside 0 ... 1 and nan.
  std::string read(const Int3 &begin, const Int3 &end, double *fractions);

protected:
  virtual std::string read_values(const Int3 &begin, const Int3 &end, double *values) = 0;
  /// Refuses numbers of voxels that are 0, no int, or need more than `most_bytes` bytes each `bytes` long.
  std::string set_count(const std::vector<unsigned long long> &slowest_last, double bytes, double most_bytes);
  std::string set_spacing(const std::vector<double> &spacing);

  std::string file_;
  Int3 count_{};
  Real3 spacing_{not_given, not_given, not_given}, corner_{not_given, not_given, not_given};
  static const double not_given;
};

/// Opens by format. `volume` is set if nothing is wrong.
std::string open_hdf5_volume(const std::string &file, const std::string &dataset, std::unique_ptr<VolumeFile> *volume);
std::string open_nrrd_volume(const std::string &file, std::unique_ptr<VolumeFile> *volume);

}  // namespace eulastic
