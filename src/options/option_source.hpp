// Splits the command line, options files and PETSC_OPTIONS into entries of a name and a value.
#pragma once

#include <string>
#include <vector>

namespace eulastic {

struct Entry {
  std::string name;          ///< without the dash
  std::string value;         ///< empty = none
  std::string where;         ///< " (FILE:LINE)" or the like, for messages; empty on the command line
  std::string options_file;  ///< it is in; empty = none
};

/// Entries of one file, of the environment or of the command line; a later source overrides an earlier one.
using Source = std::vector<Entry>;

/// All return an error text, or nothing.
/// `options_file`: set to the one positional word; null where there must be none.
std::string read_words_as_entries(const std::vector<std::string> &words, const std::string &where,
                                  std::vector<Entry> *entries, std::string *options_file);
/// Appends one source for each file; files that -options_file includes come before the including file. `depth`: how
/// many files include this one.
std::string read_options_file(const std::string &path, std::vector<Source> *sources, int depth = 0);
/// The file (or FILE:DATASET) that an entry names: the path itself, or if it does not exist, the path relative to the
/// options file.
std::string find_input(const Entry &entry);
/// Words of a line: separated by white space, "..." holds a word together and within it \" is a quote and \\ a
/// backslash, # before a word starts a comment.
std::string split_words(const std::string &line, std::vector<std::string> *words);
/// The word as split_words() reads it back.
std::string quote_word(const std::string &word);

}  // namespace eulastic
