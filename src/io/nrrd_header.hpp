// The header of an NRRD file (teem.sourceforge.net/nrrd/format.html), as far as its fields change what the data mean.
#pragma once

#include "grid/box.hpp"

#include <cstdint>
#include <string>

namespace eulastic {

struct NrrdHeader {
  enum class Encoding { raw, gzip, ascii };
  std::vector<unsigned long long> sizes;  ///< fastest first
  int bytes = 0;                          ///< of a value
  bool is_float = false;
  bool big_endian = false;
  Encoding encoding = Encoding::raw;
  std::vector<double> spacing;  ///< empty = not given
  std::vector<double> corner;   ///< low corner of the first voxel, its centre without a spacing; empty = not given
  std::string data_file;        ///< what holds the values: the file itself, or the one that a detached header names
  std::int64_t data = 0;        ///< offset of the first value
};

/// Returns what is wrong, or nothing.
std::string read_nrrd_header(const std::string &file, NrrdHeader *header);

}  // namespace eulastic
