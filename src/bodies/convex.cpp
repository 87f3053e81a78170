#include "bodies/convex.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

double dot(const Real3 &a, const Real3 &b) noexcept { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Returns the radius of the flat disc that, rounded by half the thickness, encloses the red cell.
double flat_radius(const Surface &surface, int axis, double half_thickness) {
  double radius = 0;
  constexpr int samples = 256;
  for (int s = 2; s <= samples; ++s) {
    const double angle = 1.5707963267948966 * s / samples;
    Real3 n{};
    n[axis] = std::cos(angle);
    n[(axis + 1) % 3] = std::sin(angle);
    radius = std::max(radius, (surface.support(n) - half_thickness) / std::sin(angle));
  }
  return 1.0001 * radius;  // bounds the values between samples
}

// Returns the farthest point of the core in direction n of the domain, relative to the centre of the body.
Real3 core_point(const PlacedConvex &p, const Real3 &n) noexcept {
  const Rotation &q = p.rotation;
  Real3 inner;
  for (int d = 0; d < 3; ++d) inner[d] = q[0][d] * n[0] + q[1][d] * n[1] + q[2][d] * n[2];
  const Real3 y = p.body->core(inner);
  return {dot(q[0], y), dot(q[1], y), dot(q[2], y)};
}

// A simplex of points of the Minkowski difference of two bodies, each with the point of the first body that it stems
// from.
struct Simplex {
  using Point = std::array<Real3, 2>;
  std::array<Point, 4> points;
  std::array<double, 4> part;  // barycentric coordinates of the point nearest to the origin
  int count;

  Real3 nearest(int which) const noexcept {
    Real3 sum{};
    for (int n = 0; n < count; ++n)
      for (int d = 0; d < 3; ++d) sum[d] += part[n] * points[n][which][d];
    return sum;
  }

  // Adds a point and reduces the simplex to its corner, edge or face nearest to the origin.
  void add(const Point &point) noexcept {
    points[count++] = point;
    Simplex best = *this;
    double least = -1;
    for (int set = 1; set < 1 << count; ++set) {
      Simplex face{points, {1}, 0};
      for (int n = 0; n < count; ++n)
        if (set >> n & 1) face.points[face.count++] = points[n];
      if (face.count > 3 || !face.find_parts()) continue;
      const Real3 v = face.nearest(0);
      if (least >= 0 && dot(v, v) >= least) continue;
      least = dot(v, v);
      best = face;
    }
    *this = best;
  }

private:
  // Computes the barycentric coordinates of the nearest point to the origin of the affine hull; returns whether it lies
  // between the points.
  bool find_parts() noexcept {
    part = {1};
    if (count == 1) return true;
    Real3 p = points[0][0], e{}, f{};
    for (int d = 0; d < 3; ++d) e[d] = points[1][0][d] - p[d];
    const double ee = dot(e, e), ep = dot(e, p);
    if (count == 2) {
      part[1] = ee > 0 ? -ep / ee : -1;
    } else {
      for (int d = 0; d < 3; ++d) f[d] = points[2][0][d] - p[d];
      const double ff = dot(f, f), ef = dot(e, f), fp = dot(f, p), area = ee * ff - ef * ef;
      if (!(area > 1e-12 * ee * ff)) return false;
      part[1] = (ef * fp - ff * ep) / area;
      part[2] = (ef * ep - ee * fp) / area;
    }
    part[0] = 1 - part[1] - part[2];
    return part[0] >= 0 && part[1] >= 0 && part[2] >= 0;
  }
};

}  // namespace

ConvexBody::ConvexBody(const SpeciesSpec &spec, int dimension, double margin, double length)
    : kind_(Kind::ellipsoid), axis_(spec.axis), rounding_(spec.radius), outer_(spec.radius), inner_(spec.radius) {
  if (spec.shape == Shape::cylinder) {
    kind_ = Kind::segment;
    size_[0] = length;
    outer_ += length;
  } else if (spec.shape == Shape::biconcave) {
    const Surface surface(spec, 3);
    Real3 n{};
    n[axis_] = 1;
    kind_ = Kind::disc;
    rounding_ = inner_ = surface.support(n);
    size_[0] = flat_radius(surface, axis_, rounding_);
    outer_ = size_[0] + rounding_;
  } else if (spec.shape == Shape::ellipsoid) {
    Real3 a = spec.semi_axes;
    inner_ = dimension == 2 ? std::min(a[0], a[1]) : std::min({a[0], a[1], a[2]});
    if (dimension == 2) a[2] = inner_;
    outer_ = std::max({a[0], a[1], a[2]});
    rounding_ = inner_ / 2;
    for (int d = 0; d < 3; ++d) size_[d] = a[d] - rounding_;
  }
  rounding_ += margin;
  outer_ += margin;
  inner_ += margin;
}

ConvexBody::ConvexBody(const Real3 &half_sides)
    : kind_(Kind::box), size_(half_sides), rounding_(0), outer_(std::sqrt(dot(half_sides, half_sides))) {
  inner_ = half_sides[2] > 0 ? std::min({half_sides[0], half_sides[1], half_sides[2]})
                             : std::min(half_sides[0], half_sides[1]);
}

