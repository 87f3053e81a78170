// Cosines of different frequencies and piecewise linear functions are linearly independent on any interval: the flow
// rates cancel at every time if the cosines of each frequency cancel, and the tables cancel at each of their rows.
#include "scene/inflow_balance.hpp"

#include "io/option_values.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>

namespace eulastic {
namespace {

constexpr double round_off = 1e-12;  // of the largest flow rate
constexpr double most_times = 1e6;   // of a table that repeats

struct Inflow {
  const TimeCourse *course;
  double area;
  bool oscillates() const { return course->table.empty() && course->frequency > 0; }
};

// Times of all rows, from the start to the last row of the tables that do not repeat, and for the sum of the periods of
// those that do: a sum of functions with these periods that vanishes for so long vanishes always.
std::vector<double> row_times(const std::vector<Inflow> &inflows, double end) {
  double last = 0, periods = 0;
  for (const auto &[course, area] : inflows) {
    periods += course->period;
    if (!course->table.empty() && course->period == 0) last = std::max(last, course->table.back()[0]);
  }
  const double horizon = std::min(end, last + periods);
  std::vector<double> times{0, horizon};
  for (const auto &[course, area] : inflows)
    for (const auto &row : course->table) {
      const double period = course->period, first = period > 0 ? std::ceil(-row[0] / period) : 0;
      const double beats = period > 0 ? std::min((horizon - row[0]) / period, first + most_times) : 0;
      for (double beat = first; beat <= beats; ++beat)
        if (const double time = row[0] + beat * period; time >= 0 && time <= horizon) times.push_back(time);
    }
  std::sort(times.begin(), times.end());
  return times;
}

// Of the flow rate, per relative error of the time.
double steepness(const Inflow &inflow) {
  double most = 0;
  const auto &table = inflow.course->table;
  for (std::size_t n = 1; n < table.size(); ++n)
    most = std::max(most, std::fabs((table[n][1] - table[n - 1][1]) / (table[n][0] - table[n - 1][0])));
  if (inflow.course->period > 0) most = std::max(most, std::fabs(inflow.course->rate(table.back()[0])));
  return most * inflow.area;
}

}  // namespace

std::string check_inflow_balance(const Config &config) {
  std::vector<Inflow> inflows;
  std::string names;
  for (int d = 0; d < 3; ++d)
    for (int high = 0; high < 2; ++high) {
      if (config.sides[d][high].kind != BoundaryKind::inflow) continue;
      inflows.push_back({&config.sides[d][high].given, config.grid.side_area(d)});
      names += (names.empty() ? "-boundary_" : ", -boundary_") + side_name(d, high);
    }
  const std::string way_out =
      " and cannot leave the box; accepted: a pressure or outflow boundary, or inflow boundaries whose flow rates have "
      "the sum 0 at every time";
  double largest = 0, slope = 0;
  std::map<double, std::complex<double>> cosines;
  for (const Inflow &inflow : inflows) {
    const TimeCourse &course = *inflow.course;
    largest = std::max(largest, course.largest() * inflow.area);
    slope = std::max(slope, steepness(inflow));
    if (inflow.oscillates()) cosines[course.frequency] += std::polar(1.0, course.phase) * course.value * inflow.area;
  }
  for (const auto &[frequency, sum] : cosines)
    if (std::abs(sum) > round_off * largest)
      return names + ": up to " + to_text(std::abs(sum)) + " volume/time enters at the angular frequency " +
             to_text(frequency) + way_out;
  for (const double time : row_times(inflows, config.time.end)) {
    double sum = 0;
    for (const Inflow &inflow : inflows)
      if (!inflow.oscillates()) sum += inflow.course->at(time) * inflow.area;
    if (std::fabs(sum) > round_off * (largest + slope * time))
      return names + ": " + to_text(sum) + " volume/time enters at time " + to_text(time) + way_out;
  }
  return {};
}

}  // namespace eulastic
