#include "bodies/fill_phase.hpp"

#include "base/events.hpp"
#include "bodies/volume_fraction.hpp"
#include "field/walls.hpp"
#include "grid/threads.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

// The sphere around the body misses this rank's box.
bool is_far(const Grid &grid, const BodyPlace &place, double radius) {
  for (int d = 0; d < grid.dimension(); ++d) {
    const double h = grid.spacing()[d], low = grid.layout().begin[d] * h, length = grid.spec().length[d];
    const double half = grid.owned()[d] * h / 2;
    double distance = std::abs(place.centre[d] - (low + half));
    if (!grid.is_wall(d)) distance = std::min(distance, length - distance);
    if (distance > half + radius + h) return true;
  }
  return false;
}

void add_body(const Grid &grid, const PlacedBody &body, double name, View fraction, View label) {
  const Int3 &first = grid.layout().begin;
  const auto owned = [&](int d) { return body.ranges(d, first[d], first[d] + grid.owned()[d]); };
  const auto add_plane = [&](const PlacedBody::Range &x, const PlacedBody::Range &y, int shift, int k) {
    for (int j = y.begin; j < y.end; ++j)
      for (int i = x.begin; i < x.end; ++i) {
        const double phi = body.fraction({i + x.shift, j + y.shift, k + shift});
        const Int3 c{i - first[0], j - first[1], k - first[2]};
        if (phi <= fraction(c[0], c[1], c[2])) continue;
        fraction(c[0], c[1], c[2]) = phi;
        label(c[0], c[1], c[2]) = name;
      }
  };
  for (const PlacedBody::Range &z : owned(2))
    for (const PlacedBody::Range &y : owned(1))
      for (const PlacedBody::Range &x : owned(0))
        in_parallel(row_parts(grid), z.end - z.begin, [&](int k) { add_plane(x, y, z.shift, z.begin + k); });
}

// Body b goes to *phase_of(b).
template <class PhaseOf>
void add_bodies(const Grid &grid, const SpeciesSpec &spec, const std::vector<BodyPlace> &places, int first_label,
                PhaseOf phase_of) {
  const Surface surface(spec, grid.dimension());
  for (const std::size_t b : bodies_of_rank(grid, spec, places)) {
    Phase *phase = phase_of(b);
    add_body(grid, PlacedBody(surface, grid.spec(), places[b]), first_label + double(b), phase->fraction[0],
             phase->label[0]);
  }
}

}  // namespace

std::vector<std::size_t> bodies_of_rank(const Grid &grid, const SpeciesSpec &spec,
                                        const std::vector<BodyPlace> &places) {
  const double radius = Surface(spec, grid.dimension()).bounding_radius();
  std::vector<std::size_t> own;
  for (std::size_t b = 0; b < places.size(); ++b)
    if (!is_far(grid, places[b], radius)) own.push_back(b);
  return own;
}

void stretch_phase(const Grid &grid, const SpeciesSpec &spec, Phase *phase) {
  phase->tensor = tensor_at_rest(grid);
  const auto &components = tensor_components(grid.dimension());
  const ConstView fraction = phase->fraction[0];
  for (std::size_t c = 0; c < components.size(); ++c) {
    if (components[c].a != components[c].b) continue;
    const double stretch = spec.initial_stretch[components[c].a];
    const View tensor = phase->tensor[static_cast<int>(c)];
    for (const Segment &row : grid.rows())
      for (int i = row.i_begin; i < row.i_end; ++i)
        if (fraction(i, row.j, row.k) > 0) tensor(i, row.j, row.k) = stretch * stretch;
  }
}

PetscErrorCode fill_phase(const Grid &grid, const SpeciesSpec &spec, const std::vector<BodyPlace> &places,
                          int first_label, Phase *phase) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::bodies);
  phase->species = spec.name;
  phase->material = spec.material();
  phase->empty(grid, true);
  add_bodies(grid, spec, places, first_label, [phase](std::size_t) { return phase; });
  stretch_phase(grid, spec, phase);
  PetscFunctionReturn(0);
}

void refill_phases(const Grid &grid, const SpeciesSpec &spec, const std::vector<BodyPlace> &places, int first_label,
                   const std::vector<int> &colour, std::vector<Phase> *phases) {
  for (Phase &phase : *phases) phase.empty(grid, true);
  add_bodies(grid, spec, places, first_label, [&](std::size_t b) { return &(*phases)[colour[b]]; });
  for (Phase &phase : *phases) stretch_phase(grid, spec, &phase);
}

}  // namespace eulastic
