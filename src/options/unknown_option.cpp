#include "options/unknown_option.hpp"

#include "io/option_values.hpp"
#include "options/not_supported.hpp"
#include "options/petsc_options.hpp"
#include "options/renamed_options.hpp"

#include <algorithm>
#include <cctype>
#include <numeric>
#include <sstream>

namespace eulastic {
namespace {

// Levenshtein.
std::size_t edit_distance(const std::string &a, const std::string &b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({row[j + 1] + 1, row[j] + 1, replaced});
    }
  }
  return row.back();
}

// end_time has the words of time_end.
std::string sorted_words(const std::string &name) {
  std::istringstream stream(name);
  std::vector<std::string> words;
  for (std::string word; std::getline(stream, word, '_');) words.push_back(word);
  std::sort(words.begin(), words.end());
  return join(words, "_");
}

// A part of a name counts as one slip: viscosity is fluid_viscosity.
std::size_t distance(const std::string &typed, const std::string &known) {
  if (("_" + known + "_").find("_" + typed + "_") != std::string::npos) return 1;
  return std::min(edit_distance(typed, known), edit_distance(sorted_words(typed), sorted_words(known)));
}

// "cell" if `name` is an option of species and -species does not name a cell.
std::string missing_species(const std::string &name) {
  for (std::size_t end = name.find('_'); end != std::string::npos; end = name.find('_', end + 1)) {
    const std::string species = name.substr(0, end);
    if (species.empty() || is_reserved_word(species.substr(0, species.find('_')))) continue;
    Config config;
    config.species.resize(1);
    config.species[0].name = species;
    for (const Option &option : option_table(config))
      if (option.name == name) return species;
  }
  return {};
}

}  // namespace

std::string unknown_option(const std::string &name, const std::vector<Option> &table) {
  const std::string start = "unknown option -" + name, end = "; see -help";
  if (is_petsc_option("pressure_" + name)) return start + "; accepted with -pressure_solver ksp: -pressure_" + name;
  std::string plain = name.substr(0, name.find('=')).substr(name[0] == '-');
  if (const std::string now = present_name(plain); !now.empty())
    return start + ": it is now called -" + now + "; docs/options.md lists all former names";
  std::transform(plain.begin(), plain.end(), plain.begin(), [](unsigned char c) { return std::tolower(c); });
  const Option *nearest = nullptr;
  std::size_t least = plain.size() / 2 + 1;  // further away it is another word
  for (const Option &option : table)
    if (const std::size_t d = distance(plain, option.name); d < least) least = d, nearest = &option;
  if (nearest && least <= 2) return start + "; nearest known: -" + nearest->name + " (" + nearest->accepted + ")" + end;
  if (const std::string why = not_supported(plain); !why.empty()) return start + ": " + why;
  if (const std::string species = missing_species(name); !species.empty())
    return start + ": -species does not list " + species + end;
  for (const std::string &petsc : petsc_option_names())
    if (petsc.back() != '_' && edit_distance(plain, petsc) <= 2) return start + "; nearest known: -" + petsc + end;
  if (nearest) return start + "; nearest known: -" + nearest->name + " (" + nearest->accepted + ")" + end;
  return start + end;
}

}  // namespace eulastic
