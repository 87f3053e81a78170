// The options that belong to PETSc and pass through to it unread.
#pragma once

#include <string>
#include <vector>

namespace eulastic {

/// `name` without its dash.
bool is_petsc_option(const std::string &name);
/// Whole names and prefixes (ending in _) that is_petsc_option accepts.
const std::vector<std::string> &petsc_option_names();

}  // namespace eulastic
