#include "bodies/fill_phase.hpp"

#include "base/events.hpp"
#include "bodies/volume_fraction.hpp"
#include "field/walls.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

// Owned cells of one direction that a body may touch, seen from one periodic image of the box.
struct Range {
  int begin, end, shift;
};

std::vector<Range> ranges(const Grid &grid, const PlacedBody &body, int d) {
  const int first = grid.layout().begin[d], last = first + grid.owned()[d], images = body.has_images(d) ? 1 : 0;
  std::vector<Range> result;
  for (int image = -images; image <= images; ++image) {
    const int shift = image * grid.cells()[d];
    const int begin = std::max(body.begin(d), first + shift), end = std::min(body.end(d), last + shift);
    if (begin < end) result.push_back({begin - shift - first, end - shift - first, shift + first});
  }
  return result;
}

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
  for (const Range &z : ranges(grid, body, 2))
    for (const Range &y : ranges(grid, body, 1))
      for (const Range &x : ranges(grid, body, 0))
        for (int k = z.begin; k < z.end; ++k)
          for (int j = y.begin; j < y.end; ++j)
            for (int i = x.begin; i < x.end; ++i) {
              const double phi = body.fraction({i + x.shift, j + y.shift, k + z.shift});
              if (phi <= fraction(i, j, k)) continue;
              fraction(i, j, k) = phi;
              label(i, j, k) = name;
            }
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
  const auto &components = tensor_components(grid.dimension());
  const ConstView fraction = phase->fraction[0];
  for (std::size_t c = 0; c < components.size(); ++c) {
    if (components[c].a != components[c].b) continue;
    const double stretch = spec.initial_stretch[components[c].a];
    const View tensor = phase->tensor[static_cast<int>(c)];
    phase->tensor.fill(static_cast<int>(c), 1.0);
    for (const Segment &row : grid.rows())
      for (int i = row.i_begin; i < row.i_end; ++i)
        if (fraction(i, row.j, row.k) > 0) tensor(i, row.j, row.k) = stretch * stretch;
  }
}

PetscErrorCode fill_phase(const Grid &grid, const SpeciesSpec &spec, const std::vector<BodyPlace> &places,
                          int first_label, Phase *phase) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::bodies);
  const auto &components = tensor_components(grid.dimension());
  phase->species = spec.name;
  phase->material = spec.material();
  phase->fraction = FieldBlock(grid, 1);
  phase->tensor = FieldBlock(grid, static_cast<int>(components.size()));
  phase->label = FieldBlock(grid, 1);
  add_bodies(grid, spec, places, first_label, [phase](std::size_t) { return phase; });
  stretch_phase(grid, spec, phase);
  PetscFunctionReturn(0);
}

void refill_phases(const Grid &grid, const SpeciesSpec &spec, const std::vector<BodyPlace> &places, int first_label,
                   const std::vector<int> &colour, std::vector<Phase> *phases) {
  for (Phase &phase : *phases) {
    phase.fraction.clear();
    phase.label.clear();
  }
  add_bodies(grid, spec, places, first_label, [&](std::size_t b) { return &(*phases)[colour[b]]; });
  for (Phase &phase : *phases) stretch_phase(grid, spec, &phase);
}

}  // namespace eulastic
