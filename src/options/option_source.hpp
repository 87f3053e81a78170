// Words of the command line, of options files or of PETSC_OPTIONS as option entries, not yet understood.
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

/// Entries of one file, of the environment or of the command line; a later source wins over an earlier one.
using Source = std::vector<Entry>;

/// All return what is wrong, or nothing.
/// `options_file`: set to the one positional word; null where there must be none.
std::string read_words_as_entries(const std::vector<std::string> &words, const std::string &where,
                                  std::vector<Entry> *entries, std::string *options_file);
/// Appends one source for each file, those that -options_file brings in before the file they stand in.
std::string read_options_file(const std::string &path, std::vector<Source> *sources);
/// The file (or FILE:DATASET) an entry names: as it is, or if it is not there, beside the options file.
std::string find_input(const Entry &entry);
/// Words of a line: separated by white space, "..." holds a word together and within it \" is a quote and \\ a
/// backslash, # before a word starts a comment.
std::string split_words(const std::string &line, std::vector<std::string> *words);
/// The word as split_words() reads it back.
std::string quote_word(const std::string &word);

}  // namespace eulastic
