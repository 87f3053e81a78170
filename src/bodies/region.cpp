#include "bodies/region.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {

Region::Region(const std::vector<SpeciesSpec> &species, const std::vector<Places> &places, const SpeciesSpec *vessel,
               const SolidBodies &solids, const DomainShape &grid, double margin)
    : grid_(grid),
      dimension_(grid.dimension()),
      vessel_(vessel),
      solids_(solids),
      margin_(margin * (1 - 1e-9)),  // bodies exactly at the margin count as inside despite round-off
      high_(grid.length) {
  cylinder_shapes_.reserve(species.size());  // bodies keep pointers to its elements
  volume_ = grid.volume() - solids.volume;
  for (std::size_t s = 0; s < species.size(); ++s) {
    const SpeciesSpec &other = species[s];
    if (other.shape == Shape::slab) {
      slabs_.push_back(&other);
      volume_ -= volume_in_box(other, grid);
      if (other.interval[0] <= 0) low_[other.axis] = std::max(low_[other.axis], other.interval[1]);
      if (other.interval[1] >= grid.length[other.axis])
        high_[other.axis] = std::min(high_[other.axis], other.interval[0]);
    }
    if (other.shape == Shape::cylinder && s < places.size()) {
      cylinder_shapes_.emplace_back(other, dimension_, 0, grid.length[other.axis]);
      for (const BodyPlace &place : places[s].known)
        cylinders_.push_back({&cylinder_shapes_.back(), place.centre, rotation(place.orientation)});
    }
  }
  for (int d = 0; d < dimension_; ++d) {
    const double beside = grid.boundary[d] == Boundary::wall ? margin : 0;
    low_[d] = std::max(low_[d], solids.free[d][0]) + beside;
    high_[d] = std::min(high_[d], grid.length[d] - solids.free[d][1]) - beside;
  }
  if (!vessel) return;
  volume_ = lumen_volume(*vessel, grid) - solids.volume;
  for (int d = 0; d < dimension_; ++d) {
    if (d == vessel->axis) continue;
    low_[d] = std::max(low_[d], vessel->centre[d] - vessel->radius + margin);
    high_[d] = std::min(high_[d], vessel->centre[d] + vessel->radius - margin);
  }
}

bool Region::holds(const PlacedConvex &body) const {
  const double outer = body.body->outer_radius();
  for (int d = 0; d < dimension_; ++d) {
    const double x = body.centre[d], length = grid_.length[d];
    const double low = solids_.free[d][0] + margin_, high = length - solids_.free[d][1] - margin_;
    const bool wall = grid_.boundary[d] == Boundary::wall;
    if (wall ? x - outer >= low && x + outer <= high : 2 * outer <= length) continue;
    const double half = body.half_width(d);
    if (wall ? x - half < low || x + half > high : 2 * half > length) return false;
  }
  for (const SolidMask &mask : solids_.masks)
    if (mask.touches(body)) return false;
  return (!vessel_ || in_lumen(body)) && clear_of_slabs(body) && clear_of_cylinders(body);
}

// Compares the support functions of body and lumen in many directions across the axis. Where the lumen narrows, its
// radius at the body's end towards the throat is used.
bool Region::in_lumen(const PlacedConvex &body) const {
  constexpr int directions = 64;
  const double along = body.centre[vessel_->axis] - vessel_->centre[vessel_->axis];
  double radius = lumen_radius(*vessel_, std::max(0.0, std::abs(along) - body.half_width(vessel_->axis))) - margin_;
  const int a = (vessel_->axis + 1) % 3, b = (vessel_->axis + 2) % 3;
  Real3 r{};
  for (int d : {a, b})
    if (d < dimension_) r[d] = body.centre[d] - vessel_->centre[d];
  const double distance = std::hypot(r[a], r[b]);
  if (distance + body.body->outer_radius() <= radius) return true;
  if (distance + body.body->inner_radius() > radius) return false;
  radius *= std::cos(3.14159265358979323846 / directions);  // covers normals between two directions
  for (int s = 0; s < directions; ++s) {
    const double angle = 2 * 3.14159265358979323846 * s / directions;
    Real3 n{};
    n[a] = std::cos(angle);
    n[b] = std::sin(angle);
    if (dimension_ == 2 && vessel_->axis != 2) {  // a channel has two walls
      n = {};
      n[1 - vessel_->axis] = s % 2 ? 1 : -1;
    }
    if (r[a] * n[a] + r[b] * n[b] + body.support(n) > radius) return false;
  }
  return true;
}

bool Region::clear_of_slabs(const PlacedConvex &body) const {
  for (const SpeciesSpec *slab : slabs_) {
    const int d = slab->axis;
    const double half = body.half_width(d) + margin_;
    for (int image = -1; image <= 1; ++image) {
      if (image != 0 && grid_.boundary[d] == Boundary::wall) continue;
      const double x = body.centre[d] + image * grid_.length[d];
      if (x + half > slab->interval[0] && x - half < slab->interval[1]) return false;
    }
  }
  return true;
}

bool Region::clear_of_cylinders(const PlacedConvex &body) const {
  const auto images = [&](int d) { return d < dimension_ && grid_.boundary[d] == Boundary::periodic ? 1 : 0; };
  for (const PlacedConvex &cylinder : cylinders_)
    for (int i = -images(0); i <= images(0); ++i)
      for (int j = -images(1); j <= images(1); ++j)
        for (int k = -images(2); k <= images(2); ++k)
          if (!separated(cylinder, body, {i * grid_.length[0], j * grid_.length[1], k * grid_.length[2]})) return false;
  return true;
}

}  // namespace eulastic
