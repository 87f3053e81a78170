#include "field/phase_place.hpp"

namespace eulastic {

PetscErrorCode PhasePlace::exchange_ghosts(Field &field, int width, const OccupiedRows *rows) const {
  PetscFunctionBeginUser;
  if (exchange) PetscCall(exchange->update_ghosts(field, width, rows));
  PetscFunctionReturn(0);
}

PetscErrorCode PhasePlace::update_ghosts(Field &tensor, int width, const OccupiedRows *rows) const {
  PetscFunctionBeginUser;
  PetscCall(exchange_ghosts(tensor, width, rows));
  fill_wall_ghosts_tensor(*box, *sides, tensor, width, rows);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
