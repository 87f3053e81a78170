// Collective calls into HDF5 that do not come back. A rank that fails alone inside one cleans up by collective calls of
// its own: it waits there and the others elsewhere, all of them inside HDF5, for ever.
#pragma once

#include <string>

namespace eulastic {

/// Ends every rank, with one line that names `path`, if this object lives for more than five minutes. One at a time,
/// for collective calls: all ranks have one.
class Deadline {
public:
  Deadline(int rank, const std::string &path);
  ~Deadline();
  Deadline(const Deadline &) = delete;
  Deadline &operator=(const Deadline &) = delete;
};

}  // namespace eulastic
