// Initial values of a phase: solid fraction, left Cauchy-Green tensor and labels of placed bodies.
#pragma once

#include "base/petsc.hpp"
#include "bodies/placement.hpp"
#include "bodies/shapes.hpp"
#include "field/phase.hpp"
#include "grid/domain.hpp"

namespace eulastic {

/// Allocates `phase` and fills its owned cells from the bodies of `places`, of which all near this rank must be known;
/// the caller updates ghosts. The fraction of a cell is that of the body with the largest one; equal bodies: the first.
/// Tensor: B = R diag(initial_stretch^2) R^T, with the body's rotation R, in cells with phi > 0 and on edges beside
/// them, I elsewhere. Label: first_label + index of that body where phi > 0, otherwise 0; first_label >= 1.
PetscErrorCode fill_phase(const Domain &domain, const SpeciesSpec &spec, const Places &places, int first_label,
                          Phase *phase);

/// Returns the box of a placed body: the cells that it may touch and `around` more at each end, cut at non-periodic
/// boundaries of the domain and not wrapped around periodic ones.
Box box_of_body(const DomainShape &domain, const Surface &surface, const BodyPlace &place, int around, int ghosts);
/// Returns a phase on the box of a body that holds this body only, as fill_phase() fills it, without labels.
Phase fill_body(const Box &box, const SpeciesSpec &spec, const Surface &surface, const BodyPlace &place);

/// Fills fraction and label of bodies that carry no B.
void fill_bodies(const Domain &domain, const Surface &surface, const Places &places, int first_label, Phase *phase);

/// Sets B = diag(initial_stretch^2) in cells with phi > 0, and I elsewhere and in bodies without a modulus.
void stretch_phase(const Box &box, const SpeciesSpec &spec, Phase *phase);

}  // namespace eulastic
