#include "scene/lumens.hpp"

#include "base/one_line.hpp"
#include "bodies/shapes.hpp"
#include "scene/open_parts.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

constexpr double least_cells = 8, most_reynolds = 1e4, round_off = 1e-9;

std::string number(double value, int digits = 4) { return print("%.*g", digits, value); }

// Smallest and largest prescribed volume per time of an inflow boundary.
std::array<double, 2> given_flow(const Config &config, int d, int high) {
  const bool mean_of_open = !config.openings[d][high].velocity.empty();
  const double area = config.grid.side_area(d) * (mean_of_open ? config.open_parts[d][high].share : 1);
  auto range = config.sides[d][high].given.range();
  for (double &value : range) value *= area;
  return range;
}

// A single open boundary carries the sum of all inflow; with several the split is unknown.
bool flow_through(const Config &config, int d, int high, std::array<double, 2> *range) {
  if (config.sides[d][high].kind == BoundaryKind::inflow) {
    *range = given_flow(config, d, high);
    return true;
  }
  int inlets = 0, outlets = 0;
  *range = {};
  for_crossed_sides(config, [&](int e, int end) {
    const bool inlet = config.sides[e][end].kind == BoundaryKind::inflow;
    (inlet ? inlets : outlets) += config.open_parts[e][end].share > 0;
    if (!inlet) return;
    const auto flow = given_flow(config, e, end);
    *range = {(*range)[0] - flow[1], (*range)[1] - flow[0]};
  });
  return inlets > 0 && outlets == 1;
}

double largest(const std::array<double, 2> &range) { return std::max(std::fabs(range[0]), std::fabs(range[1])); }

// The value of largest size, with its sign: what leaves through an outlet is negative.
double of_largest_size(const std::array<double, 2> &range) {
  return std::fabs(range[0]) > std::fabs(range[1]) ? range[0] : range[1];
}

double reynolds_number(const Config &config, int d, int high) {
  const OpenPart &part = config.open_parts[d][high];
  const double nu = config.fluid.kinematic_viscosity();
  std::array<double, 2> flow;
  if (nu == 0 || !std::isfinite(part.width) || !flow_through(config, d, high, &flow)) return 0;
  return largest(flow) / part.area * part.width / nu;
}

std::string side_line(const Config &config, int d, int high) {
  const OpenPart &part = config.open_parts[d][high];
  const BoundaryKind kind = config.sides[d][high].kind;
  const char *what = kind == BoundaryKind::inflow ? "inflow" : kind == BoundaryKind::pressure ? "pressure" : "outflow";
  std::string line = "boundary " + side_name(d, high) + ": " + what + ", open " +
                     (config.grid.dimension() == 2 ? "length " : "area ") + number(part.area) + " of " +
                     number(config.grid.side_area(d));
  if (part.lumens > 1) line += ", " + std::to_string(part.lumens) + " lumens, the widest";
  if (std::isfinite(part.width))
    line += std::string(part.lumens > 1 ? " " : ", lumen ") + number(part.width, 3) + " wide, " +
            number(part.cells, 3) + (part.lumens > 1 ? " cells across the narrowest" : " cells across");
  else
    line += part.lumens > 1 ? " without walls" : ", no walls";
  std::array<double, 2> flow;
  if (!flow_through(config, d, high, &flow)) return line + "; the flow through it is unknown";
  const std::string up_to = flow[0] == flow[1] ? "" : "up to ";
  const auto value = [&](double per) { return up_to + number(of_largest_size(flow) * per); };
  line += "; mean velocity " + value(1 / part.area) + ", flow rate " + value(1) + " into the box";
  if (const double reynolds = reynolds_number(config, d, high); reynolds > 0)
    line += ", Reynolds number of the lumen " + up_to + number(reynolds, 3);
  return line;
}

}  // namespace

double largest_inflow(const Config &config, int d, int high) {
  return largest(given_flow(config, d, high)) / (config.open_parts[d][high].share * config.grid.side_area(d));
}

std::vector<std::string> side_lines(const Config &config) {
  std::vector<std::string> lines;
  for_crossed_sides(config, [&](int d, int high) {
    if (config.open_parts[d][high].lumens > 0) lines.push_back(side_line(config, d, high));
  });
  return lines;
}

std::vector<std::string> lumen_warnings(const Config &config) {
  std::vector<std::string> warnings;
  for_crossed_sides(config, [&](int d, int high) {
    const OpenPart &part = config.open_parts[d][high];
    const std::string side = "-boundary_" + side_name(d, high) + ": ";
    if (part.lumens == 0 && part.share < 1)
      warnings.push_back(side + "rigid bodies cover all of this open boundary, so that nothing passes it");
    if (part.lumens > 0 && part.connected == 1U << (2 * d + high))
      warnings.push_back(side +
                         "rigid bodies cut this boundary off from all others that fluid can cross, so that no "
                         "flow from them reaches it");
    if (part.lumens > 0 && part.cells < least_cells * (1 - round_off))
      warnings.push_back(
          side + "only " + number(part.cells, 3) +
          " cells across the lumen: with fewer than 8 its flow is several per cent off, with 16 less than 1 %");
    if (const double reynolds = reynolds_number(config, d, high); reynolds > most_reynolds)
      warnings.push_back(side + "Reynolds number " + number(reynolds, 3) +
                         " of the lumen: a flow above 1e4 is turbulent, and there is no model of turbulence");
  });
  const double box = config.grid.volume();
  for (std::size_t s = 0; s < config.species.size(); ++s) {
    const SpeciesSpec &spec = config.species[s];
    const std::string option = "-" + spec.name;
    if (spec.shape == Shape::voxels && config.solid_volumes[s] > box * (1 - round_off))
      warnings.push_back(option + "_voxels: fills all of the box and leaves no fluid");
    if (is_tube(spec.shape) && volume_in_box(spec, config.grid) < round_off * box)
      warnings.push_back(option + "_radius: the lumen is as wide as the box, so that the tube has no wall in it");
  }
  return warnings;
}

}  // namespace eulastic
