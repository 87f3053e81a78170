// From what the user says of inflow and pressure sides to Config::sides.
#pragma once

#include "app/config.hpp"

namespace eulastic {

/// Kinds, courses and profiles of all sides, but developed ones; reads tables. Empty, or one line that says what is
/// wrong.
std::string resolve_openings(Config *config);
/// Developed profiles, which need PETSc: the shape of the steady flow along the side, from one Poisson problem on its
/// plane, to round-off; uniform where nothing holds the fluid. Every rank solves it.
PetscErrorCode develop_profiles(const Config &config, BoxSides *sides);

}  // namespace eulastic
