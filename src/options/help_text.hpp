// Texts of -help, docs/options.md, the manual page and -version.
#pragma once

#include <string>

namespace eulastic {

/// All options, or those whose name, text, default or accepted values contain `word`, ignoring case, with one entry for
/// all boundaries; PETSc's options with it; and the reason if it is not supported. Empty if nothing matches.
std::string help_text(const std::string &word = {});
/// A short usage text.
std::string usage_text();
/// The text of docs/options.md.
std::string help_markdown();
/// The page for man(1), in troff with the macros of man(7).
std::string man_page();
/// Name and version of the program and of PETSc; one line.
std::string version_text();

}  // namespace eulastic
