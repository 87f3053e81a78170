// -NAME_law red_cell: parameters of a red blood cell; and lines about membranes at the start of a run.
#pragma once

#include "scene/config.hpp"

#include <string>
#include <utility>
#include <vector>

namespace eulastic {

/// Options of a species without its name, and their values: in um, us and 1 mPa s, G_s and E_b of Mills et al. (2004).
const std::vector<std::pair<std::string, std::string>> &red_cell_preset();
/// One line with the parameters of every species of red cells.
std::vector<std::string> red_cell_lines(const Config &config);
/// Growth of the area at which the membrane of a red cell bursts (Evans, Waugh and Melnik 1976).
constexpr double red_cell_bursts = 0.04;
/// One line on every species of membranes that are somewhere less than three cells apart.
std::vector<std::string> coarse_surface_warnings(const Config &config);
/// One line on every species of drops of less than six cells in radius, which the flow stretches.
std::vector<std::string> coarse_drop_warnings(const Config &config);

}  // namespace eulastic
