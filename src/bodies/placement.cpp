#include "bodies/placement.hpp"

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

std::string read_list(const SpeciesSpec &spec, std::vector<BodyPlace> *places) {
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
  if (double(n[0]) * n[1] * n[2] > 2e9) return "a lattice can hold at most 2e9 bodies";
  places->reserve(std::size_t(n[0]) * n[1] * n[2]);
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i)
        places->push_back(
            {{(i + 0.5) * grid.length[0] / n[0], (j + 0.5) * grid.length[1] / n[1], (k + 0.5) * grid.length[2] / n[2]},
             spec.orientation});
  return {};
}

// Why `place` cannot be in the box.
std::string why_not(const SpeciesSpec &spec, const Surface &surface, const GridSpec &grid, const BodyPlace &place) {
  const int dimension = grid.cells[2] == 1 ? 2 : 3;
  if (dimension == 2 && (place.orientation[0] != 0 || place.orientation[1] != 0)) return "turns only about z in 2-D";
  const bool may_cross = spec.shape == Shape::cylinder || spec.shape == Shape::slab;
  if (may_cross && place.orientation != Real3{})
    return "cannot be turned: cylinders and slabs take an axis, no orientation";
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
  if (spec.shape == Shape::state) return {};  // its bodies come with the fields
  std::string reason = why_no_shape(spec, flat ? 2 : 3);
  if (!reason.empty()) return reason;
  Real3 middle{grid.length[0] / 2, grid.length[1] / 2, grid.length[2] / 2};
  if (spec.shape == Shape::slab) {
    if (spec.placement != Placement::one) return "a slab is placed once, by its interval";
    middle[spec.axis] = (spec.interval[0] + spec.interval[1]) / 2;
    places->push_back({middle, spec.orientation});
  } else if (spec.placement == Placement::one) {
    places->push_back({spec.centre_given ? spec.centre : middle, spec.orientation});
  } else {
    reason = spec.placement == Placement::list ? read_list(spec, places) : make_lattice(spec, grid, places);
    if (!reason.empty()) return reason;
  }
  const Surface surface(spec, flat ? 2 : 3);
  for (std::size_t b = 0; b < places->size(); ++b) {
    if (flat) (*places)[b].centre[2] = middle[2];
    reason = why_not(spec, surface, grid, (*places)[b]);
    if (!reason.empty()) return places->size() > 1 ? "body " + std::to_string(b + 1) + ": " + reason : reason;
  }
  return {};
}

}  // namespace eulastic
