// Bodies at sides of the box that they leave through.
#pragma once

#include "field/phase.hpp"

#include <map>

namespace eulastic {

/// Cells beside a side that volume crosses where no body is.
constexpr int free_layers = 2;

/// Whether this rank has more phi than that in any cell within `layers` of a side.
bool has_solid(const Box &box, ConstView fraction, int d, bool high, int layers, double more_than);
/// Whether bodies are taken out, all of each, when they come there: what is on their surface, and another viscosity,
/// is not followed through a side. All others flow out, and what is left within `free_layers` is taken out.
bool leave_whole(const Material &material);
/// Of a body, by its label: it has solid at an open side, and maybe elsewhere too.
enum class Leaving { no, leaves, stays };
/// Marks the labels of solid that this rank has at a side. Where they leave whole, what has no label (less than
/// label_threshold) is gone at once.
void mark_leaving(const Box &box, int d, bool high, int layers, bool whole, Phase *phase,
                  std::map<int, Leaving> *leaves);
/// Those stay, of bodies that are marked on any rank, of which this one has BodyCells at no open side.
void mark_staying(const Box &box, int layers, const Phase &phase, std::map<int, Leaving> *leaves);
/// Of a body in a box of its own: whether it leaves through an open side.
bool leaves_box(const BodyInBox &body);
/// Takes the bodies that leave out of owned cells. What is around them is the caller's.
void take_out(const Box &box, const std::map<int, Leaving> &leaves, Phase *phase);

}  // namespace eulastic
