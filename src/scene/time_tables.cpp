#include "scene/time_tables.hpp"

#include "base/number_rows.hpp"
#include "base/rank_zero.hpp"
#include "io/option_values.hpp"

#include <cmath>

namespace eulastic {
namespace {

constexpr double round_off = 1e-9;  // of times and values that a text gives with some ten digits

// `source`: what gives the period, for messages.
std::string repeat(const std::string &source, double period, TimeCourse *course) {
  auto &table = course->table;
  const double length = table.back()[0] - table.front()[0];
  if (length > period * (1 + round_off))
    return source + ": " + to_text(period) + " is shorter than the table, whose times go from " +
           to_text(table.front()[0]) + " to " + to_text(table.back()[0]) + "; accepted: " + to_text(length) +
           " or longer";
  if (length >= period * (1 - round_off)) {  // the last row is the first one of the next period
    const double first = table.front()[1], last = table.back()[1];
    if (std::fabs(last - first) > round_off * course->largest())
      return source + ": the table ends with " + to_text(last) + " and begins again with " + to_text(first) +
             "; accepted: the same value, or a period that is longer than the table";
    table.pop_back();
  }
  course->period = period;
  return {};
}

std::string read_table(const std::string &path, TimeCourse *course) {
  static const RowFormat format{"rows of time,value", {"time", "value"}, {2}, false, "period"};
  std::string text;
  if (!read_file(path, &text)) return "cannot read " + path + "; accepted: " + format.expected;
  const auto add_row = [&](const std::vector<double> &row) {
    if (!course->table.empty() && !(row[0] > course->table.back()[0]))
      return "time " + to_text(row[0]) + " does not come after the one before; times must be ascending";
    course->table.push_back({row[0], row[1]});
    return std::string();
  };
  return read_rows(path, text, format, add_row, &course->period);
}

}  // namespace

std::string read_course(const std::string &text, TimeCourse *course) {
  double value;
  if (read_reals(text, any_number, &value, 1).empty()) {
    course->value = value;
    return {};
  }
  return read_table(text, course);
}

std::string extend_table(const OpeningSpec &spec, const std::string &side, const std::string &option,
                         const std::string &file, double end, TimeCourse *course) {
  if (course->table.empty()) {
    if (spec.period == 0 && !spec.hold) return {};
    return side + (spec.hold ? "_table_hold" : "_table_period") + ": applies only to a table; accepted: with a table";
  }
  if (spec.hold && spec.period > 0)
    return side + "_table_hold: given beside " + side + "_table_period; accepted: one of them";
  const std::string own = file + " says \"# period " + to_text(course->period) + "\"";
  if (spec.hold && course->period > 0)
    return side + "_table_hold: " + own + " and cannot be held, too; accepted: false, or a table without a period";
  if (spec.hold) return {};
  if (spec.period > 0 && course->period > 0 && std::fabs(spec.period / course->period - 1) > round_off)
    return side + "_table_period: " + to_text(spec.period) + ", but " + own + "; accepted: the same, or one of them";
  if (spec.period > 0) return repeat(side + "_table_period", spec.period, course);
  if (course->period > 0) return repeat(option + ": the period of " + file, course->period, course);
  const double first = course->table.front()[0], last = course->table.back()[0];
  if (first <= 0 && last >= end * (1 - round_off)) return {};
  return option + ": " + file + " goes from time " + to_text(first) + " to " + to_text(last) + ", the run from 0 to " +
         to_text(end) + "; accepted: a table of all the run, " + side +
         "_table_period to repeat it (in the file: # period T), or " + side +
         "_table_hold true to hold its first and its last value";
}

}  // namespace eulastic
