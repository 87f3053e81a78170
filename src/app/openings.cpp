#include "app/openings.hpp"

#include "app/inflow_balance.hpp"
#include "app/option_values.hpp"
#include "app/time_tables.hpp"
#include "base/number_rows.hpp"
#include "base/rank_zero.hpp"
#include "field/open_sides.hpp"
#include "io/hdf5_input.hpp"
#include "io/profile_file.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

std::string name_of(int d, int high) { return std::string{"xyz"[d]} + (high ? "max" : "min"); }

std::size_t cells_of_side(const Config &config, int d) {
  std::size_t cells = 1;
  for (int e = 0; e < 3; ++e)
    if (e != d) cells *= std::size_t(config.grid.cells[e]);
  return cells;
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
  static const RowFormat format{"uniform, developed, or a file of numbers", {}, {}};
  std::string text, wrong, file, dataset;
  const bool hdf5 = on_rank_0([&] {
    split_dataset(spec.profile, &file, &dataset);
    return is_hdf5(file);
  });
  if (hdf5) {
    const Int3 &n = config.grid.cells;
    wrong = on_rank_0([&] {
      return read_profile_file(file, dataset, d == 2 ? n[1] : n[2], d == 0 ? n[1] : n[0], d, high ? -1 : 1, profile);
    });
    share(profile);
  } else if (read_file(spec.profile, &text)) {
    wrong = read_rows(spec.profile, text, format, [&](const std::vector<double> &row) {
      profile->insert(profile->end(), row.begin(), row.end());
      return std::string();
    });
  } else {
    wrong = "cannot read " + spec.profile + "; accepted: " + format.expected;
  }
  if (!wrong.empty()) return wrong;
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
  const std::string option = name + (flow ? "_flow_rate" : "_velocity");
  const std::string &text = flow ? spec.flow_rate : spec.velocity;
  if (!text.empty())
    if (std::string wrong = read_course(text, &course); !wrong.empty()) return option + ": " + wrong;
  if (!course.table.empty() && (spec.frequency != 0 || spec.phase != 0))
    return name + "_frequency: has no meaning beside a table; accepted: 0, and phase 0";
  if (std::string wrong = extend_table(spec, name, option, text, config.time.end, &course); !wrong.empty())
    return wrong;
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

// A capacity that is 0, or drained by nothing, holds no pressure of its own: the limits of small ones.
std::string resolve_load(const OpeningSpec &spec, const std::string &name, OutletLoad *load) {
  const auto &[first, capacity, second] = spec.windkessel;
  const bool holds = capacity > 0 && second > 0;
  if (!holds && spec.windkessel_start != 0)
    return name + "_windkessel_start: there is no capacity that a resistance drains; accepted: 0, or with both in " +
           name + "_windkessel";
  if (spec.resistance > 0 && spec.windkessel != Real3{})
    return name + "_resistance: given beside " + name + "_windkessel; accepted: one of them";
  *load = {spec.resistance + first, 0, 0, 0};
  if (holds) *load = {first, capacity, second, spec.windkessel_start};
  if (capacity == 0) load->resistance += second;
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
      const std::string name = "-pressure_" + name_of(d, high);
      if (std::string wrong = resolve_load(spec, name, &side.load); !wrong.empty()) return wrong;
      if (!spec.table.empty())
        if (std::string wrong = read_table(spec.table, &side.given); !wrong.empty()) return name + "_table: " + wrong;
      if (std::string wrong = extend_table(spec, name, name + "_table", spec.table, config->time.end, &side.given);
          !wrong.empty())
        return wrong;
    }
  return opens(config->sides) ? std::string() : check_inflow_balance(*config);
}

}  // namespace eulastic
