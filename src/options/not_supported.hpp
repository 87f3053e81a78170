// What the program does not do, for those who ask for it by name.
#pragma once

#include <string>

namespace eulastic {

/// One clause if `name`, of an option or a word as its value, asks for something that does not exist: why, and what to
/// use instead; or for something that has another name: that name. Else nothing. README.md, "What it does not do", says
/// the same.
std::string not_supported(const std::string &name);

}  // namespace eulastic
