// A phase at the start: solid fraction, left Cauchy-Green tensor and labels of placed bodies.
#pragma once

#include "bodies/placement.hpp"
#include "field/phase.hpp"

namespace eulastic {

/// Positions in `places` of the bodies that a rank builds, ascending: those whose bounding sphere reaches its cells.
std::vector<std::size_t> bodies_of_rank(const Grid &grid, const SpeciesSpec &spec,
                                        const std::vector<BodyPlace> &places);

/// Allocates `phase` and fills its owned cells; ghosts are the caller's. Fraction: of the fullest body of a cell.
/// Tensor: B = R diag(initial_stretch^2) R^T, R the body's orientation, in cells with phi > 0 and on edges beside them, I
/// elsewhere. Label: first_label + index in `places`
/// (first_label >= 1) of the fullest body where phi > 0, the first of equals; else 0.
PetscErrorCode fill_phase(const Grid &grid, const SpeciesSpec &spec, const std::vector<BodyPlace> &places,
                          int first_label, Phase *phase);

/// Fills phi, B and label of phases that fill_phase() has made anew: body b of `places` goes to phases[colour[b]].
void refill_phases(const Grid &grid, const SpeciesSpec &spec, const std::vector<BodyPlace> &places, int first_label,
                   const std::vector<int> &colour, std::vector<Phase> *phases);

/// B = diag(initial_stretch^2) in cells with phi > 0, I elsewhere and in bodies without modulus.
void stretch_phase(const Grid &grid, const SpeciesSpec &spec, Phase *phase);

}  // namespace eulastic
