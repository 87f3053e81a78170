#include "app/openings.hpp"

#include "app/option_values.hpp"
#include "base/rank_zero.hpp"
#include "field/open_sides.hpp"
#include "io/profile_file.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace eulastic {
namespace {

std::string name_of(int d, int high) { return std::string{"xyz"[d]} + (high ? "max" : "min"); }

// Numbers of a text, whatever separates them; # starts a comment.
std::string read_numbers(const std::string &path, const std::string &text, std::vector<std::vector<double>> *rows) {
  std::string line;
  std::istringstream file(text);
  for (int number = 1; std::getline(file, line); ++number) {
    line.erase(std::min(line.find('#'), line.size()));
    std::replace_if(
        line.begin(), line.end(), [](char c) { return c == ',' || c == '\r' || c == '\t'; }, ' ');
    std::istringstream words(line);
    std::vector<double> row;
    for (std::string word; words >> word;) {
      double value;
      if (const std::string wrong = read_reals(word, any_number, &value, 1); !wrong.empty())
        return path + " line " + std::to_string(number) + ": " + wrong;
      row.push_back(value);
    }
    if (!row.empty()) rows->push_back(row);
  }
  return rows->empty() ? path + " holds no numbers" : std::string();
}

std::string read_table(const std::string &path, TimeCourse *course) {
  std::vector<std::vector<double>> rows;
  std::string text;
  std::string wrong = read_file(path, &text) ? read_numbers(path, text, &rows) : "cannot read " + path;
  if (!wrong.empty()) return wrong + "; accepted: rows time,value";
  for (const std::vector<double> &row : rows) {
    if (row.size() != 2) return path + ": a row has " + std::to_string(row.size()) + " numbers; accepted: time,value";
    if (!course->table.empty() && !(row[0] > course->table.back()[0]))
      return path + ": time " + to_text(row[0]) + " does not come after the one before; accepted: ascending times";
    course->table.push_back({row[0], row[1]});
  }
  return {};
}

// A number, or a table.
std::string read_course(const std::string &text, TimeCourse *course) {
  double value;
  if (read_reals(text, any_number, &value, 1).empty()) {
    course->value = value;
    return {};
  }
  return read_table(text, course);
}

std::size_t cells_of_side(const Config &config, int d) {
  std::size_t cells = 1;
  for (int e = 0; e < 3; ++e)
    if (e != d) cells *= std::size_t(config.grid.cells[e]);
  return cells;
}

// In 2-D a length.
double area_of_side(const Config &config, int d) {
  double area = 1;
  for (int e = 0; e < (config.grid.cells[2] == 1 ? 2 : 3); ++e)
    if (e != d) area *= config.grid.length[e];
  return area;
}

// Makes the mean 1; returns what it was.
double make_mean_one(SideProfile *profile) {
  double sum = 0;
  for (const double value : *profile) sum += value;
  const double mean = sum / double(profile->size());
  for (double &value : *profile) value /= mean;
  return mean;
}

std::string read_profile(const Config &config, int d, int high, SideProfile *profile, double *mean) {
  const OpeningSpec &spec = config.openings[d][high];
  std::vector<std::vector<double>> rows;
  std::string text, wrong;
  if (!read_file(spec.profile, &text)) {
    wrong = "cannot read " + spec.profile;
  } else if (is_hdf5(text)) {
    const Int3 &n = config.grid.cells;
    wrong = on_rank_0([&] {
      return read_profile_file(spec.profile, d == 2 ? n[1] : n[2], d == 0 ? n[1] : n[0], d, high ? -1 : 1, profile);
    });
    if (!wrong.empty()) return wrong;
    share(profile);
  } else {
    wrong = read_numbers(spec.profile, text, &rows);
  }
  if (!wrong.empty()) return wrong + "; accepted: uniform, developed, or a file of numbers";
  for (const std::vector<double> &row : rows) profile->insert(profile->end(), row.begin(), row.end());
  const std::size_t cells = cells_of_side(config, d);
  if (profile->size() != cells)
    return spec.profile + " has " + std::to_string(profile->size()) + " numbers; accepted: one per cell of the side, " +
           std::to_string(cells);
  *mean = make_mean_one(profile);
  if (!std::isfinite(1 / *mean)) return spec.profile + ": its mean is 0; accepted: a flow into the box";
  return {};
}

std::string resolve_inflow(const Config &config, int d, int high, Side *side) {
  const OpeningSpec &spec = config.openings[d][high];
  const std::string name = "-inflow_" + name_of(d, high);
  if (!spec.velocity.empty() && !spec.flow_rate.empty())
    return name + "_flow_rate: given beside " + name + "_velocity; accepted: one of them";
  SideProfile profile;
  double mean = 1;
  if (spec.from_file())
    if (std::string wrong = read_profile(config, d, high, &profile, &mean); !wrong.empty())
      return name + "_profile: " + wrong;
  side->profile = std::make_shared<const SideProfile>(std::move(profile));
  const bool flow = !spec.flow_rate.empty();
  if (!flow && spec.velocity.empty() && !spec.from_file())
    return name + "_velocity: must be given, or " + name + "_flow_rate; accepted: a number, or a table";
  TimeCourse &course = side->given;
  course = {mean, spec.frequency, spec.phase, {}};
  if (const std::string &text = flow ? spec.flow_rate : spec.velocity; !text.empty())
    if (std::string wrong = read_course(text, &course); !wrong.empty())
      return name + (flow ? "_flow_rate: " : "_velocity: ") + wrong;
  if (!course.table.empty() && (spec.frequency != 0 || spec.phase != 0))
    return name + "_frequency: has no meaning beside a table; accepted: 0, and phase 0";
  if (flow) {
    const double area = area_of_side(config, d);
    course.value /= area;
    for (auto &row : course.table) row[1] /= area;
  }
  return {};
}

std::string resolve_feeder(const Config &config, int d, int high, Side *side) {
  const double length = config.openings[d][high].feeder, h = config.grid.length[d] / config.grid.cells[d];
  constexpr int least = 8, left = 8;  // cells
  if (length == 0) return {};
  const std::string name = "-inflow_" + name_of(d, high) + "_feeder: ";
  const double cells = std::round(length / h), most = config.grid.cells[d] - left;
  if (cells < least || cells > most)
    return name + to_text(length) + " is " + to_text(length / h) + " cells; accepted: from " + to_text(least) + " to " +
           to_text(most) + " of the " + to_text(config.grid.cells[d]) + " along the box";
  if (std::fabs(length / h - cells) > 1e-6 * cells)
    return name + to_text(length) + " is " + to_text(length / h) + " cells; accepted: a whole number, such as " +
           to_text(cells * h);
  if (!config.species.empty() && !config.body_series)
    return name + "bodies that come in need names; accepted: -body_series true";
  side->feeder = static_cast<int>(cells);
  return {};
}

std::string resolve_load(const OpeningSpec &spec, const std::string &name, OutletLoad *load) {
  const auto &[first, capacity, second] = spec.windkessel;
  *load = {spec.resistance, 0, 0, 0};
  if (spec.windkessel == Real3{})
    return spec.windkessel_start == 0
               ? ""
               : name + "_windkessel_start: there is no Windkessel; accepted: 0, or with " + name + "_windkessel";
  if (spec.resistance > 0) return name + "_resistance: given beside " + name + "_windkessel; accepted: one of them";
  if (!(capacity > 0 && second > 0))
    return name + "_windkessel: capacity and second resistance must be > 0; accepted: R,C,R, or 0,0,0";
  *load = {first, capacity, second, spec.windkessel_start};
  return {};
}

// Without an open side what comes in must go out at the same time.
std::string check_balance(const Config &config) {
  std::vector<double> times{0};
  std::string names;
  double largest = 0;
  const auto each = [&](auto visit) {
    for (int d = 0; d < 3; ++d)
      for (int high = 0; high < 2; ++high)
        if (config.sides[d][high].kind == SideKind::inflow) visit(config.sides[d][high].given, d, high);
  };
  each([&](const TimeCourse &course, int d, int high) {
    for (const auto &row : course.table) times.push_back(row[0]);
    for (int eighth = 1; eighth < 8 && course.frequency > 0; ++eighth)
      times.push_back(eighth * M_PI / 4 / course.frequency);
    names += (names.empty() ? "-boundary_" : ", -boundary_") + name_of(d, high);
    largest = std::max(largest, course.largest() * area_of_side(config, d));
  });
  for (const double time : times) {
    double sum = 0;
    each([&](const TimeCourse &course, int d, int) { sum += course.at(time) * area_of_side(config, d); });
    if (std::fabs(sum) > 1e-12 * largest)
      return names + ": " + to_text(sum) + " volume/time comes in at time " + to_text(time) +
             " and has no way out; accepted: a pressure or outflow side, or inflow sides whose flow rates have the sum "
             "0";
  }
  return {};
}

}  // namespace

std::string resolve_openings(Config *config) {
  for (int d = 0; d < 3; ++d)
    for (int high = 0; high < 2; ++high) {
      Side &side = config->sides[d][high];
      const bool bounded = config->boundary.bounded(d);
      side.kind = bounded ? config->boundary.kind(d, high) : SideKind::wall;
      config->grid.open[d][high] = bounded && is_open(side.kind);
      if (side.kind == SideKind::inflow)
        for (const auto resolve : {resolve_inflow, resolve_feeder})
          if (std::string wrong = resolve(*config, d, high, &side); !wrong.empty()) return wrong;
      if (side.kind != SideKind::pressure) continue;
      const OpeningSpec &spec = config->openings[d][high];
      side.given = {spec.value, 0, 0, {}};
      if (std::string wrong = resolve_load(spec, "-pressure_" + name_of(d, high), &side.load); !wrong.empty())
        return wrong;
      if (spec.table.empty()) continue;
      if (std::string wrong = read_table(spec.table, &side.given); !wrong.empty())
        return "-pressure_" + name_of(d, high) + "_table: " + wrong;
    }
  return opens(config->sides) ? std::string() : check_balance(*config);
}

}  // namespace eulastic
