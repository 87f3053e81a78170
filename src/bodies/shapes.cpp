#include "bodies/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace eulastic {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr Real3 red_cell{red_cell_waist, 2.002558, -1.122762};
// Upper bound of |d/dq [(1-q) P(q)^2]| for 0 <= q <= 1, with P(q) = red_cell[0] + q (red_cell[1] + q red_cell[2]); for
// q > 1 level() is linear in q.
constexpr double red_cell_slope = 1.23;

double profile(double q) noexcept { return red_cell[0] + q * (red_cell[1] + q * red_cell[2]); }

// Returns R minus the lumen's radius at distance s from the throat.
double narrowing(double depth, double throat, double s) noexcept {
  return depth > 0 && 2 * std::abs(s) < throat ? depth * (1 + std::cos(2 * pi * s / throat)) / 2 : 0;
}

struct Turn {
  double c, s;
};

Turn turn(double degrees) {
  const double angle = std::abs(degrees) <= 180 ? degrees : std::remainder(degrees, 360.0);  // the latter is slow
  if (const int quarter = static_cast<int>(angle / 90.0); angle == 90.0 * quarter) {
    return {quarter == 0 ? 1.0 : std::abs(quarter) == 2 ? -1.0 : 0.0, std::abs(quarter) == 1 ? double(quarter) : 0.0};
  }
  return {std::cos(angle * (pi / 180)), std::sin(angle * (pi / 180))};
}

// Points of the surface of a biconcave disc of radius 1, between its axis and its rim.
struct RimPoint {
  double sine, cosine, thickness;
};
const std::vector<RimPoint> &rim_points() {
  constexpr int samples = 512;
  static const std::vector<RimPoint> points = [] {
    std::vector<RimPoint> all;
    for (int s = 0; s <= samples; ++s) {
      const double sine = std::sin(pi / 2 * s / samples);
      all.push_back({sine, std::cos(pi / 2 * s / samples), profile(sine * sine)});
    }
    return all;
  }();
  return points;
}

}  // namespace

Rotation rotation(const Real3 &degrees) {
  const Turn x = turn(degrees[0]), y = turn(degrees[1]), z = turn(degrees[2]);
  return {{{z.c * y.c, z.c * y.s * x.s - z.s * x.c, z.c * y.s * x.c + z.s * x.s},
           {z.s * y.c, z.s * y.s * x.s + z.c * x.c, z.s * y.s * x.c - z.c * x.s},
           {-y.s, y.c * x.s, y.c * x.c}}};
}

Real3 turned(const Real3 &degrees, const Real3 &angle) {
  const double size = std::sqrt(angle[0] * angle[0] + angle[1] * angle[1] + angle[2] * angle[2]);
  if (size == 0) return degrees;
  const Rotation start = rotation(degrees);
  const double c = std::cos(size), s = std::sin(size) / size, q = (1 - c) / (size * size);
  Rotation by, R{};
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, e = (a + 2) % 3;
    by[a][a] = c + q * angle[a] * angle[a];
    by[b][e] = q * angle[b] * angle[e] - s * angle[a];
    by[e][b] = q * angle[b] * angle[e] + s * angle[a];
  }
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) R[a][b] = by[a][0] * start[0][b] + by[a][1] * start[1][b] + by[a][2] * start[2][b];
  const double across = std::hypot(R[0][0], R[1][0]);
  if (across < 1e-9)  // gimbal lock: x and z rotate about the same line
    return {std::atan2(-R[1][2], R[1][1]) * (180 / pi), R[2][0] > 0 ? -90.0 : 90.0, 0};
  return {std::atan2(R[2][1], R[2][2]) * (180 / pi), std::atan2(-R[2][0], across) * (180 / pi),
          std::atan2(R[1][0], R[0][0]) * (180 / pi)};
}

Surface::Surface(LevelMap map)
    : shape_(Shape::voxels),
      axis_(0),
      radius_(infinity),
      inverse_{},
      map_(std::make_shared<const LevelMap>(std::move(map))) {}

Surface::Surface(const SpeciesSpec &spec, int dimension)
    : shape_(spec.shape), axis_(spec.axis), radius_(infinity), inverse_{} {
  if (is_tube(shape_)) {
    radius_ = spec.radius;
    for (int d = 0; d < dimension; ++d) inverse_[d] = d == axis_ ? 0 : 1;
    if (shape_ == Shape::constricted_tube) depth_ = radius_ - spec.throat_radius, throat_ = spec.throat_length;
    return;
  }
  for (int d = 0; d < dimension; ++d) {
    double semi_axis = spec.radius;
    if (spec.shape == Shape::ellipsoid) semi_axis = spec.semi_axes[d];
    if (spec.shape == Shape::slab) semi_axis = d == axis_ ? (spec.interval[1] - spec.interval[0]) / 2 : infinity;
    if (spec.shape == Shape::cylinder && d == axis_) semi_axis = infinity;
    inverse_[d] = 1 / semi_axis;
    radius_ = std::min(radius_, semi_axis);
  }
}

double Surface::level(const Real3 &y) const noexcept {
  if (map_) return map_->level(y);
  if (shape_ == Shape::biconcave) {
    // z^2 - h(r)^2/4: a polynomial, also at the rim where h has a vertical tangent; linear in q outside the rim.
    const double z = y[axis_], b = y[(axis_ + 1) % 3], c = y[(axis_ + 2) % 3];
    const double q = (b * b + c * c) / (radius_ * radius_), p = profile(std::min(q, 1.0));
    return z * z - radius_ * radius_ * (1 - q) * p * p / 4;
  }
  const double a = y[0] * inverse_[0], b = y[1] * inverse_[1], c = y[2] * inverse_[2];
  if (is_tube(shape_)) return radius_ - narrowing(depth_, throat_, y[axis_]) - std::sqrt(a * a + b * b + c * c);
  return (std::sqrt(a * a + b * b + c * c) - 1) * radius_;
}

