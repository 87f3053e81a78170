// Makes Config::sides from the options of the boundaries.
#pragma once

#include "base/petsc.hpp"
#include "field/rigid_faces.hpp"
#include "grid/domain.hpp"
#include "scene/config.hpp"

namespace eulastic {

/// Sets the kinds, values over time and profiles of all boundaries, except developed profiles; reads tables. Returns an
/// error of one line, or nothing.
std::string resolve_openings(Config *config);
/// Sets the profiles of inflow boundaries, which are 0 where rigid bodies (or null) cover them. For a flow rate the
/// mean over the whole boundary is 1; for a velocity the mean over the part that the rigid bodies among `phases` leave
/// open is 1. A developed profile has the shape of the steady flow along the boundary, from a Poisson problem on its
/// plane that every rank solves to round-off; it is uniform without walls. Collective; `wrong`: an error of one line,
/// or unchanged.
PetscErrorCode shape_profiles(const Config &config, const Domain &domain, const RigidFaces *rigid,
                              const std::vector<Phase> &phases, BoundaryConditions *sides, std::string *wrong);

}  // namespace eulastic
