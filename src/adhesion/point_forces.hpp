// Forces of bonds on the flow, at points.
#pragma once

#include "field/net_force.hpp"
#include "parts/flow.hpp"

#include <vector>

namespace eulastic {

struct PointForce {
  int body, receptor;  ///< receptor of the bond
  int point;           ///< where it acts: on_surface, or a point of the receptor's attachment
  Real3 place;         ///< need not be wrapped into the domain
  Real3 force;
  static constexpr int on_surface = -1;  ///< at the other end of the bond, on a surface on the grid
};

/// The point forces that act on the faces of this rank, in an order that does not depend on the ranks they come from.
class PointForces {
public:
  explicit PointForces(const Flow &flow) : flow_(flow) {}
  /// Sends forces to the ranks whose faces they act on, and replaces all earlier ones. Collective.
  PetscErrorCode set(std::vector<PointForce> forces);
  /// Adds factor times the force per mass to fields, on owned faces.
  void add(const std::vector<WeightedTarget> &targets) const;
  /// Marks rows of owned cells that the forces act on.
  void mark_rows(std::vector<char> *rows) const;
  /// Adds the power of the forces on the flow. Collective.
  PetscErrorCode add_power(double *power) const;
  std::size_t bytes() const { return forces_.size() * sizeof(PointForce); }

private:
  template <class Visit>
  void for_faces(const PointForce &force, int a, const Visit &visit) const;

  const Flow &flow_;
  std::vector<PointForce> forces_;
};

}  // namespace eulastic
