// Makes rows of the option table from members of a Config: the type of the member determines kind, number of values,
// parsing and printing.
#pragma once

#include "io/option_values.hpp"
#include "options/option_table.hpp"
#include "scene/config.hpp"

#include <algorithm>

namespace eulastic {

using Names = std::vector<std::string>;

/// For Option::names_file of an option whose every value is a path.
inline bool any_file(const std::string &) { return true; }

inline std::string several(std::size_t count, const std::string &noun, const Range &range) {
  return (count == 1 ? (noun[0] == 'i' ? "an " : "a ") + noun : std::to_string(count) + " " + noun + "s") +
         range.text() + (count == 1 ? "" : ", separated by commas");
}

/// "1,2,3" of so many values.
template <class T, class Text>
std::string list(const T *values, std::size_t count, const Text &text) {
  Names items;
  for (std::size_t i = 0; i < count; ++i) items.push_back(text(values[i]));
  return join(items, ",");
}

// Makes rows from members.
class Rows {
public:
  std::vector<Option> rows;
  std::string group, prefix;

  Option &add(const std::string &name, const std::string &unit, const std::string &doc) {
    Option option;
    option.group = group;
    option.name = prefix + name;
    option.unit = unit;
    option.doc = doc;
    rows.push_back(option);
    return rows.back();
  }
  Option &reals(const std::string &name, double *target, std::size_t count, const Range &range, const std::string &unit,
                const std::string &doc) {
    Option &row = add(name, unit, doc);
    row.accepted = several(count, "number", range);
    row.read = [=](const std::string &value) { return read_reals(value, range, target, count); };
    row.text = [=] { return list(target, count, to_text); };
    return row;
  }
  Option &real(const std::string &name, double &target, const Range &range, const std::string &unit,
               const std::string &doc) {
    return reals(name, &target, 1, range, unit, doc);
  }
  template <std::size_t N>
  Option &real(const std::string &name, std::array<double, N> &target, const Range &range, const std::string &unit,
               const std::string &doc) {
    return reals(name, target.data(), N, range, unit, doc);
  }
  Option &integers(const std::string &name, int *target, std::size_t count, const Range &range,
                   const std::string &doc) {
    Option &row = add(name, "", doc);
    row.accepted = several(count, "integer", range);
    row.read = [=](const std::string &value) { return read_integers(value, range, target, count); };
    row.text = [=] { return list(target, count, [](int n) { return std::to_string(n); }); };
    return row;
  }
  Option &integer(const std::string &name, long &target, const Range &range, const std::string &doc) {
    Option &row = add(name, "", doc);
    row.accepted = several(1, "integer", range);
    row.read = [&target, range](const std::string &value) { return read_integer(value, range, &target); };
    row.text = [&target] { return std::to_string(target); };
    return row;
  }
  Option &boolean(const std::string &name, bool &target, const std::string &doc) {
    Option &row = add(name, "", doc);
    row.accepted = "true or false (also yes, no, 1, 0; alone it means true)";
    row.bare = true;
    row.read = [&target](const std::string &value) { return read_boolean(value, &target); };
    row.text = [&target] { return std::string(target ? "true" : "false"); };
    return row;
  }
  /// T is an enum, bool or int whose values count through `names`.
  template <class T>
  Option &choice(const std::string &name, T &target, const Names &names, const std::string &doc) {
    Option &row = add(name, "", doc);
    row.accepted = (names.size() > 1 ? "one of " : "") + join(names, ", ");
    row.read = [&target, names](const std::string &value) {
      int index = 0;
      std::string wrong = read_choice(value, names, &index);
      if (wrong.empty()) target = static_cast<T>(index);
      return wrong;
    };
    row.text = [&target, names] { return names[static_cast<int>(target)]; };
    return row;
  }
  Option &words(const std::string &name, Names &target, const Names &names, const std::string &doc) {
    Option &row = add(name, "", doc);
    row.accepted = "a list without spaces of " + join(names, ", ");
    row.read = [&target, names](const std::string &value) { return read_words(value, names, &target); };
    row.text = [&target] { return join(target, ","); };
    return row;
  }
  Option &path(const std::string &name, std::string &target, const std::string &doc) {
    Option &row = add(name, "", doc);
    row.accepted = "a path";
    row.read = [&target](const std::string &value) { return read_text(value, &target); };
    row.text = [&target] { return target; };
    return row;
  }

  /// Row r, or the last one, also accepts `word` for 0, and prints it.
  void zero_is(const std::string &word, std::size_t r) {
    Option &row = rows[r];
    const std::size_t range = row.accepted.find(" >= 0");
    if (range != std::string::npos) row.accepted.replace(range, 5, " > 0");
    row.accepted = word + ", or " + row.accepted;
    row.read = [read = row.read, word](const std::string &value) { return read(value == word ? "0" : value); };
    row.text = [text = row.text, word] { return text() == "0" ? word : text(); };
  }
  void zero_is(const std::string &word) { zero_is(word, rows.size() - 1); }

  /// The rows from `first` on may differ between a checkpoint and the run that continues from it.
  void allow_change(std::size_t first) {
    for (std::size_t r = first; r < rows.size(); ++r) rows[r].may_change = true;
  }

  /// The rows from `first` on apply only while `applies` holds, which `only_with` says.
  void limit(std::size_t first, const std::string &only_with, const std::function<bool()> &applies) {
    for (std::size_t r = first; r < rows.size(); ++r) {
      rows[r].only_with = only_with;
      rows[r].applies = applies;
    }
  }
  /// The rows from `first` on apply only while `target` has one of the `wanted` values. `names`: values of `-option`.
  template <class T>
  void restrict(std::size_t first, const std::string &option, T &target, const Names &names, std::vector<T> wanted) {
    Names text;
    for (T value : wanted) text.push_back(names[static_cast<int>(value)]);
    limit(first, "-" + option + " " + join(text, " or "),
          [&target, wanted] { return std::find(wanted.begin(), wanted.end(), target) != wanted.end(); });
  }
};

/// Pairs that -adhesion names, of species that are known. Returns what is wrong, or nothing.
std::string read_adhesion(const std::string &value, Config *config);
void add_adhesion(Rows &rows, Config &config);

/// The name of the species is the prefix. With `from_state` the shape need not be given.
void add_species_rows(Rows &rows, SpeciesSpec &spec, bool from_state);

/// Kinds of all boundaries, and what is prescribed on them.
void add_boundaries(Rows &rows, Config &config);

}  // namespace eulastic
