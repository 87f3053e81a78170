// Solver: forces that pull the ends of bodies apart.
#include "bodies/stretch_force.hpp"
#include "solver/solver.hpp"

namespace eulastic {

// On the phases as they are, with labels and references of the last step.
PetscErrorCode Solver::add_stretch_forces(Field &&scratch, Field &rate) {
  PetscFunctionBeginUser;
  if (!StretchForces::exist(now_.phases)) PetscFunctionReturn(0);
  BodyOwners owners;
  std::vector<Int3> references;
  StretchForces forces;
  PetscCall(bodies_.connect(*domain_, now_.phases, {}, &owners, &references));
  PetscCall(forces.find(*domain_, now_.phases, owners, references));
  PetscCall(forces.add(*exchange_, now_.phases, 1 / spec_.fluid.density, scratch, rate));
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::stretch_power(double *power) {
  PetscFunctionBeginUser;
  *power = 0;
  if (!StretchForces::exist(now_.phases)) PetscFunctionReturn(0);
  const std::vector<Phase> *phases = nullptr;
  PetscCall(phases_now(&phases));
  BodyOwners owners;
  std::vector<Int3> references;
  StretchForces forces;
  PetscCall(bodies_.connect(*domain_, *phases, {}, &owners, &references));
  PetscCall(forces.find(*domain_, *phases, owners, references));
  PetscCall(forces.power(*phases, now_.velocity, power));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
