#include "solids/solid_transport.hpp"

#include "solids/positive_definite.hpp"
#include "solids/transport.hpp"

namespace eulastic {

PetscErrorCode SolidTransport::find_layers(const Box &box, const Phase &phase) {
  PetscFunctionBeginUser;
  if (extends_) PetscCall(layers_.build(box, phase));
  PetscFunctionReturn(0);
}

PetscErrorCode SolidTransport::extend(const PhasePlace &place, const Phase &phase, Field &tensor,
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
PetscErrorCode SolidTransport::advance(const PhasePlace &place, const Step &step, const OccupiedRows *rows,
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
