#include "bodies/placement.hpp"

#include "base/rank_zero.hpp"
#include "bodies/random.hpp"
#include "bodies/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>

namespace eulastic {
namespace {

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.10g", value);
  return buffer;
}

// Comma-separated finite numbers; false if anything else is on the line.
bool parse(const std::string &line, std::vector<double> *values) {
  values->clear();
  for (const char *p = line.c_str();; ++p) {
    char *end = nullptr;
    const double value = std::strtod(p, &end);
    if (end == p || !std::isfinite(value)) return false;
    values->push_back(value);
    p = end + std::strspn(end, " \t");
    if (*p == '\0') return true;
    if (*p != ',') return false;
  }
}

std::string read_list(const SpeciesSpec &spec, int dimension, std::vector<BodyPlace> *places) {
  Random random(spec.seed, spec.name);
  std::ifstream file(spec.positions_file);
  if (!file) return "cannot read " + spec.positions_file;
  std::string line;
  std::vector<double> values;
  for (int number = 1; std::getline(file, line); ++number) {
    line.erase(std::remove(line.begin(), line.end(), '\r'), line.end());
    if (line.find_first_not_of(" \t") == std::string::npos) continue;
    std::string packed = line;
    packed.erase(std::remove_if(packed.begin(), packed.end(), [](char c) { return c == ' ' || c == '\t'; }),
                 packed.end());
    if (places->empty() && (packed == "x,y,z" || packed == "x,y,z,angle_x,angle_y,angle_z")) continue;
    if (!parse(line, &values) || (values.size() != 3 && values.size() != 6))
      return spec.positions_file + " line " + std::to_string(number) + ": expected x,y,z or " +
             "x,y,z,angle_x,angle_y,angle_z, found \"" + line + "\"";
    BodyPlace place{{values[0], values[1], values[2]}, spec.orientation};
    if (spec.random_orientation) place.orientation = random.orientation(dimension);
    if (values.size() == 6) place.orientation = {values[3], values[4], values[5]};
    places->push_back(place);
  }
  if (file.bad()) return "cannot read " + spec.positions_file;
  return places->empty() ? spec.positions_file + " holds no positions" : std::string{};
}

std::string make_lattice(const SpeciesSpec &spec, const GridSpec &grid, std::vector<BodyPlace> *places) {
  const Int3 &n = spec.count;
  if (n[0] < 1 || n[1] < 1 || n[2] < 1) return "a lattice needs at least one body in every direction";
  if (grid.cells[2] == 1 && n[2] != 1) return "a lattice has one layer in z in 2-D";
  if (double(n[0]) * n[1] * n[2] > most_bodies) return "at most " + std::to_string(most_bodies) + " bodies";
  const int dimension = grid.cells[2] == 1 ? 2 : 3;
  const Surface surface(spec, dimension);
  Random random(spec.seed, spec.name);
  Real3 pitch, range{};
  for (int d = 0; d < 3; ++d) {
    pitch[d] = grid.length[d] / n[d];
    const bool turns = spec.random_orientation;
    const double half = turns ? surface.bounding_radius() : surface.support(rotation(spec.orientation)[d]);
    if (d < dimension) range[d] = spec.jitter * std::max(0.0, pitch[d] / 2 - half);
  }
  places->reserve(std::size_t(n[0]) * n[1] * n[2]);
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        BodyPlace &place = places->emplace_back();
        const Int3 index{i, j, k};
        place.orientation = spec.orientation;
        for (int d = 0; d < 3; ++d) {
          place.centre[d] = (index[d] + 0.5) * grid.length[d] / n[d];
          if (range[d] > 0) place.centre[d] += random.between(-range[d], range[d]);
        }
        if (spec.random_orientation) place.orientation = random.orientation(dimension);
      }
  return {};
}

