#include "output/checkpoint_range.hpp"

#include "boxes/free_bodies.hpp"
#include "field/surface_marker.hpp"
#include "io/option_values.hpp"

#include <cmath>
#include <set>

namespace eulastic {
namespace {

constexpr double most = 1e15;  // of what is counted: doubles still tell such numbers apart

std::string invalid(const std::string &name, double value, const std::string &accepted) {
  return name + " holds " + to_text(value) + "; accepted: " + accepted;
}

bool is_within(double value, double low, double high) { return value >= low && value <= high; }  // false for a NaN

}  // namespace

std::string find_invalid_number(const CheckpointNumbers &numbers) {
  static const std::set<std::string> never_negative{"time",         "time_step", "flow_scales",
                                                    "wall_seconds", "mach_max",  "pressure_interval"};
  for (const auto &[name, values] : numbers.reals)
    for (const double value : values) {
      if (!std::isfinite(value)) return invalid(name, value, "a finite number");
      if (never_negative.count(name) > 0 && value < 0) return invalid(name, value, "a number >= 0");
    }
  for (const auto &[name, values] : numbers.integers)
    if (std::string wrong = find_invalid_count(name, values); !wrong.empty()) return wrong;
  const double time = numbers.reals.at("time")[0], dt = numbers.reals.at("time_step")[0];
  const double step = double(numbers.integers.at("step")[0]);
  if (step > 0 && !(time > 0)) return invalid("time", time, "after a step a number > 0");
  if (step > 0 && !(dt > 0 && dt <= time * (1 + 1e-9)))
    return invalid("time_step", dt, "after a step a number > 0, at most the time " + to_text(time));
  return {};
}

std::string find_invalid_count(const std::string &name, const std::vector<long> &values) {
  for (const long value : values)
    if (!is_within(double(value), 0, most)) return invalid(name, double(value), "0 ... " + to_text(most));
  return {};
}

std::string find_invalid_count(const std::string &name, const std::vector<double> &values) {
  for (const double value : values)
    if (!is_within(value, 0, 1e9) || value != std::floor(value)) return invalid(name, value, "whole numbers from 0 on");
  return {};
}

std::string find_invalid_link(const std::vector<long> &like, int placed) {
  for (std::size_t n = 0; n < like.size(); ++n)
    if (!is_within(double(like[n]), 1, placed + double(n)))
      return invalid("bodies_like", double(like[n]), "the label of an earlier body");
  return {};
}

std::string find_invalid_body(const std::vector<long> &cells, const std::vector<double> &first_volumes) {
  for (const long cell : cells)
    if (!is_within(double(cell), -1e9, 1e9)) return invalid("the cell of a body", double(cell), "-1e9 ... 1e9");
  for (const double volume : first_volumes)
    if (!(volume >= 0 && std::isfinite(volume)))
      return invalid("the first volume of a body", volume, "a finite number >= 0");
  return {};
}

std::string find_invalid_generator(const std::vector<long> &inside, int generators) {
  for (const long which : inside)
    if (!is_within(double(which), 0, generators))
      return invalid("bodies_in_feeders", double(which), "0 ... " + to_text(generators));
  return {};
}

std::string find_invalid_box(const std::vector<double> &heads, const Box &domain, const BodyTracker &bodies,
                             const std::vector<Phase> &phases) {
  const std::string name = "bodies_in_boxes";
  for (std::size_t n = 0; n < heads.size(); n += FreeBodies::head) {
    const double *head = &heads[n], number = head[0], species = head[1];
    for (int part = 0; part < FreeBodies::head; ++part)
      if (!is_within(head[part], -1e9, 1e9) || head[part] != std::floor(head[part]))
        return invalid(name, head[part], "whole numbers");
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
  for (std::size_t n = 0; n < packed.size(); ++n) {
    const double value = packed[n];
    const std::size_t part = n % SurfaceMarker::numbers;
    if (!std::isfinite(value)) return invalid(name, value, "a finite number");
    if (part == 0 && !is_within(value, 0, most)) return invalid(name, value, "numbers from 0 on");
    if (part == 1 && !is_within(value, 0, bodies)) return invalid(name, value, "the label of a body");
    if (part == 2 && !is_within(value, 0, phases - 1)) return invalid(name, value, "the number of a phase");
    if (part >= 3 && part < 6 && !is_within(value, block.begin[part - 3], block.end[part - 3] - 1))
      return invalid(name, value, "a cell of the box");
    if (part >= 6 && part < 9 && !is_within(value, -1, 1)) return invalid(name, value, "a position within its cell");
  }
  return {};
}

std::string find_invalid_receptor(const std::vector<double> &packed, int bodies, int pairs) {
  const std::string name = "receptors_in_boxes";
  for (std::size_t n = 0; n < packed.size(); n += Receptor::numbers) {
    for (int part = 0; part < Receptor::numbers; ++part)
      if (!std::isfinite(packed[n + part])) return invalid(name, packed[n + part], "a finite number");
    const Receptor receptor = Receptor::unpacked(&packed[n]);
    if (!is_within(receptor.partner, Receptor::none, bodies))
      return invalid(name, receptor.partner, "the label of a body");
    if (!is_within(receptor.other, 0, 1e9)) return invalid(name, receptor.other, "the number of a receptor");
    if (!is_within(receptor.pair, 0, pairs - 1)) return invalid(name, receptor.pair, "the number of a pair");
  }
  return {};
}

}  // namespace eulastic
