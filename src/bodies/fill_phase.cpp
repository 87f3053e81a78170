#include "bodies/fill_phase.hpp"

#include "base/events.hpp"
#include "bodies/near_places.hpp"
#include "bodies/volume_fraction.hpp"
#include "field/boundaries.hpp"
#include "grid/threads.hpp"

#include <algorithm>

namespace eulastic {
namespace {

void add_body(const Box &box, const PlacedBody &body, double name, View fraction, View label) {
  const Int3 &first = box.layout().begin;
  const auto owned = [&](int d) { return body.ranges(d, first[d], first[d] + box.cells()[d]); };
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
        in_parallel(row_parts(box), z.end - z.begin, [&](int k) { add_plane(x, y, z.shift, z.begin + k); });
}

// Calls f(local point, global unwrapped point) for the points of a staggering beside a cell that the body may touch.
template <class F>
void for_points_of(const Box &box, const PlacedBody &body, const Staggering &at, const F &f) {
  const auto ranges = [&](int d) {
    const int first = box.layout().begin[d], end = first + box.points_end(d, at[d]);
    std::vector<PlacedBody::Range> found = body.ranges(d, first - at[d], end);
    for (PlacedBody::Range &r : found) r = {std::max(r.begin, first), std::min(r.end + at[d], end), r.shift};
    return found;
  };
  const Int3 &first = box.layout().begin;
  for (const PlacedBody::Range &z : ranges(2))
    for (const PlacedBody::Range &y : ranges(1))
      for (const PlacedBody::Range &x : ranges(0))
        for (int k = z.begin; k < z.end; ++k)
          for (int j = y.begin; j < y.end; ++j)
            for (int i = x.begin; i < x.end; ++i)
              f(Int3{i - first[0], j - first[1], k - first[2]}, Int3{i + x.shift, j + y.shift, k + z.shift});
}

// Returns a component of R diag(l^2) R^T.
double turned_stretch(const SpeciesSpec &spec, const Rotation &R, const TensorComponent &component) {
  const Real3 &l = spec.initial_stretch;
  double turned = 0;
  for (int m = 0; m < 3; ++m) turned += R[component.a][m] * l[m] * l[m] * R[component.b][m];
  return turned;
}

// Sets B = R diag(l^2) R^T of rotated bodies. An edge belongs to the body that fills at least half of its four cells,
// otherwise to the first body that has a part of them.
void turn_stretch(const Domain &domain, const SpeciesSpec &spec, const Places &places, int first_label, Phase *phase) {
  const Real3 &l = spec.initial_stretch;
  if ((l[0] == l[1] && l[1] == l[2]) || !spec.material().carries_tensor()) return;
  const Surface surface(spec, domain.dimension());
  for (const NumberedPlace &place : places.known) {
    if (place.orientation == Real3{} || !is_near(domain, domain.rank(), surface, place)) continue;
    const Rotation R = rotation(place.orientation);
    const PlacedBody body(surface, domain.domain_shape(), place);
    for (int c = 0; c < phase->tensor.field.count(); ++c) {
      const TensorComponent &component = phase->tensor.components()[c];
      const auto [x, y, at] = component;
      const double turned = turned_stretch(spec, R, component);
      const View B = phase->tensor.field[c], label = phase->label[0];
      for_points_of(domain, body, at, [&, x = x, y = y](const Int3 &p, const Int3 &cell) {
        double &value = B(p[0], p[1], p[2]);
        if (!component.on_edge()) {
          if (label(p[0], p[1], p[2]) == first_label + place.index) value = turned;
          return;
        }
        double sum = 0;  // of phi in the four cells around the edge
        for (int n = 0; n < 4; ++n) {
          Int3 beside = cell;
          beside[x] -= n % 2;
          beside[y] -= n / 2;
          sum += body.fraction(beside);
        }
        if (sum >= 2 || (sum > 0 && value == 0)) value = turned;
      });
    }
  }
}

}  // namespace

void fill_bodies(const Domain &domain, const Surface &surface, const Places &places, int first_label, Phase *phase) {
  EventScope scope(Event::bodies);
  phase->empty(domain, true);
  for (const NumberedPlace &place : places.known)
    if (is_near(domain, domain.rank(), surface, place))
      add_body(domain, PlacedBody(surface, domain.domain_shape(), place), first_label + place.index, phase->fraction[0],
               phase->label[0]);
}

void stretch_phase(const Box &box, const SpeciesSpec &spec, Phase *phase) {
  phase->tensor.field = undeformed_tensor(box);
  if (!phase->material.carries_tensor()) return;
  const ConstView fraction = phase->fraction[0];
  for (int d = 0; d < box.dimension(); ++d) {
    const double stretch = spec.initial_stretch[d];
    const View tensor = phase->tensor.field[d];
    for_points(box.rows(), [&](int i, int j, int k) {
      if (fraction(i, j, k) > 0) tensor(i, j, k) = stretch * stretch;
    });
  }
}

PetscErrorCode fill_phase(const Domain &domain, const SpeciesSpec &spec, const Places &places, int first_label,
                          Phase *phase) {
  PetscFunctionBeginUser;
  EventScope scope(Event::bodies);
  phase->species = spec.name;
  phase->material = spec.material();
  fill_bodies(domain, Surface(spec, domain.dimension()), places, first_label, phase);
  stretch_phase(domain, spec, phase);
  turn_stretch(domain, spec, places, first_label, phase);
  PetscFunctionReturn(0);
}

Box box_of_body(const DomainShape &domain, const Surface &surface, const BodyPlace &place, int around, int ghosts) {
  const PlacedBody body(surface, domain, place);
  Int3 begin{}, cells{1, 1, 1};
  for (int d = 0; d < domain.dimension(); ++d) {
    PlacedBody::Range extent = body.extent(d);
    extent = {extent.begin - around, extent.end + around, 0};
    if (domain.is_wall(d)) extent = {std::max(extent.begin, 0), std::min(extent.end, domain.cells[d]), 0};
    begin[d] = extent.begin;
    cells[d] = extent.end - extent.begin;
  }
  return Box(domain, begin, cells, ghosts);
}

Phase fill_body(const Box &box, const SpeciesSpec &spec, const Surface &surface, const BodyPlace &place) {
  Phase phase;
  phase.species = spec.name;
  phase.material = spec.material();
  phase.fraction = Field(box, 1);
  phase.tensor.centred = phase.material.is_membrane();
  const PlacedBody body(surface, box.domain_shape(), place);
  const Int3 &first = box.layout().begin;
  const auto fraction = [&](const Int3 &p) {
    return body.fraction({first[0] + p[0], first[1] + p[1], first[2] + p[2]});
  };
  for_points(box.rows(), [&](int i, int j, int k) { phase.fraction[0](i, j, k) = fraction({i, j, k}); });
  stretch_phase(box, spec, &phase);
  const Real3 &l = spec.initial_stretch;
  if ((l[0] == l[1] && l[1] == l[2]) || place.orientation == Real3{}) return phase;
  for (int c = 0; c < phase.tensor.field.count(); ++c) {
    const TensorComponent &component = phase.tensor.components()[c];
    const double turned = turned_stretch(spec, rotation(place.orientation), component);
    for_points(box.points(component.at), [&](int i, int j, int k) {
      double sum = 0;  // of phi in the four cells around an edge, or in the cell
      for (int n = 0; n < (component.on_edge() ? 4 : 1); ++n) {
        Int3 beside{i, j, k};
        beside[component.a] -= n % 2;
        beside[component.b] -= n / 2;
        sum += fraction(beside);
      }
      if (sum > 0) phase.tensor.field[c](i, j, k) = turned;
    });
  }
  return phase;
}

}  // namespace eulastic
