#include "bodies/level_map.hpp"

#include "kernels/bending.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

constexpr double variance = 1.15;  // of filter and cell average, in h^2; a second filter adds 1
constexpr double far = 3;          // filter widths at which levels are clipped

// Applies the weights (1, 4, 6, 4, 1)/16 along every direction; two points at each end stay unchanged.
std::vector<double> smooth(const Int3 &size, std::vector<double> from, int dimension) {
  const std::ptrdiff_t stride[3] = {1, size[0], std::ptrdiff_t(size[0]) * size[1]};
  for (int d = 0; d < dimension; ++d) {
    std::vector<double> to = from;
    const std::ptrdiff_t s = stride[d];
    for (std::ptrdiff_t at = 0; at < std::ptrdiff_t(from.size()); ++at)
      if (const std::ptrdiff_t i = at / s % size[d]; i >= 2 && i < size[d] - 2) {
        const double *q = &from[at];
        to[at] = (6 * q[0] + 4 * (q[-s] + q[s]) + (q[-2 * s] + q[2 * s])) / 16;
      }
    from.swap(to);
  }
  return from;
}

}  // namespace

// A filter shifts a surface by half its variance times the curvature, and two filters by more; extrapolating from both
// gives the level of the unfiltered surface, as in membranes/surface_cells.cpp.
LevelMap::LevelMap(const FractionBox &box, int dimension)
    : dimension_(dimension), size_(box.size), spacing_(box.spacing), first_(box.first) {
  const std::vector<double> once = smooth(size_, box.fraction, dimension), twice = smooth(size_, once, dimension);
  const double ratio = std::sqrt((variance + 1) / variance);
  double finest = spacing_[0];
  for (int d = 1; d < dimension; ++d) finest = std::min(finest, spacing_[d]);
  level_.resize(once.size());
  for (std::size_t at = 0; at < once.size(); ++at) {
    const double z = kernels::surface_level(once[at]), moved = z - ratio * kernels::surface_level(twice[at]);
    level_[at] = finest * std::clamp(std::fabs(z) < far ? z + variance * moved : z, -far, far);
  }
  const std::ptrdiff_t stride[3] = {1, size_[0], std::ptrdiff_t(size_[0]) * size_[1]};
  double steepest[3] = {};
  for (std::ptrdiff_t at = 0; at < std::ptrdiff_t(level_.size()); ++at) {
    bool at_edge = false;
    Real3 place{};
    double square = 0;
    for (int d = 0; d < dimension; ++d) {
      const std::ptrdiff_t i = at / stride[d] % size_[d];
      place[d] = first_[d] + double(i) * spacing_[d];
      if (i + 1 < size_[d]) {
        const double step = std::fabs(level_[at + stride[d]] - level_[at]) / spacing_[d];
        steepest[d] = std::max(steepest[d], step);
        at_edge = at_edge || !(level_[at + stride[d]] < 0);
      }
      at_edge = at_edge || (i > 0 && !(level_[at - stride[d]] < 0));
    }
    if (!(level_[at] < 0 && at_edge)) continue;
    for (int d = 0; d < dimension; ++d) square += std::pow(std::fabs(place[d]) + spacing_[d], 2);
    edge_.push_back(place);
    radius_ = std::max(radius_, std::sqrt(square));
  }
  for (const double step : steepest) slope_ += step * step;
  slope_ = std::sqrt(slope_);
}

double LevelMap::level(const Real3 &y) const noexcept {
  std::ptrdiff_t at = 0, step = 1;
  double part[3] = {};
  std::ptrdiff_t stride[3] = {};
  for (int d = 0; d < dimension_; ++d) {
    const double x = std::clamp((y[d] - first_[d]) / spacing_[d], 0.0, size_[d] - 1.0);
    const int i = std::min(static_cast<int>(x), size_[d] - 2);
    part[d] = x - i;
    stride[d] = step;
    at += i * step;
    step *= size_[d];
  }
  const double *q = &level_[at];
  const auto along_x = [&](std::ptrdiff_t o) { return q[o] + part[0] * (q[o + 1] - q[o]); };
  const auto in_plane = [&](std::ptrdiff_t o) {
    const double low = along_x(o);
    return low + part[1] * (along_x(o + stride[1]) - low);
  };
  const double low = in_plane(0);
  return dimension_ == 2 ? low : low + part[2] * (in_plane(stride[2]) - low);
}

double LevelMap::support(const Real3 &n) const noexcept {
  double most = 0, beyond = 0;
  for (const Real3 &y : edge_) most = std::max(most, std::fabs(n[0] * y[0] + n[1] * y[1] + n[2] * y[2]));
  for (int d = 0; d < dimension_; ++d) beyond += std::fabs(n[d]) * spacing_[d];
  return most + beyond;
}

}  // namespace eulastic
