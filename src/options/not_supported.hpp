// Names of features that the program lacks or that have another name.
#pragma once

#include <string>

namespace eulastic {

/// `name`: of an option, or a word as its value. Returns one clause with a reason and a replacement if it asks for a
/// missing feature, or the present name of a feature; else nothing. README.md, "What it does not do", has the same
/// list.
std::string not_supported(const std::string &name);

}  // namespace eulastic
