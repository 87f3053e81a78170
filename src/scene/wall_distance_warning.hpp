// The warning of membranes that are placed nearer to a wall than a cell.
#pragma once

#include "base/petsc.hpp"
#include "scene/config.hpp"

namespace eulastic {

/// Collective. `warning`: one line that names the first such body and says what to do; empty if there is none, or with
/// -initial_state, which may bring bodies of its own. Walls: solid sides of the box, rigid bodies that do not travel,
/// but those from files. Bodies at random keep a cell free. The same on any number of ranks.
PetscErrorCode find_membranes_near_walls(MPI_Comm comm, const Config &config, std::string *warning);

}  // namespace eulastic
