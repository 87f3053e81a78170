#include "solids/solid_transport.hpp"

#include "base/events.hpp"
#include "grid/threads.hpp"
#include "kernels/stencils.hpp"

#include <algorithm>
#include <limits>

namespace eulastic {
namespace {

struct Edges {
  ConstView phi, aa, bb;
  View ab;
  std::ptrdiff_t a, b;  // strides
  double threshold;
};

EULASTIC_CLONES void limit_row(const Edges &e, const Segment &s) {
  const double *phi = e.phi.row(s.j, s.k), *aa = e.aa.row(s.j, s.k), *bb = e.bb.row(s.j, s.k);
  double *ab = e.ab.row(s.j, s.k);
#pragma omp simd
  for (int i = s.i_begin; i < s.i_end; ++i) {
    const double square = kernels::average4(aa + i, -e.a, -e.b) * kernels::average4(bb + i, -e.a, -e.b);
    const double most = __builtin_sqrt(square > 0 ? square : 0.0);
    const double limited = ab[i] > most ? most : ab[i] < -most ? -most : ab[i];
    const bool finite = __builtin_fabs(ab[i]) <= std::numeric_limits<double>::max();  // keep non-finite values visible
    ab[i] = kernels::average4(phi + i, -e.a, -e.b) < e.threshold || !finite ? ab[i] : limited;
  }
}

}  // namespace

PetscErrorCode limit_shear(const Box &box, const Phase &phase, Field &tensor) {
  PetscFunctionBeginUser;
  EventScope scope(Event::left_cauchy_green);
  for (int f = 0; f < tensor.count(); ++f) {
    const auto [a, b, at] = phase.tensor.components()[f];
    if (a == b) continue;
    const Edges edges{phase.fraction[0],     tensor[a], tensor[b], tensor[f], tensor[f].stride(a), tensor[f].stride(b),
                      phase.tensor.rule.edge};
    in_segment_parts(phase.tensor.evolving.all(), box, [&](const Segment *begin, const Segment *end) {
      for (const Segment *s = begin; s < end; ++s) {
        if (s->j >= box.points_end(1, at[1]) || s->k >= box.points_end(2, at[2])) continue;
        limit_row(edges, {s->i_begin, std::min(s->i_end, box.points_end(0, at[0])), s->j, s->k});
      }
    });
    scope.flops(phase.tensor.evolving.points() * 16);
  }
  PetscFunctionReturn(0);
}

PetscErrorCode SolidTransport::find_layers(const Box &box, const Phase &phase) {
  PetscFunctionBeginUser;
  if (extends_) PetscCall(layers_.build(box, phase));
  PetscFunctionReturn(0);
}

PetscErrorCode SolidTransport::extend(const PhaseDomain &place, const Phase &phase, Field &tensor,
                                      const OccupiedRows *rows) {
  PetscFunctionBeginUser;
  if (!extends_) PetscFunctionReturn(0);
  if (place.exchange) PetscCall(place.exchange->update_ghosts(tensor, ExteriorLayers::layers, rows));
  PetscCall(layers_.extend(*place.box, *place.sides, place.exchange, tensor));
  fill_wall_ghosts_tensor(*place.box, *place.sides, tensor, 1, rows);  // read by limit_shear()
  PetscCall(limit_shear(*place.box, phase, tensor));
  PetscFunctionReturn(0);
}

// Where B is extrapolated, the second stage reads the first one only within the extrapolated layers, so that the rest
// of `stage` may have any values. Otherwise the second stage reads I around the body.
PetscErrorCode SolidTransport::advance(const PhaseDomain &place, const Step &step, const OccupiedRows *rows,
                                       Phase &phase, Field &stage) {
  PetscFunctionBeginUser;
  const Box &box = *place.box;
  const ActiveSegments *written = extends_ ? &phase.tensor.strained : nullptr;
  PetscCall(transport_tensor(box, {step.dt, false, written}, step.velocity, phase, phase.tensor.field, stage));
  PetscCall(extend(place, phase, stage, rows));
  PetscCall(place.update_ghosts(stage, Box::stencil_width, rows));
  PetscCall(transport_tensor(box, {step.dt, true, &step.before}, step.velocity, phase, stage, phase.tensor.field));
  // The corrections are slow compared to a step, so they are applied every second step with 2 dt. They dissipate
  // strain, so they are never run backward in time.
  if (extends_ && !phase.tensor.rule.linear && step.number % 2 == 1 && step.dt > 0) {
    PetscCall(place.update_ghosts(phase.tensor.field, SurfaceCorrection::ghosts, rows));
    PetscCall(surface_.apply(box, {2 * step.dt, step.fluid, *place.sides}, step.velocity, phase, stage));
  }
  PetscCall(extend(place, phase, phase.tensor.field, rows));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
