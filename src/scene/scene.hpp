// The initial scene of a validated Config.
#pragma once

#include "base/petsc.hpp"
#include "grid/domain.hpp"
#include "scene/config.hpp"
#include "solver/solver.hpp"

namespace eulastic {

/// Makes the solver on `grid` and sets its initial velocity and bodies. `reason`: an error of one line if a species
/// cannot be placed.
PetscErrorCode build_scene(const Config &config, const Domain &domain, Solver *solver, std::string *reason);

}  // namespace eulastic
