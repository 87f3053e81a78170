// Solver: forces that pull the ends of bodies apart.
#include "bodies/stretch_force.hpp"
#include "solver/solver.hpp"

namespace eulastic {

// On the phases as they are, with labels and references of the last step.
PetscErrorCode Solver::add_stretch_forces(Field &&scratch, const std::vector<BoxExchange::Target> &targets) {
  PetscFunctionBeginUser;
  if (!StretchForces::exist(now_.phases)) PetscFunctionReturn(0);
  BodyOwners owners;
  std::vector<Int3> references;
  StretchForces forces;
  PetscCall(bodies_.connect(*domain_, now_.phases, {}, &owners, &references));
  PetscCall(forces.find(*domain_, now_.phases, owners, references));
  PetscCall(forces.add(*exchange_, now_.phases, scratch, targets));
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::stretch_power(double *power) {
  PetscFunctionBeginUser;
  *power = 0;
  if (has_boxed()) {
    std::vector<BodyInBox> bodies;
    PetscCall(bodies_now(&bodies));
    PetscCall(boxed_->stretch_power(bodies, now_.phases, power));
  }
  if (!StretchForces::exist(now_.phases)) PetscFunctionReturn(0);
  const std::vector<Phase> *phases = nullptr;
  PetscCall(phases_now(&phases));
  BodyOwners owners;
  std::vector<Int3> references;
  StretchForces forces;
  PetscCall(bodies_.connect(*domain_, *phases, {}, &owners, &references));
  PetscCall(forces.find(*domain_, *phases, owners, references));
  double on_grid = 0;
  PetscCall(forces.power(*phases, now_.velocity, &on_grid));
  *power += on_grid;
  PetscFunctionReturn(0);
}

}  // namespace eulastic
