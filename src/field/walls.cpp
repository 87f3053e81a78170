#include "field/walls.hpp"

#include "base/events.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

// One side of one direction: q(ghost m) = twice_wall + sign q(mirror image), m = 1 ... width. A staggered field
// that must vanish on the wall (sign < 0) gets that value as well. Runs over all ghosts of the other directions,
// so that doing x, y, z in turn fills edges and corners.
struct Reflection {
  double sign, twice_wall;
};

void reflect(const Grid &grid, View q, int d, bool high, bool staggered, Reflection rule, int width) {
  const Layout &layout = grid.layout();
  const std::ptrdiff_t s = q.stride(d);
  const int n = layout.cells[d];
  Int3 begin{}, end{};
  for (int e = 0; e < 3; ++e) {
    begin[e] = -layout.ghosts[e];
    end[e] = layout.cells[e] + layout.ghosts[e];
  }
  begin[d] = 0;
  end[d] = 1;
  const std::ptrdiff_t step = high ? s : -s;                       // outward
  const std::ptrdiff_t wall = high ? n * s : staggered ? 0 : -s;   // first point on (staggered) or behind the wall
  const std::ptrdiff_t mirror = staggered ? 0 : -step;             // mirror image of that point
  for (int k = begin[2]; k < end[2]; ++k)
    for (int j = begin[1]; j < end[1]; ++j) {
      double *row = q.row(j, k) + wall;
      if (staggered && rule.sign < 0)
        for (int i = begin[0]; i < end[0]; ++i) row[i] = 0;
      const int first = staggered ? 1 : 0;
      for (int m = first; m < first + width && !(high && staggered && m == width); ++m)
        for (int i = begin[0]; i < end[0]; ++i)
          row[i + m * step] = rule.twice_wall + rule.sign * row[i + mirror - m * step];
    }
}

}  // namespace

Real3 WallMotion::at(double time) const {
  const double factor = std::cos(frequency * time + phase);
  return {velocity[0] * factor, velocity[1] * factor, velocity[2] * factor};
}

double WallMotion::speed() const { return std::hypot(velocity[0], velocity[1], velocity[2]); }

const std::vector<TensorComponent> &tensor_components(int dimension) {
  static const std::vector<TensorComponent> flat{{0, 0}, {1, 1}, {0, 1}};
  static const std::vector<TensorComponent> full{{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
  return dimension == 2 ? flat : full;
}

void fill_wall_ghosts_velocity(const Grid &grid, const Walls &walls, double time, FieldBlock &velocity, int width) {
  VerbScope scope(Verb::wall_ghosts);
  for (int d = 0; d < grid.dimension(); ++d)
    for (int side = 0; side < 2; ++side) {
      if (!(side ? grid.touches_high(d) : grid.touches_low(d))) continue;
      const Real3 wall = walls.motion[d][side].at(time);
      for (int c = 0; c < velocity.count(); ++c)
        reflect(grid, velocity[c], d, side, c == d, {-1.0, c == d ? 0.0 : 2 * wall[c]}, width);
    }
}

void fill_wall_ghosts_even(const Grid &grid, const Staggering &staggering, View field, int width) {
  for (int d = 0; d < grid.dimension(); ++d)
    for (int side = 0; side < 2; ++side)
      if (side ? grid.touches_high(d) : grid.touches_low(d))
        reflect(grid, field, d, side, staggering[d], {1.0, 0.0}, width);
}

void fill_wall_ghosts_tensor(const Grid &grid, FieldBlock &tensor, int width) {
  VerbScope scope(Verb::wall_ghosts);
  const auto &components = tensor_components(grid.dimension());
  for (int c = 0; c < tensor.count(); ++c) fill_wall_ghosts_even(grid, components[c].staggering(), tensor[c], width);
}

}  // namespace eulastic
