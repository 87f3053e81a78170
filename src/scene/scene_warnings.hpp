// Warnings about scenes whose grid or time step is too coarse.
#pragma once

#include "base/petsc.hpp"
#include "scene/config.hpp"

namespace eulastic {

/// One line for every species that is anchored and whose elastic waves as short as a cell are not damped
/// (damps_short_waves), so that its surface is treated like that of a free body, first order in the spacing; whose
/// viscosity lies so far from the fluid's that the velocity lags (ViscosityContrast::allows_pressure_extrapolation); or
/// whose surface the grid does not resolve (coarse_surface_warnings). Then those of lumen_warnings().
std::vector<std::string> scene_warnings(const Config &config);

/// Collective. `warning`: one line with the number of overlapping bodies, the first pair and a remedy; empty without
/// overlaps (bodies/overlap.hpp), or with -initial_state, which may define bodies of its own. `refusal`: one line if
/// two bodies are at the same position, and then no warning. The same on any number of ranks.
PetscErrorCode find_overlap(MPI_Comm comm, const Config &config, std::string *warning, std::string *refusal);

/// Collective. `warning`: one line that names the first such body and a remedy; empty if there is none, or with
/// -initial_state, which may define bodies of its own. Walls: solid boundaries of the box and rigid bodies at rest,
/// except those from files. Random placement keeps a cell free. The same on any number of ranks.
PetscErrorCode find_membranes_near_walls(MPI_Comm comm, const Config &config, std::string *warning);

}  // namespace eulastic
