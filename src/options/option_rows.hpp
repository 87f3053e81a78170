// Makes rows of the option table from members of a Config: the type of the member determines kind, number of values,
// parsing and printing.
#pragma once

#include "io/option_values.hpp"
#include "options/option_table.hpp"
#include "scene/config.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <type_traits>

namespace eulastic {

using Names = std::vector<std::string>;

/// For Option::names_file of an option whose every value is a path.
inline bool any_file(const std::string &) { return true; }

inline std::string several(std::size_t count, const std::string &noun, const Range &range) {
  return (count == 1 ? (noun[0] == 'i' ? "an " : "a ") + noun : std::to_string(count) + " " + noun + "s") +
         range.text() + (count == 1 ? "" : ", separated by commas");
}

/// "1,2,3".
template <class T>
std::string list(const T *values, std::size_t count) {
  Names items;
  for (std::size_t i = 0; i < count; ++i)
    if constexpr (std::is_integral_v<T>)
      items.push_back(std::to_string(values[i]));
    else
      items.push_back(to_text(values[i]));
  return join(items, ",");
}

// Makes rows from members.
class Rows {
public:
  std::vector<Option> rows;
  // What the rows that follow have in common:
  std::string group, prefix;
  bool may_change = false;  ///< between a checkpoint and the run that continues from it

  /// The rows that follow apply only while `applies` holds, which `only_with` says.
  void limit(const std::string &only_with, const std::function<bool()> &applies) {
    only_with_ = only_with;
    applies_ = applies;
  }
  /// The rows that follow apply only while `target` has one of the `wanted` values. `names`: values of `-option`.
  template <class T>
  void restrict(const std::string &option, T &target, const Names &names, const std::vector<T> &wanted) {
    Names text;
    for (T value : wanted) text.push_back(names[static_cast<int>(value)]);
    limit("-" + option + " " + join(text, " or "),
          [&target, wanted] { return std::find(wanted.begin(), wanted.end(), target) != wanted.end(); });
  }
  /// The rows that follow always apply.
  void end_limit() { limit("", nullptr); }

  Option &add(const std::string &name, const std::string &unit, const std::string &doc) {
    Option option;
    option.group = group;
    option.name = prefix + name;
    option.unit = unit;
    option.doc = doc;
    option.may_change = may_change;
    option.only_with = only_with_;
    option.applies = applies_;
    rows.push_back(option);
    return rows.back();
  }
  /// T is double, int or long.
  template <class T>
  Option &numbers(const std::string &name, T *target, std::size_t count, const Range &range, const std::string &unit,
                  const std::string &doc) {
    Option &row = add(name, unit, doc);
    row.accepted = several(count, std::is_integral_v<T> ? "integer" : "number", range);
    row.read = [=](const std::string &value) { return read_numbers(value, range, target, count); };
    row.text = [=] { return list(target, count); };
    return row;
  }
  Option &real(const std::string &name, double &target, const Range &range, const std::string &unit,
               const std::string &doc) {
    return numbers(name, &target, 1, range, unit, doc);
  }
  template <std::size_t N>
  Option &real(const std::string &name, std::array<double, N> &target, const Range &range, const std::string &unit,
               const std::string &doc) {
    return numbers(name, target.data(), N, range, unit, doc);
  }
  /// The rows of cos(angular_frequency t + phase), which multiplies a quantity.
  void oscillation(const std::string &start, double &frequency, double &phase, const std::string &of_what = {}) {
    real(start + "angular_frequency", frequency, not_negative, "rad/time",
         "angular frequency of the oscillation" + of_what + "; 0: steady");
    real(start + "phase", phase, any_number, "rad", "phase of the oscillation" + of_what + " at t = 0");
  }
  template <class T>
  Option &integer(const std::string &name, T &target, const Range &range, const std::string &doc) {
    return numbers(name, &target, 1, range, "", doc);
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

  /// A member that may be unset, which has no text then. `add_row` adds the row of a value.
  template <class T, class AddRow>
  Option &optional(std::optional<T> &target, const AddRow &add_row) {
    const auto value = std::make_shared<T>();
    Option &row = add_row(*value);
    row.read = [read = row.read, value, &target](const std::string &text) {
      std::string wrong = read(text);
      if (wrong.empty()) target = *value;
      return wrong;
    };
    row.text = [text = row.text, value, &target] {
      if (!target) return std::string();
      *value = *target;
      return text();
    };
    return row;
  }

  /// The last row also accepts `word` for 0, and prints it.
  void zero_is(const std::string &word) {
    Option &row = rows.back();
    const std::size_t range = row.accepted.find(" >= 0");
    if (range != std::string::npos) row.accepted.replace(range, 5, " > 0");
    row.accepted = word + ", or " + row.accepted;
    row.read = [read = row.read, word](const std::string &value) { return read(value == word ? "0" : value); };
    row.text = [text = row.text, word] { return text() == "0" ? word : text(); };
  }

private:
  std::string only_with_;
  std::function<bool()> applies_;
};

/// Pairs that -adhesion names, of species that are known. Returns what is wrong, or nothing.
std::string read_adhesion(const std::string &value, Config *config);
void add_adhesion(Rows &rows, Config &config);

/// The name of the species is the prefix. With `from_state` the shape need not be given.
void add_species_rows(Rows &rows, SpeciesSpec &spec, bool from_state);

/// Kinds of all boundaries, and what is prescribed on them.
void add_boundaries(Rows &rows, Config &config);

}  // namespace eulastic
