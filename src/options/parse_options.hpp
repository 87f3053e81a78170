// Parses the command line into a validated Config, without PETSc. Collective; all ranks get the same result.
#pragma once

#include "options/petsc_options.hpp"
#include "scene/config.hpp"

#include <string>
#include <vector>

namespace eulastic {

struct InputFile {
  std::string option;   ///< that names it, without the dash
  std::string path;     ///< as in options.txt
  std::string content;  ///< 16 hexadecimal digits: the same bytes give the same digits
};

struct ParseResult {
  Config config;
  std::string error;                  ///< one line without "eulastic: error: ", empty if all is well; exit code 2
  std::vector<InputFile> inputs;      ///< files that options name, of a config without error
  std::vector<std::string> warnings;  ///< one line each, without "eulastic: warning: "
  std::string message;                ///< -help, -version: print to stdout and exit 0
  bool alone = false;                 ///< no arguments were given: the message is the usage, the exit code 2
  std::string program = "eulastic";   ///< as it was started
  /// PETSc's own options of all sources, PETSC_OPTIONS included: unset that variable before PetscInitialize.
  PetscOptionValues petsc;
  std::string petsc_options;  ///< PETSC_OPTIONS as found
};

/// `arguments`: the command line without the program name: options and at most one options file. An options file
/// has lines `-name value`, # starts a comment. The command line overrides `petsc_options` (the environment variable),
/// which overrides the file. Rank 0 reads the files that they name; nothing is written.
ParseResult parse(const std::vector<std::string> &arguments, const std::string &petsc_options = {});

/// Every option as resolved; itself an options file that gives the same run.
std::string options_text(const ParseResult &result);

/// Begins the line of options.txt, below that of the option, with the hash of its file.
inline const std::string content_mark = "# content ";

}  // namespace eulastic
