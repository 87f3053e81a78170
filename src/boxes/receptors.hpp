// Receptors on bodies in boxes: their initial positions, and their motion with the surface.
#pragma once

#include "field/phase.hpp"
#include "field/receptor.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace eulastic {

/// Places receptors on the surface of a body, `density` per area. Their number and positions depend only on the seed,
/// the number and the shape of the body.
void place_receptors(const BodyInBox &body, double density, std::uint32_t seed, std::vector<Receptor> *receptors);

/// Moves receptors by the midpoint rule with a velocity on the faces of a box, with one valid ghost layer behind
/// boundaries, and projects them onto the surface of the body, whose phi has been advanced already.
void move_receptors(const Box &box, double dt, const Field &velocity, const Phase &phase,
                    std::vector<Receptor> *receptors);

/// The positions through which a receptor is attached to its body, and their weights: the receptor moves with the
/// weighted sum of the velocities there, and a force on it acts there with the same weights.
struct Attachment {
  struct Point {
    Real3 place;
    double weight;
  };
  std::array<Point, 2> points;
  int count;

  const Point *begin() const { return points.data(); }
  const Point *end() const { return points.data() + count; }
};
/// Returns the attachment of a receptor at a position: in an elastic solid two points inside the body, from which the
/// velocity is extrapolated linearly to the receptor, so that force and torque on the body are those of a force at the
/// receptor; on a membrane or a drop the receptor's position itself.
Attachment attachment_of(const Box &box, const Phase &phase, const Real3 &place);

/// Returns the vector from a position near the surface phi = 1/2 to it along the gradient of phi, of at most a quarter
/// of a cell; 0 where phi has no gradient.
Real3 way_to_surface(const Box &box, const Phase &phase, const Real3 &place);

}  // namespace eulastic
