// Every option, declared once: one row each, bound to its member of a Config. Parsing, -help, options.txt and
// docs/options.md are made from these rows.
#pragma once

#include "scene/config.hpp"

#include <functional>
#include <string>
#include <vector>

namespace eulastic {

/// One row.
struct Option {
  std::string group;
  std::string name;  ///< without the dash
  std::string unit;  ///< empty for pure numbers and words
  std::string doc;
  std::string accepted;  ///< in words, e.g. "3 numbers > 0, separated by commas"
  bool bare = false;     ///< may stand without a value
  bool required = false;
  bool may_change = false;    ///< at a restart
  bool command_line = false;  ///< accepted only there: an options file cannot give it, and options.txt omits it
  std::string alias_of;       ///< another way to give that option
  std::string default_note;   ///< describes the default if the initial value does not

  /// Whether a value names a file to read, which is then also looked for beside the options file; null = no value does.
  std::function<bool(const std::string &value)> names_file;
  /// Reads a value into the Config; returns an error text, or nothing.
  std::function<std::string(const std::string &value)> read;
  /// The member's present value as the user would write it; empty = none.
  std::function<std::string()> text;
  std::string only_with;          ///< "-boundary_x wall": the option applies only with it; empty = always
  std::function<bool()> applies;  ///< whether that holds; null = always
};

/// All rows bound to `config`, which must outlive them; the rows of a species once for each of config.species,
/// which must not change its size meanwhile.
std::vector<Option> option_table(Config &config);

/// Sets all parts of the method to the preset that `value` names. Comes before the other options of the method.
std::string read_method(const std::string &value, Config *config);

/// Whether the first word of the name of a species ("wall", "ksp", ...) is reserved.
bool is_reserved_word(const std::string &word);

}  // namespace eulastic