ConvexBody ConvexBody::scaled(double factor) const {
  ConvexBody body = *this;
  for (double &size : body.size_) size *= factor;
  for (double *radius : {&body.rounding_, &body.outer_, &body.inner_}) *radius *= factor;
  return body;
}

Real3 ConvexBody::core(const Real3 &n) const noexcept {
  if (kind_ == Kind::ellipsoid) {
    const Real3 a{size_[0] * n[0], size_[1] * n[1], size_[2] * n[2]};
    const double norm = std::sqrt(dot(a, a));
    if (norm == 0) return {};
    return {size_[0] * a[0] / norm, size_[1] * a[1] / norm, size_[2] * a[2] / norm};
  }
  Real3 y{};
  if (kind_ == Kind::box) {
    for (int d = 0; d < 3; ++d) y[d] = std::copysign(size_[d], n[d]);
    return y;
  }
  if (kind_ == Kind::segment) {
    y[axis_] = std::copysign(size_[0], n[axis_]);
    return y;
  }
  const int b = (axis_ + 1) % 3, c = (axis_ + 2) % 3;
  const double across = std::sqrt(n[b] * n[b] + n[c] * n[c]);
  if (across < 1e-12 * std::abs(n[axis_])) return y;
  y[b] = size_[0] * n[b] / across;
  y[c] = size_[0] * n[c] / across;
  return y;
}

double PlacedConvex::half_width(int d) const noexcept {
  return dot(body->core(rotation[d]), rotation[d]) + body->rounding();
}

double PlacedConvex::support(const Real3 &n) const noexcept { return dot(core_point(*this, n), n) + body->rounding(); }

// Gilbert's algorithm (SIAM J. Control 4, 1966) on the Minkowski difference of the cores: v converges to its point
// nearest to the origin; v.w/|v| is a lower bound of the distance and |v| an upper bound.
bool separated(const PlacedConvex &a, const PlacedConvex &b, const Real3 &shift) noexcept {
  Real3 v;
  for (int d = 0; d < 3; ++d) v[d] = b.centre[d] + shift[d] - a.centre[d];
  const Real3 centre = v;
  const double outer = a.body->outer_radius() + b.body->outer_radius();
  const double inner = a.body->inner_radius() + b.body->inner_radius();
  const double margin = a.body->rounding() + b.body->rounding();
  double square = dot(v, v);
  if (square > outer * outer) return true;
  if (square < inner * inner) return false;
  for (int turn = 0; turn < 40; ++turn) {
    const Real3 from = core_point(a, v), to = core_point(b, {-v[0], -v[1], -v[2]});
    Real3 w, step;
    for (int d = 0; d < 3; ++d) w[d] = centre[d] + to[d] - from[d], step[d] = w[d] - v[d];
    const double least = dot(v, w);
    if (least > margin * std::sqrt(square)) return true;
    const double slope = dot(v, step), length = dot(step, step);
    if (!(slope < 0)) return false;
    const double t = std::min(1.0, -slope / length);
    for (int d = 0; d < 3; ++d) v[d] += t * step[d];
    square = dot(v, v);
    if (square <= margin * margin) return false;
  }
  return false;
}

// The algorithm of Gilbert, Johnson and Keerthi (IEEE J. Robotics and Automation 4, 1988), which flat bodies side by
// side need for convergence: v is the point of the present simplex nearest to the origin.
Penetration penetration(const PlacedConvex &a, const PlacedConvex &b, const Real3 &shift) noexcept {
  constexpr double converged = 1e-4, cores_meet = 1e-3;  // relative to the square; to the margin
  Real3 v;
  for (int d = 0; d < 3; ++d) v[d] = b.centre[d] + shift[d] - a.centre[d];
  const Real3 centre = v;
  const double outer = a.body->outer_radius() + b.body->outer_radius();
  const double margin = a.body->rounding() + b.body->rounding();
  if (dot(v, v) > outer * outer) return {};
  Simplex simplex{{{v, {}}}, {1}, 1};
  double square = dot(v, v);
  for (int turn = 0; turn < 40 && square > cores_meet * cores_meet * margin * margin; ++turn) {
    const Real3 from = core_point(a, v), to = core_point(b, {-v[0], -v[1], -v[2]});
    Real3 w;
    for (int d = 0; d < 3; ++d) w[d] = centre[d] + to[d] - from[d];
    const double least = dot(v, w);
    if (least > margin * std::sqrt(square)) return {};
    if (square - least < converged * square) break;
    simplex.add({w, from});
    v = simplex.nearest(0);
    if (!(dot(v, v) < square)) break;  // round-off
    square = dot(v, v);
  }
  Penetration found;
  const Real3 on_a = simplex.nearest(1);
  double distance = std::sqrt(square);
  found.depth = std::max(margin - distance, 1e-4 * margin);
  if (distance <= cores_meet * margin) v = centre, distance = std::sqrt(dot(v, v));
  for (int d = 0; d < 3; ++d) {
    found.normal[d] = distance > 0 ? v[d] / distance : d == 0;
    found.point[d] = on_a[d] + found.normal[d] * (a.body->rounding() - found.depth / 2);
  }
  return found;
}

}  // namespace eulastic
