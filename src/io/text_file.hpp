// Whole files written so that a reader, or a crash, sees the old one or the new one, never half of one.
#pragma once

#include "base/petsc.hpp"

#include <sys/types.h>

#include <string>

namespace eulastic {

/// 17 significant digits, whatever the locale: the text reads back as the same double. "nan", "inf", "-inf".
std::string format_double(double value);

/// Path of a file until it is complete.
std::string temporary_name(const std::string &path);
/// Local. Syncs `temporary_name(path)` and renames it to `path`, or removes it if there is an error: `wrong`, which
/// says why it is not complete, or one of this. Returns the error, one line, or nothing.
std::string replace_file(const std::string &path, std::string wrong = {});
/// Collective; rank 0's `text` is written beside, synced and renamed.
PetscErrorCode write_text_file(MPI_Comm comm, const std::string &path, const std::string &text);

class FileStamp {
public:
  /// Notes which file `path` is, and how long.
  void take(const std::string &path);
  /// Empty if `path` is the same file and as long as it was when take() was called; else one line.
  std::string difference(const std::string &path) const;

private:
  dev_t device_ = 0;
  ino_t file_ = 0;
  off_t bytes_ = 0;
};

}  // namespace eulastic
