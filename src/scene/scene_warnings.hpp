// Warnings about scenes whose grid or time step is too coarse.
#pragma once

#include "scene/config.hpp"

namespace eulastic {

/// One line for every species that is anchored and whose elastic waves as short as a cell are not damped
/// (damps_short_waves), so that its surface is treated like that of a free body, first order in the spacing; whose
/// viscosity lies so far from the fluid's that the velocity lags (ViscosityContrast::settles); or whose surface the
/// grid does not resolve (coarse_surface_warnings). Then those of lumen_warnings().
std::vector<std::string> scene_warnings(const Config &config);

}  // namespace eulastic
