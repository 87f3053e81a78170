// The region in which bodies may be placed: the domain without slabs, or the lumen of a tube; in both cases without the
// cells of bodies from files.
#pragma once

#include "bodies/convex.hpp"
#include "bodies/placement.hpp"
#include "bodies/solid_mask.hpp"

#include <vector>

namespace eulastic {

class Region {
public:
  /// Excludes all slabs of `species` and the cylinders of the species that have `places`. `vessel`: a tube, or null.
  /// The arguments must outlive the region. `margin`: distance that bodies keep from boundaries, slabs and the lumen's
  /// wall.
  Region(const std::vector<SpeciesSpec> &species, const std::vector<Places> &places, const SpeciesSpec *vessel,
         const SolidBodies &solids, const DomainShape &grid, double margin);

  /// Volume (area in 2-D) of the lumen, or of the domain without slabs; without bodies from files.
  double volume() const { return volume_; }
  /// Bounding box, and whether the region ends along d at a round wall rather than at a boundary.
  double low(int d) const { return low_[d]; }
  double high(int d) const { return high_[d]; }
  bool is_round(int d) const { return vessel_ && d != vessel_->axis; }
  /// Whether a body whose centre is in the domain lies inside, without touching walls, slabs and cylinders.
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
  double volume_;
  std::vector<const SpeciesSpec *> slabs_;
  std::vector<ConvexBody> cylinder_shapes_;
  std::vector<PlacedConvex> cylinders_;
};

}  // namespace eulastic
