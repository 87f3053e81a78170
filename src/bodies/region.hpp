// Where bodies may be: the box less slabs, or the lumen of a tube; both without the cells of bodies from files.
#pragma once

#include "bodies/convex.hpp"
#include "bodies/placement.hpp"
#include "bodies/solid_mask.hpp"

#include <vector>

namespace eulastic {

class Region {
public:
  /// All slabs of `species` and the cylinders among those with `places`. `vessel`: one of the tubes, or null. All must
  /// stay. `margin`: what bodies keep free beside sides of the box, slabs and the lumen's wall.
  Region(const std::vector<SpeciesSpec> &species, const std::vector<Places> &places, const SpeciesSpec *vessel,
         const SolidBodies &solids, const DomainShape &grid, double margin);

  /// Volume (area in 2-D) of the lumen, or of the box less slabs; less bodies from files.
  double volume() const { return volume_; }
  /// The box around it, and whether it ends at the sides of the box of the grid rather than at a round wall.
  double low(int d) const { return low_[d]; }
  double high(int d) const { return high_[d]; }
  bool is_round(int d) const { return vessel_ && d != vessel_->axis; }
  /// Whether a body with its centre in the box is inside and clear of walls, slabs and cylinders.
  bool holds(const PlacedConvex &body) const;

private:
  bool in_lumen(const PlacedConvex &body) const;
  bool clear_of_slabs(const PlacedConvex &body) const;
  bool clear_of_cylinders(const PlacedConvex &body) const;

  DomainShape grid_;
  int dimension_;
  const SpeciesSpec *vessel_;
  const SolidBodies &solids_;
  double margin_;
  Real3 low_{}, high_{};
  double volume_ = 1;
  std::vector<const SpeciesSpec *> slabs_;
  std::vector<ConvexBody> cylinder_shapes_;
  std::vector<PlacedConvex> cylinders_;
};

}  // namespace eulastic
