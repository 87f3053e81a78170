// Detection and removal of bodies that leave the domain through a boundary.
#pragma once

#include "field/phase.hpp"

#include <map>

namespace eulastic {

/// Layers of cells beside an open boundary that bodies must not occupy.
constexpr int free_layers = 2;

/// Whether phi exceeds `more_than` in any owned cell within `layers` of a boundary.
bool has_solid(const Box &box, ConstView fraction, int d, bool high, int layers, double more_than);
/// Whether bodies of a material are removed whole when they reach an open boundary: those with a surface or a viscosity
/// of their own. Other bodies flow out, and the rest within `free_layers` is removed.
bool leaves_whole(const Material &material);
/// State of a body at an open boundary; `stays`: it also has solid elsewhere.
enum class Leaving { no, leaves, stays };
/// Marks the labels of owned solid at a boundary as leaving. `whole`: bodies are removed whole; cells without a label
/// (phi below label_threshold) are emptied at once.
void mark_leaving(const Box &box, int d, bool high, int layers, bool whole, Phase *phase,
                  std::map<int, Leaving> *leaves);
/// Marks as staying those of the leaving bodies that have owned cells away from all open boundaries.
void mark_staying(const Box &box, int layers, const Phase &phase, std::map<int, Leaving> *leaves);
/// Whether a body in a box of its own leaves through an open boundary.
bool leaves_box(const BodyInBox &body);
/// Removes the leaving bodies from owned cells. Ghosts, B around the bodies and rows are left to the caller.
void remove_leaving(const Box &box, const std::map<int, Leaving> &leaves, Phase *phase);

}  // namespace eulastic
