#include "field/boundaries.hpp"

#include "field/carried_tensor.hpp"

#include "base/events.hpp"
#include "field/open_boundaries.hpp"
#include "field/reflection.hpp"
#include "grid/blocks.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {

void reflect(const Box &box, View q, int d, bool high, bool staggered, Reflection rule, int width,
             const OccupiedRows *rows) {
  const std::ptrdiff_t s = q.stride(d);
  const Layout &layout = box.layout();
  const int last =
      (high ? box.domain_cells()[d] - 1 : 0) - layout.begin[d];  // index of the last cell before the boundary
  width = std::min(width, layout.ghosts[d] + (high ? layout.cells[d] - 1 - last : last));
  if (width <= 0) return;
  const Plane plane(layout, d);
  const std::ptrdiff_t step = high ? s : -s;                                    // outward
  const std::ptrdiff_t wall = high || !staggered ? last * s + step : last * s;  // first point on or behind the boundary
  const std::ptrdiff_t mirror = staggered ? 0 : -step;                          // mirror image of that point
  const int from = plane.begin[0], to = plane.end[0], first = staggered ? 1 : 0;
  const auto reflect_row = [=](double *row) {
    if (rule.about_face) {
      for (int m = first; m < first + width; ++m)
        for (int i = from; i < to; ++i) row[i + m * step] = 2 * row[i] - row[i - m * step];
      return;
    }
    for (int m = first; m < first + width; ++m)
      for (int i = from; i < to; ++i) row[i + m * step] = rule.twice_wall + rule.sign * row[i + mirror - m * step];
  };
  constexpr int ahead = 4;
  const int low_j = plane.begin[1], low_k = plane.begin[2], lines = plane.end[1] - low_j, parts = row_parts(box);
  in_parallel(parts, parts, [&](int part) {
    const Piece piece(static_cast<std::size_t>(lines) * (plane.end[2] - low_k), part, parts);
    for (std::size_t line = piece.begin; line < piece.end; ++line) {
      const int j = low_j + static_cast<int>(line % lines), k = low_k + static_cast<int>(line / lines);
      if (rows && rows->idle(d == 1 ? last : j, d == 2 ? last : k)) continue;
      if (d == 1)  // hardware prefetchers do not detect rows a plane apart
        for (int m = first; m < first + width; ++m)
          for (const std::ptrdiff_t at : {mirror - m * step, m * step})
            prefetch(q.row(j, k + ahead) + wall + at + from, to - from);
      reflect_row(q.row(j, k) + wall);
    }
  });
}

namespace {

// Sets the points on one boundary of a field that is staggered in d to 0, also where they are ghosts of this rank.
// Zeros are not written, so that pages on demand stay unallocated (Field::on_demand).
void clear_face(const Box &box, View q, int d, bool high) {
  const Layout &layout = box.layout();
  const Plane plane(layout, d);
  const int local = (high ? box.domain_cells()[d] : 0) - layout.begin[d];
  if (local < -layout.ghosts[d] || local >= layout.cells[d] + layout.ghosts[d]) return;
  for (int k = plane.begin[2]; k < plane.end[2]; ++k)
    for (int j = plane.begin[1]; j < plane.end[1]; ++j) {
      double *row = q.row(j, k) + local * q.stride(d);
      for (int i = plane.begin[0]; i < plane.end[0]; ++i)
        if (row[i] != 0 || std::signbit(row[i])) row[i] = 0;
    }
}

}  // namespace

void close_wall_faces(const Box &box, View q, int d) {
  for (const bool high : {false, true})
    if (!box.is_open(d, high)) clear_face(box, q, d, high);
}

Real3 WallMotion::at(double time) const {
  const double factor = std::cos(frequency * time + phase);
  return {velocity[0] * factor, velocity[1] * factor, velocity[2] * factor};
}

double WallMotion::speed() const { return std::hypot(velocity[0], velocity[1], velocity[2]); }

double wall_speed(const BoundaryConditions &sides) {
  double speed = 0;
  for (const auto &pair : sides)
    for (const BoundaryCondition &side : pair) speed = std::max(speed, side.motion.speed());
  return speed;
}

void fill_wall_ghosts_velocity(const Box &box, const BoundaryConditions &sides, double time, Field &velocity,
                               int width) {
  EventScope scope(Event::wall_ghosts);
  const int dimension = box.dimension();
  for (int c = 0; c < velocity.count(); ++c) {
    if (box.is_wall(c)) {
      close_wall_faces(box, velocity[c], c);
      set_inflow_faces(box, sides, time, velocity[c], c);
    }
    for (int e = 0; e < dimension; ++e) {
      const int d = (c + e) % dimension;  // the normal direction first, so that a rotated scene has rotated corners
      for (const bool high : {false, true}) {
        if (!box.touches(d, high)) continue;
        const BoundaryCondition &side = sides[d][high];
        Reflection rule{-1, 0};
        if (is_open(side.kind) || (c != d && side.kind == BoundaryKind::symmetry))
          rule.sign = 1;
        else if (c == d && side.kind == BoundaryKind::inflow)
          rule.about_face = true;
        else if (c != d)
          rule.twice_wall = 2 * side.motion.at(time)[c];
        reflect(box, velocity[c], d, high, c == d, rule, width);
      }
    }
  }
}

void fill_wall_ghosts_even(const Box &box, const Staggering &staggering, View field, int width,
                           const OccupiedRows *rows) {
  for (const auto [d, high] : box.sides()) reflect(box, field, d, high, staggering[d], {1.0, 0.0}, width, rows);
}

void clear_solid_ghosts(const Box &box, const BoundaryConditions &sides, View field, int width,
                        const OccupiedRows *rows) {
  for (const auto [d, high] : box.sides())
    if (is_solid(sides[d][high].kind)) reflect(box, field, d, high, false, {0.0, 0.0}, width, rows);
}

void fill_wall_ghosts_tensor(const Box &box, const BoundaryConditions &sides, Field &tensor, int width,
                             const OccupiedRows *rows) {
  EventScope scope(Event::wall_ghosts);
  clear_symmetry_planes(box, sides, tensor);
  const auto &components = tensor_components(box.dimension());
  for (int c = 0; c < tensor.count(); ++c) {
    const Staggering at = components[c].at;
    for (const auto [d, high] : box.sides()) {
      const bool odd = at[d] && sides[d][high].kind == BoundaryKind::symmetry;
      reflect(box, tensor[c], d, high, at[d], {odd ? -1.0 : 1.0, 0.0}, width, rows);
    }
  }
}

void fill_wall_ghosts_centred_tensor(const Box &box, Field &tensor, int width, const OccupiedRows *rows) {
  const auto &components = tensor_components(box.dimension());
  for (int c = 0; c < tensor.count(); ++c)
    for (const auto [d, high] : box.sides())
      reflect(box, tensor[c], d, high, false, {components[c].at[d] ? -1.0 : 1.0, 0.0}, width, rows);
}

void clear_symmetry_planes(const Box &box, const BoundaryConditions &sides, Field &tensor) {
  const auto &components = tensor_components(box.dimension());
  for (const auto [d, high] : box.sides())
    for (int c = 0; sides[d][high].kind == BoundaryKind::symmetry && c < tensor.count(); ++c)
      if (components[c].at[d]) clear_face(box, tensor[c], d, high);
}

}  // namespace eulastic
