// Receptors: material points on the surfaces of bodies in boxes, each of which can hold one bond. Every rank knows all
// of them, the same values, so that chance and the order of sums do not depend on ranks.
#pragma once

#include "adhesion/adhesion_pair.hpp"
#include "boxes/boxed_bodies.hpp"

namespace eulastic {

struct Receptor {
  static constexpr double none = -2, wall = -1;
  double body, species;   ///< number of its body (0: the body has left), index of the species
  double place[3];        ///< not wrapped around periodic sides
  double partner = none;  ///< index of the receptor that it is bound to; `wall`: bound to `anchor`
  double pair = 0;        ///< of AdhesionSpec::pairs, while bound
  double anchor[3]{};     ///< on a wall or a surface of the grid
  double since = 0;       ///< time of formation

  bool alive() const { return body > 0; }
  bool is_bound() const { return partner != none; }
};

/// Those of all bodies that adhere, body after body; how many an area gets and where depends on seed, number and shape
/// of the body alone. Collective.
PetscErrorCode place_receptors(const AdhesionSpec &spec, const Domain &domain, const std::vector<BodyInBox> &bodies,
                               std::vector<Receptor> *receptors);

/// Where the surface is, phi = 1/2, seen from a place near it: the way there along the gradient of phi, at most a
/// quarter of a cell; 0 where phi has no gradient.
Real3 way_to_surface(const BodyInBox &body, const double place[3]);

}  // namespace eulastic
