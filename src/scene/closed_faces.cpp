#include "scene/closed_faces.hpp"

#include "io/option_values.hpp"

#include <cmath>

namespace eulastic {
namespace {

bool contains_face(const PlacedBody &body, const DomainShape &grid) {
  constexpr unsigned faces = centre_inside - 1;
  Int3 middle{}, end = grid.cells;
  for (int d = 0; d < grid.dimension(); ++d) {
    middle[d] = static_cast<int>(std::floor(body.centre()[d] + 0.5 * grid.cells[d]));
    end[d] += grid.is_wall(d);  // the faces on the high boundary
  }
  bool found = (faces_inside(body, grid, middle) & faces) != 0;  // of a large body
  if (!found)
    body.for_cells({}, end, [&](const Int3 &, const Int3 &cell) {
      found = found || (faces_inside(body, grid, cell) & faces) != 0;
    });
  return found;
}

}  // namespace

unsigned faces_inside(const PlacedBody &body, const DomainShape &grid, const Int3 &cell) {
  if (body.is_clear_of(cell)) return 0;
  const double depth = on_surface * grid.shortest_spacing();
  Real3 centre{};
  for (int d = 0; d < grid.dimension(); ++d) centre[d] = cell[d] + 0.5 - 0.5 * grid.cells[d];
  unsigned bits = body.level(centre) < 0 ? centre_inside : 0;
  for (int a = 0; a < grid.dimension(); ++a) {
    Real3 face = centre;
    face[a] -= 0.5;
    if (body.level(face) < -depth) bits |= 1U << a;
  }
  return bits;
}

std::string check_small_bodies(const Config &config) {
  const DomainShape &grid = config.grid;
  for (std::size_t s = 0; s < config.species.size(); ++s) {
    const SpeciesSpec &spec = config.species[s];
    if (spec.law != Law::rigid || !(is_closed(spec.shape) || spec.shape == Shape::cylinder)) continue;
    const Surface surface(spec, grid.dimension());
    for (const BodyPlace &place : config.places[s].known) {
      if (contains_face(PlacedBody(surface, grid, place), grid)) continue;
      std::string position = to_text(place.centre[0]);
      for (int d = 1; d < grid.dimension(); ++d) position += "," + to_text(place.centre[d]);
      return "-" + spec.name + (spec.shape == Shape::ellipsoid ? "_semi_axes" : "_radius") + ": the rigid body at " +
             position + " contains no face of the grid, so that fluid passes through it; accepted: bodies at least " +
             to_text(2 * grid.longest_spacing()) + " thick, two cells";
    }
  }
  return {};
}

}  // namespace eulastic