// Why the lumen of a tube is not in the box.
std::string why_no_lumen(const SpeciesSpec &spec, const GridSpec &grid, const Real3 &centre) {
  const double throat = spec.shape == Shape::constricted_tube ? spec.throat_length / 2 : 0;
  for (int d = 0; d < (grid.cells[2] == 1 ? 2 : 3); ++d) {
    const double half = d == spec.axis ? throat : spec.radius, slack = 1e-5 * grid.length[d];
    if (centre[d] - half >= -slack && centre[d] + half <= grid.length[d] + slack) continue;
    return std::string(d == spec.axis ? "its throat" : "its lumen") + " leaves the box: " + "xyz"[d] + " = " +
           text(centre[d] - half) + " ... " + text(centre[d] + half) + ", the box is 0 ... " + text(grid.length[d]);
  }
  return {};
}

// Why `place` cannot be in the box.
std::string why_not(const SpeciesSpec &spec, const Surface &surface, const GridSpec &grid, const BodyPlace &place) {
  const int dimension = grid.cells[2] == 1 ? 2 : 3;
  if (dimension == 2 && (place.orientation[0] != 0 || place.orientation[1] != 0)) return "turns only about z in 2-D";
  const bool may_cross = spec.shape == Shape::cylinder || is_attached(spec.shape);
  if (may_cross && place.orientation != Real3{})
    return "cannot be turned: cylinders, slabs and tubes take an axis, no orientation";
  if (is_tube(spec.shape)) return why_no_lumen(spec, grid, place.centre);
  for (int d = 0; d < dimension; ++d) {
    const double centre = place.centre[d], length = grid.length[d], bound = surface.bounding_radius();
    const std::string direction(1, "xyz"[d]);
    if (!(centre >= 0 && centre <= length))
      return "its centre " + direction + " = " + text(centre) + " is outside the box, 0 ... " + text(length);
    if (centre >= bound && centre + bound <= length) continue;
    const double extent = surface.support(rotation(place.orientation)[d]), slack = 1e-5 * length;
    if (std::isfinite(extent) && 2 * extent > length + slack)
      return "it is " + text(2 * extent) + " long in " + direction + ", the box only " + text(length);
    if (grid.boundary[d] == Boundary::periodic || may_cross) continue;
    if (centre - extent < -slack || centre + extent > length + slack)
      return "it reaches into the wall: " + direction + " = " + text(centre - extent) + " ... " +
             text(centre + extent) + ", the box is 0 ... " + text(length);
  }
  return {};
}

}  // namespace

std::string place_bodies(const SpeciesSpec &spec, const GridSpec &grid, std::vector<BodyPlace> *places) {
  const bool flat = grid.cells[2] == 1;
  places->clear();
  if (spec.shape == Shape::voxels || spec.shape == Shape::state) return {};  // from files
  std::string reason = why_no_shape(spec, flat ? 2 : 3);
  if (!reason.empty()) return reason;
  Real3 middle{grid.length[0] / 2, grid.length[1] / 2, grid.length[2] / 2};
  if (is_attached(spec.shape) && spec.placement != Placement::one) return "slabs and tubes are placed once";
  if (spec.shape == Shape::slab) {
    middle[spec.axis] = (spec.interval[0] + spec.interval[1]) / 2;
    places->push_back({middle, spec.orientation});
  } else if (spec.placement == Placement::one) {
    places->push_back({spec.centre_given ? spec.centre : middle, spec.orientation});
    if (spec.random_orientation) places->back().orientation = Random(spec.seed, spec.name).orientation(flat ? 2 : 3);
  } else if (spec.placement == Placement::list) {
    reason = on_rank_0([&] { return read_list(spec, flat ? 2 : 3, places); });
    share(places);
  } else {
    reason = make_lattice(spec, grid, places);
  }
  if (!reason.empty()) return reason;
  const Surface surface(spec, flat ? 2 : 3);
  for (std::size_t b = 0; b < places->size(); ++b) {
    if (flat) (*places)[b].centre[2] = middle[2];
    reason = why_not(spec, surface, grid, (*places)[b]);
    if (!reason.empty()) return places->size() > 1 ? "body " + std::to_string(b + 1) + ": " + reason : reason;
  }
  return {};
}

}  // namespace eulastic
