// Warns of membranes that are placed less than a cell from a wall.
#pragma once

#include "base/petsc.hpp"
#include "scene/config.hpp"

namespace eulastic {

/// Collective. `warning`: one line that names the first such body and a remedy; empty if there is none, or with
/// -initial_state, which may define bodies of its own. Walls: solid boundaries of the box and rigid bodies at rest,
/// except those from files. Random placement keeps a cell free. The same on any number of ranks.
PetscErrorCode find_membranes_near_walls(MPI_Comm comm, const Config &config, std::string *warning);

}  // namespace eulastic
