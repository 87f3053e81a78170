#include "output/checkpoint_range.hpp"

#include "boxes/free_bodies.hpp"
#include "field/surface_marker.hpp"
#include "io/option_values.hpp"

#include <cmath>
#include <limits>
#include <set>

namespace eulastic {
namespace {

std::string invalid(const std::string &name, double value, const std::string &accepted) {
  return name + " holds " + to_text(value) + "; accepted: " + accepted;
}

bool is_within(double value, double low, double high) { return value >= low && value <= high; }  // false for a NaN

constexpr double largest = std::numeric_limits<double>::max();
const Accepted finite{-largest, largest, "a finite number"};

}  // namespace

const Accepted any_count{0, 1e15, "0 ... 1e+15"};

std::string find_invalid(const std::string &name, const std::vector<double> &values,
                         const std::vector<Accepted> &accepted) {
  for (std::size_t n = 0; n < values.size(); ++n) {
    const Accepted &range = accepted[n % accepted.size()];
    if (!is_within(values[n], range.low, range.high) || (range.whole && values[n] != std::floor(values[n])))
      return invalid(name, values[n], range.words);
  }
  return {};
}

std::string find_invalid(const std::string &name, const std::vector<long> &values, const Accepted &accepted) {
  return find_invalid(name, std::vector<double>(values.begin(), values.end()), {accepted});
}

std::string find_invalid_number(const CheckpointNumbers &numbers) {
  static const std::set<std::string> never_negative{"time",     "time_step",         "flow_scales",   "wall_seconds",
                                                    "mach_max", "pressure_interval", "energy_largest"};
  const Accepted zero_or_more{0, largest, "a number >= 0"};
  std::string wrong;
  for (const auto &[name, values] : numbers.reals) {
    if (wrong.empty()) wrong = find_invalid(name, values, {finite});
    if (wrong.empty() && never_negative.count(name) > 0) wrong = find_invalid(name, values, {zero_or_more});
  }
  for (const auto &[name, values] : numbers.integers)
    if (wrong.empty()) wrong = find_invalid(name, values, any_count);
  if (!wrong.empty()) return wrong;
  const double time = numbers.reals.at("time")[0], dt = numbers.reals.at("time_step")[0];
  const double step = double(numbers.integers.at("step")[0]);
  if (step > 0 && !(time > 0)) return invalid("time", time, "after a step a number > 0");
  if (step > 0 && !(dt > 0 && dt <= time * (1 + 1e-9)))
    return invalid("time_step", dt, "after a step a number > 0, at most the time " + to_text(time));
  return {};
}

std::string find_invalid_link(const std::vector<long> &like, int placed) {
  for (std::size_t n = 0; n < like.size(); ++n)
    if (!is_within(double(like[n]), 1, placed + double(n)))
      return invalid("bodies_like", double(like[n]), "the label of an earlier body");
  return {};
}

std::string find_invalid_box(const std::vector<double> &heads, const Box &domain, const BodyTracker &bodies,
                             const std::vector<Phase> &phases) {
  const std::string name = "bodies_in_boxes";
  if (std::string wrong = find_invalid(name, heads, {{-1e9, 1e9, "whole numbers", true}}); !wrong.empty()) return wrong;
  for (std::size_t n = 0; n < heads.size(); n += FreeBodies::head) {
    const double *head = &heads[n], number = head[0], species = head[1];
    if (!is_within(number, 1, bodies.bodies())) return invalid(name, number, "the label of a body");
    if (species != bodies.species(static_cast<int>(number)) || !phases[static_cast<int>(species)].boxed)
      return invalid(name, species, "the number of the species of body " + to_text(number));
    double cells = 1;
    for (int d = 0; d < 3; ++d) {
      const double begin = head[2 + d], length = head[5 + d], N = domain.domain_cells()[d];
      const bool bounded = domain.is_wall(d) || d >= domain.dimension();
      if (!(length >= 1) || (bounded && !(begin >= 0 && begin + length <= N)))
        return invalid(name, length, "a block of the domain's cells");
      cells *= length;
    }
    if (cells > 1e9) return invalid(name, cells, "at most 1e9 cells in a box");
    if (!is_within(head[8], 0, cells)) return invalid(name, head[8], "at most one marker in a cell");
  }
  return {};
}

std::string find_invalid_marker(const std::vector<double> &packed, const Extent &block, int bodies, int phases) {
  const std::string name = "membrane_markers";
  std::vector<Accepted> parts(SurfaceMarker::numbers, finite);
  parts[0] = {0, any_count.high, "numbers from 0 on"};
  parts[1] = {0, double(bodies), "the label of a body"};
  parts[2] = {0, phases - 1., "the number of a phase"};
  for (int d = 0; d < 3; ++d) {
    parts[3 + d] = {double(block.begin[d]), block.end[d] - 1., "a cell of the box"};
    parts[6 + d] = {-1, 1, "a position within its cell"};
  }
  const std::string wrong = find_invalid(name, packed, {finite});
  return wrong.empty() ? find_invalid(name, packed, parts) : wrong;
}

std::string find_invalid_receptor(const std::vector<double> &packed, int bodies, int pairs) {
  const std::string name = "receptors_in_boxes";
  std::vector<Accepted> parts(Receptor::numbers, finite);
  parts[3] = {Receptor::none, double(bodies), "the label of a body"};
  parts[4] = {0, 1e9, "the number of a receptor"};
  parts[5] = {0, pairs - 1., "the number of a pair"};
  const std::string wrong = find_invalid(name, packed, {finite});
  return wrong.empty() ? find_invalid(name, packed, parts) : wrong;
}

}  // namespace eulastic
