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

// Sets B = R diag(l^2) R^T of a rotated body. An edge belongs to the body that fills at least half of its four cells,
// otherwise to the first body that has a part of them; a centre where owns(point) says so. for_body(staggering, set)
// calls set(local point, global unwrapped point) for the points that the body may touch.
template <class ForBody, class Owns>
void turn_stretch(const SpeciesSpec &spec, const PlacedBody &body, const BodyPlace &place, const ForBody &for_body,
                  const Owns &owns, CarriedTensor *tensor) {
  const Rotation R = rotation(place.orientation);
  const Real3 &l = spec.initial_stretch;
  for (int c = 0; c < tensor->field.count(); ++c) {
    const TensorComponent &component = tensor->components()[c];
    const View B = tensor->field[c];
    double turned = 0;
    for (int m = 0; m < 3; ++m) turned += R[component.a][m] * l[m] * l[m] * R[component.b][m];
    for_body(component.at, [&](const Int3 &p, const Int3 &cell) {
      double &value = B(p[0], p[1], p[2]);
      if (!component.on_edge()) {
        if (owns(p)) value = turned;
        return;
      }
      double sum = 0;  // of phi in the four cells around the edge
      for (int n = 0; n < 4; ++n) {
        Int3 beside = cell;
        beside[component.a] -= n % 2;
        beside[component.b] -= n / 2;
        sum += body.fraction(beside);
      }
      if (sum >= 2 || (sum > 0 && value == 0)) value = turned;
    });
  }
}

// Whether rotation changes B of a body.
bool is_turned(const SpeciesSpec &spec, const BodyPlace &place) {
  const Real3 &l = spec.initial_stretch;
  return place.orientation != Real3{} && !(l[0] == l[1] && l[1] == l[2]);
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
  const Surface surface(spec, domain.dimension());
  fill_bodies(domain, surface, places, first_label, phase);
  stretch_phase(domain, spec, phase);
  for (const NumberedPlace &place : places.known) {
    if (!is_turned(spec, place) || !is_near(domain, domain.rank(), surface, place)) continue;
    const PlacedBody body(surface, domain.domain_shape(), place);
    const auto for_body = [&](const Staggering &at, const auto &set) { for_points_of(domain, body, at, set); };
    const auto owns = [&, label = phase->label[0]](const Int3 &p) {
      return label(p[0], p[1], p[2]) == first_label + place.index;
    };
    if (phase->material.carries_tensor()) turn_stretch(spec, body, place, for_body, owns, &phase->tensor);
  }
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
  const auto for_body = [&](const Staggering &at, const auto &set) {
    for_points(box.points(at), [&](int i, int j, int k) {
      set(Int3{i, j, k}, Int3{first[0] + i, first[1] + j, first[2] + k});
    });
  };
  const View phi = phase.fraction[0];
  for_body(at_centre, [&](const Int3 &p, const Int3 &cell) { phi(p[0], p[1], p[2]) = body.fraction(cell); });
  stretch_phase(box, spec, &phase);
  const auto owns = [&](const Int3 &p) { return phi(p[0], p[1], p[2]) > 0; };
  if (is_turned(spec, place)) turn_stretch(spec, body, place, for_body, owns, &phase.tensor);
  return phase;
}

}  // namespace eulastic
