// What a scene asks for that its grid or its steps are too coarse for.
#pragma once

#include "base/petsc.hpp"
#include "scene/config.hpp"

namespace eulastic {

/// One line for every species that is attached and whose elastic waves as short as a cell are not damped
/// (damps_short_waves), so that its surface is treated like that of a free body, first order in the spacing; whose
/// viscosity lies so far from the fluid's that the velocity lags (ViscosityContrast::settles); or whose surface the
/// grid does not resolve (coarse_surface_warnings). Then those of lumen_warnings().
std::vector<std::string> scene_warnings(const Config &config);

/// Collective. `warning`: one line that says how many bodies overlap, which is the first pair and what to do; empty if
/// none does (bodies/overlap.hpp), or with -initial_state, which may bring bodies of its own. `refusal`: one line if
/// two bodies are at the same place, and then no warning. The same on any number of ranks.
PetscErrorCode find_overlap(MPI_Comm comm, const Config &config, std::string *warning, std::string *refusal);

/// Collective. `warning`: one line that names the first such body and says what to do; empty if there is none, or with
/// -initial_state, which may bring bodies of its own. Walls: solid sides of the box, rigid bodies that do not travel,
/// but those from files. Bodies at random keep a cell free. The same on any number of ranks.
PetscErrorCode find_membranes_near_walls(MPI_Comm comm, const Config &config, std::string *warning);

}  // namespace eulastic
