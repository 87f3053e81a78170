#include "options/option_source.hpp"

#include "base/number_rows.hpp"
#include "base/one_line.hpp"
#include "base/rank_zero.hpp"
#include "io/option_values.hpp"
#include "options/option_table.hpp"
#include "options/petsc_options.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>
#include <sstream>

namespace eulastic {
namespace {

// -1, -.5, -inf and -nan are values: the last two to be refused as such.
bool is_name(const std::string &word) {
  if (word.size() < 2 || word[0] != '-' || std::isdigit(static_cast<unsigned char>(word[1])) || word[1] == '.')
    return false;
  const std::string start = lower_case(word.substr(1, word.find(',') - 1));
  return start != "inf" && start != "infinity" && start != "nan";
}

bool is_boolean_option(const std::string &name) {
  static const std::set<std::string> names = [] {
    std::set<std::string> set;
    Config config;
    for (const Option &option : option_table(config))
      if (option.bare) set.insert(option.name);
    return set;
  }();
  return names.count(name) > 0;
}

// Whether the word after option `name` is its value. PETSc's own options and booleans may have none: an existing
// file after them is the options file.
bool takes(const std::string &name, const std::string &word) {
  if (is_name(word)) return false;
  if (is_boolean_option(name) && is_boolean_word(word)) return true;
  return !(is_petsc_option(name) || is_boolean_option(name)) || !is_file(word);
}

}  // namespace

std::string read_words_as_entries(const std::vector<std::string> &words, const std::string &where,
                                  std::vector<Entry> *entries, std::string *options_file) {
  for (std::size_t w = 0; w < words.size(); ++w) {
    if (is_name(words[w])) {
      Entry entry{words[w].substr(1), {}, where, {}};
      if (w + 1 < words.size() && takes(entry.name, words[w + 1])) entry.value = words[++w];
      entries->push_back(entry);
    } else if (options_file && options_file->empty() && !words[w].empty()) {
      *options_file = words[w];
    } else {
      return "stray word \"" + words[w] + "\"" + where +
             "; accepted: " + (options_file ? "one options file and options -name value" : "-name value") +
             ", lists without spaces; see -help";
    }
  }
  return {};
}

std::string split_words(const std::string &line, std::vector<std::string> *words) {
  bool inside = false, quoted = false;
  for (std::size_t at = 0; at < line.size(); ++at) {
    char c = line[at];
    if (!quoted && (std::isspace(static_cast<unsigned char>(c)))) {
      inside = false;
      continue;
    }
    if (!inside && c == '#') break;
    if (!inside) words->emplace_back();
    inside = true;
    const bool escape = quoted && c == '\\' && at + 1 < line.size() && (line[at + 1] == '"' || line[at + 1] == '\\');
    if (escape) c = line[++at];
    if (c == '"' && !escape)
      quoted = !quoted;
    else
      words->back() += c;
  }
  return quoted ? "a quote is not closed" : "";
}

std::string quote_word(const std::string &word) {
  if (!word.empty() && word.find_first_of(" \t#\"") == std::string::npos) return word;
  std::string text;
  for (const char c : word) text += (c == '"' || c == '\\') ? std::string{'\\', c} : std::string(1, c);
  return '"' + text + '"';
}

std::string read_options_file(const std::string &path, std::vector<Source> *sources, int depth) {
  constexpr int deepest = 8;
  constexpr std::size_t most = 100;
  std::string text, line;
  if (depth > deepest || sources->size() >= most)
    return "-options_file: " + path +
           " includes itself, or too many files; accepted: files within files to a depth of " +
           std::to_string(deepest) + ", at most " + std::to_string(most) + " in all";
  if (!read_file(path, &text))
    return "options file " + path +
           " cannot be read; accepted: one regular file of options and options -name value, lists without spaces";
  std::istringstream file(text.substr(byte_order_mark_length(text)));
  Source entries;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::string where = " (" + path + ":" + std::to_string(number) + ")";
    std::vector<std::string> words;
    if (const std::string wrong = split_words(line, &words); !wrong.empty()) return wrong + where;
    if (const std::string wrong = read_words_as_entries(words, where, &entries, nullptr); !wrong.empty()) return wrong;
    if (entries.empty() || entries.back().name != "options_file") continue;
    const std::filesystem::path brought_in = entries.back().value;
    entries.pop_back();
    if (brought_in.empty()) return "-options_file: a value is missing; accepted: a path" + where;
    const std::string beside = (std::filesystem::path(path).parent_path() / brought_in).string();
    if (const std::string wrong = read_options_file(beside, sources, depth + 1); !wrong.empty()) return wrong + where;
  }
  for (Entry &entry : entries) entry.options_file = path;
  sources->push_back(std::move(entries));
  return {};
}

std::string find_input(const Entry &entry) {
  namespace fs = std::filesystem;
  const auto is_there = [](const fs::path &place) {
    std::error_code ignored;
    const std::string text = place.string();
    return fs::is_regular_file(place, ignored) || fs::is_regular_file(text.substr(0, text.rfind(':')), ignored);
  };
  const fs::path path = entry.value;
  if (entry.options_file.empty() || path.is_absolute()) return entry.value;
  return on_rank_0([&] {
    const fs::path beside = fs::path(entry.options_file).parent_path() / path;
    return !is_there(path) && is_there(beside) ? beside.string() : entry.value;
  });
}

}  // namespace eulastic
