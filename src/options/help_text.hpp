// The manual: -help, docs/options.md, the page for man, and -version.
#pragma once

#include <string>

namespace eulastic {

/// All options, or those whose name, text, default or accepted values have `word`, in any case, those of the sides of
/// the box once for all; PETSc's options with it; and why it is not supported, if it is not. Nothing if there is none
/// of these.
std::string help_text(const std::string &word = {});
/// A few lines: how to start it, and where to read on.
std::string usage_text();
/// docs/options.md, whole.
std::string help_markdown();
/// The page for man(1), in troff with the macros of man(7).
std::string man_page();
/// Name and version of the program and of PETSc; one line.
std::string version_text();

}  // namespace eulastic
