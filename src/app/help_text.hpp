// The manual: -help, docs/options.md and -version.
#pragma once

#include <string>

namespace eulastic {

std::string help_text();
/// docs/options.md, whole.
std::string help_markdown();
/// Name and version of the program and of PETSc; one line.
std::string version_text();

}  // namespace eulastic
