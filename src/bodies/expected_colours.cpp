#include "bodies/expected_colours.hpp"

#include "bodies/colouring.hpp"
#include "bodies/contact.hpp"
#include "bodies/crowd.hpp"

#include <algorithm>

namespace eulastic {

int expected_colours(const SpeciesSpec &spec, const DomainShape &grid, const Places &places) {
  constexpr int corners = 3;  // cells: those that surfaces cut, and what lies within the reach along a diagonal
  if (spec.shape != Shape::sphere && spec.shape != Shape::ellipsoid && spec.shape != Shape::biconcave) return 1;
  const int dimension = grid.cells[2] == 1 ? 2 : 3;
  const std::size_t count = std::min<std::size_t>(places.count, expected_colours_of);
  double spacing = 0;
  for (int d = 0; d < dimension; ++d) spacing = std::max(spacing, grid.length[d] / grid.cells[d]);
  const ConvexBody shape(spec, dimension, spacing * (contact_reach + corners) / 2);
  Crowd crowd(grid, 2 * shape.outer_radius(), count);
  for (std::size_t b = 0; b < count; ++b)
    crowd.add({&shape, places.known[b].centre, rotation(places.known[b].orientation)});
  std::vector<int> bodies;
  std::vector<NearBodies> pairs;
  for (int b = 0; b < static_cast<int>(count); ++b) {
    bodies.push_back(b);
    for (const int other : crowd.touching(b))
      if (other < b) pairs.push_back({b, other, 0});
  }
  if (bodies.empty()) return 1;
  const std::vector<int> colours = colour_bodies(bodies, pairs);
  return std::min(1 + *std::max_element(colours.begin(), colours.end()), most_colours);
}

}  // namespace eulastic
