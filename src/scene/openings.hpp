// From what the user says of inflow and pressure sides to Config::sides.
#pragma once

#include "base/petsc.hpp"
#include "field/rigid_faces.hpp"
#include "grid/domain.hpp"
#include "scene/config.hpp"

namespace eulastic {

/// Kinds, courses and profiles of all sides, but developed ones; reads tables. Empty, or one line that says what is
/// wrong.
std::string resolve_openings(Config *config);
/// Profiles of inflow sides: 0 where rigid bodies (or null) cover them. The mean over the whole side is 1 where a flow
/// rate is given; where a velocity is given, the mean over the part that the rigid bodies among `phases` leave open
/// is 1. Developed ones: the shape of the steady flow along the side, from one Poisson problem on its plane, to
/// round-off; uniform where nothing holds the fluid. Every rank solves it. Collective; `wrong`: one line, or left
/// empty.
PetscErrorCode shape_profiles(const Config &config, const Domain &domain, const RigidFaces *rigid,
                              const std::vector<Phase> &phases, BoxSides *sides, std::string *wrong);

}  // namespace eulastic
