// Whole files written so that a reader, or a crash, sees the old one or the new one, never half of one.
#pragma once

#include "base/petsc.hpp"

#include <string>

namespace eulastic {

/// 17 significant digits, whatever the locale: the text reads back as the same double. "nan", "inf", "-inf".
std::string format_double(double value);

/// Where a file lives until it is complete.
std::string temporary_name(const std::string &path);
/// Local. Syncs `temporary_name(path)` and renames it to `path`; empty, or one line that says what went wrong.
std::string replace_file(const std::string &path);
/// Collective; rank 0's `text` is written beside, synced and renamed.
PetscErrorCode write_text_file(MPI_Comm comm, const std::string &path, const std::string &text);

}  // namespace eulastic
