// A phase at the start: solid fraction, left Cauchy-Green tensor and labels of placed bodies.
#pragma once

#include "base/petsc.hpp"
#include "bodies/placement.hpp"
#include "bodies/shapes.hpp"
#include "field/phase.hpp"
#include "grid/domain.hpp"

namespace eulastic {

/// Allocates `phase` and fills its owned cells with the bodies of `places` that come near them, which must be known;
/// ghosts are the caller's. Fraction: of the fullest body of a cell.
/// Tensor: B = R diag(initial_stretch^2) R^T, R the body's orientation, in cells with phi > 0 and on edges beside them,
/// I elsewhere. Label: first_label + index of the fullest body (first_label >= 1) where phi > 0, the first of equals;
/// else 0.
PetscErrorCode fill_phase(const Domain &domain, const SpeciesSpec &spec, const Places &places, int first_label,
                          Phase *phase);

/// The box of a placed body, cut at sides of the domain: cells that it may touch, the last of which it does not reach,
/// and `around` more at each end, not wrapped around periodic sides.
Box box_of_body(const DomainShape &domain, const Surface &surface, const BodyPlace &place, int around, int ghosts);
/// Allocates a phase on the box of a body, with that body alone, as fill_phase() does; no label.
Phase fill_body(const Box &box, const SpeciesSpec &spec, const Surface &surface, const BodyPlace &place);

/// Of bodies that carry no B: the fraction and the label.
void fill_bodies(const Domain &domain, const Surface &surface, const Places &places, int first_label, Phase *phase);

/// B = diag(initial_stretch^2) in cells with phi > 0, I elsewhere and in bodies without modulus.
void stretch_phase(const Box &box, const SpeciesSpec &spec, Phase *phase);

}  // namespace eulastic