double Surface::slope(const Real3 &y, double reach) const noexcept {
  if (map_) return map_->slope();
  if (is_tube(shape_)) return std::hypot(1.0, depth_ * pi / throat_);
  if (shape_ != Shape::biconcave) return 1;  // |grad| <= radius_ / shortest semi-axis
  const double b = y[(axis_ + 1) % 3], c = y[(axis_ + 2) % 3];
  const double z = 2 * (std::abs(y[axis_]) + reach);
  const double r = red_cell_slope / 2 * (std::sqrt(b * b + c * c) + reach);
  return std::sqrt(z * z + r * r);
}

double Surface::support(const Real3 &n) const {
  if (map_) return map_->support(n);
  if (is_tube(shape_)) return infinity;
  if (shape_ == Shape::biconcave) {
    const double along = std::abs(n[axis_]), across = std::sqrt(std::max(0.0, 1 - along * along));
    double best = 0;
    for (const RimPoint &point : rim_points())
      best = std::max(best, across * point.sine + along * point.cosine * point.thickness / 2);
    return radius_ * (best + 3e-6);
  }
  double square = 0;
  for (int d = 0; d < 3; ++d)
    if (n[d] != 0) square += n[d] * n[d] / (inverse_[d] * inverse_[d]);
  return std::sqrt(square);
}

double Surface::bounding_radius() const {
  if (map_) return map_->bounding_radius();
  if (shape_ == Shape::biconcave) return radius_;
  if (is_tube(shape_)) return infinity;
  double radius = 0;
  for (int d = 0; d < 3; ++d) radius = std::max(radius, 1 / inverse_[d]);
  return radius;
}

double shape_volume(const SpeciesSpec &spec, int dimension) {
  const double r = spec.radius;
  const Real3 &c = red_cell;
  const bool flat = dimension == 2;
  switch (spec.shape) {
    case Shape::sphere:
      return flat ? pi * r * r : 4 * pi / 3 * r * r * r;
    case Shape::ellipsoid:
      return flat ? pi * spec.semi_axes[0] * spec.semi_axes[1]
                  : 4 * pi / 3 * spec.semi_axes[0] * spec.semi_axes[1] * spec.semi_axes[2];
    case Shape::biconcave:
      return flat ? pi * r * r * (c[0] / 2 + c[1] / 8 + c[2] / 16)
                  : pi * r * r * r * (2 * c[0] / 3 + 4 * c[1] / 15 + 16 * c[2] / 105);
    case Shape::cylinder:
      return flat && spec.axis != 2 ? 2 * r : pi * r * r;
    case Shape::slab:
      return spec.interval[1] - spec.interval[0];
    case Shape::tube:
    case Shape::constricted_tube:
    case Shape::voxels:
    case Shape::state:
      return 0;
  }
  return 0;
}

double lumen_radius(const SpeciesSpec &spec, double s) {
  const bool constricted = spec.shape == Shape::constricted_tube;
  return spec.radius - (constricted ? narrowing(spec.radius - spec.throat_radius, spec.throat_length, s) : 0);
}

double lumen_volume(const SpeciesSpec &spec, const DomainShape &grid) {
  const bool flat = grid.dimension() == 2;
  const double r = spec.radius, length = flat && spec.axis == 2 ? 1 : grid.length[spec.axis];
  const double depth = r - lumen_radius(spec, 0), throat = spec.throat_length;
  if (flat && spec.axis != 2) return 2 * (r * length - depth * throat / 2);
  return pi * (r * r * length - depth * throat * (r - 3 * depth / 8));  // means of (1 + cos)/2 and its square: 1/2, 3/8
}

double lumen_resistance(const SpeciesSpec &spec, const DomainShape &grid) {
  const bool flat = grid.dimension() == 2;
  const auto inverse = [flat](double r) { return flat ? 1.5 / (r * r * r) : 8 / (pi * r * r * r * r); };
  const double length = grid.length[spec.axis];
  if (spec.shape != Shape::constricted_tube) return length * inverse(spec.radius);
  constexpr int pieces = 256;  // over one period of the throat the midpoint rule is exact to round-off
  double sum = 0;
  for (int n = 0; n < pieces; ++n) sum += inverse(lumen_radius(spec, spec.throat_length * ((n + 0.5) / pieces - 0.5)));
  return (length - spec.throat_length) * inverse(spec.radius) + spec.throat_length * (sum / pieces);
}

double volume_in_box(const SpeciesSpec &spec, const DomainShape &grid) {
  const int dimension = grid.dimension();
  const double box = grid.volume();
  if (is_tube(spec.shape)) return box - lumen_volume(spec, grid);
  if (spec.shape == Shape::slab)
    return box / grid.length[spec.axis] *
           (std::min(grid.length[spec.axis], spec.interval[1]) - std::max(0.0, spec.interval[0]));
  const bool extends = spec.shape == Shape::cylinder && spec.axis < dimension;
  return (extends ? grid.length[spec.axis] : 1) * shape_volume(spec, dimension);
}

}  // namespace eulastic
