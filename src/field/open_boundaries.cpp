#include "field/open_boundaries.hpp"

#include "field/inlet_velocity.hpp"
#include "field/reflection.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
// Ghosts across periodic boundaries have the profile of their image; ghosts behind other boundaries that of the nearest
// cell.
double inflow_shape(const Box &box, const BoundaryCondition &side, int d, const Int3 &local) {
  if (!side.profile || side.profile->empty()) return 1;
  std::size_t place = 0;
  for (int e = 2; e >= 0; --e) {
    if (e == d) continue;
    const int n = box.domain_cells()[e];
    place = place * n + std::size_t(std::clamp(box.image(e, box.layout().begin[e] + local[e]), 0, n - 1));
  }
  return (*side.profile)[place];
}

void set_inflow_row(const Box &box, const BoundaryCondition &side, int d, bool high, double given, Segment row,
                    View component) {
  const double along = high ? -given : given;
  if (d == 0) {
    row.i_begin = high ? box.domain_cells()[0] - box.layout().begin[0] : -box.layout().begin[0];
    row.i_end = row.i_begin + 1;
  }
  double *face = component.row(row.j, row.k);
  for (int i = row.i_begin; i < row.i_end; ++i) face[i] = along * inflow_shape(box, side, d, {i, row.j, row.k});
}

void set_inflow_faces(const Box &box, const BoundaryConditions &sides, double time, View component, int d) {
  const Layout &layout = box.layout();
  for (const bool high : {false, true}) {
    const BoundaryCondition &side = sides[d][high];
    const int local = (high ? box.domain_cells()[d] : 0) - layout.begin[d];
    if (side.kind != BoundaryKind::inflow || local < -layout.ghosts[d] || local >= layout.cells[d] + layout.ghosts[d])
      continue;
    const double given = side.given.at(time);
    const Plane plane(layout, d);
    for (int k = plane.begin[2]; k < plane.end[2]; ++k)
      for (int j = plane.begin[1]; j < plane.end[1]; ++j) {
        const Segment row{plane.begin[0], plane.end[0], d == 1 ? local : j, d == 2 ? local : k};
        if (side.fed && d == 0)
          side.fed->set_row({local, local + 1, row.j, row.k}, component);
        else if (side.fed)
          side.fed->set_row(row, component);
        else
          set_inflow_row(box, side, d, high, given, row, component);
      }
  }
}

void fill_ghosts_of_increment(const Box &box, View field, int width) {
  for (const auto [d, high] : box.sides())
    reflect(box, field, d, high, false, {box.is_open(d, high) ? -1.0 : 1.0, 0.0}, width);
}

void fill_ghosts_of_given_pressure(const Box &box, const BoundaryConditions &sides, double time, double density,
                                   const Field &velocity, View pressure) {
  for (const auto [d, high] : box.sides()) {
    if (!box.is_open(d, high)) continue;
    const bool outflow = sides[d][high].kind == BoundaryKind::outflow;
    const double given = outflow ? 0 : sides[d][high].given.at(time);
    const ConstView normal = velocity[d];
    const std::ptrdiff_t outward = high ? pressure.stride(d) : -pressure.stride(d),
                         to_face = high ? normal.stride(d) : 0;
    const double sign = high ? -1 : 1;
    for_points(box.boundary_cells(d, high, 1), [&](int i, int j, int k) {
      const double inward = sign * (&normal(i, j, k))[to_face];
      const double dynamic_pressure = outflow && inward > 0 ? 0.5 * density * (inward * inward) : 0;
      double *p = &pressure(i, j, k);
      p[outward] = 2 * (given - dynamic_pressure) - p[0];
    });
  }
}

void clear_open_ghosts(const Box &box, View field, int width) {
  for (const auto [d, high] : box.sides())
    if (box.is_open(d, high)) reflect(box, field, d, high, false, {0.0, 0.0}, width);
}

bool fluid_crosses(const BoundaryConditions &sides) {
  for (const auto &pair : sides)
    for (const BoundaryCondition &side : pair)
      if (fluid_crosses(side.kind)) return true;
  return false;
}

bool has_inlet_generators(const BoundaryConditions &sides) {
  return std::any_of(sides.begin(), sides.end(),
                     [](const auto &pair) { return pair[0].generator_cells || pair[1].generator_cells; });
}

bool has_open_boundary(const BoundaryConditions &sides) {
  for (const auto &pair : sides)
    for (const BoundaryCondition &side : pair)
      if (is_open(side.kind)) return true;
  return false;
}

Real3 pressure_drive(const BoundaryConditions &sides, const Real3 &length, double density) {
  Real3 drive{};
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const auto &pair : sides)
    for (const BoundaryCondition &side : pair) {
      if (!is_open(side.kind)) continue;
      const auto range = side.kind == BoundaryKind::outflow ? std::array{0.0, 0.0} : side.given.range();
      low = std::min(low, range[0]);
      high = std::max(high, range[1]);
    }
  if (!(high > low)) return drive;
  for (int d = 0; d < 3; ++d)
    if (is_open(sides[d][0].kind) || is_open(sides[d][1].kind)) drive[d] = (high - low) / (density * length[d]);
  return drive;
}

Real3 inflow_speed(const BoundaryConditions &sides) {
  Real3 speed{};
  for (int d = 0; d < 3; ++d)
    for (const BoundaryCondition &side : sides[d]) {
      if (side.kind != BoundaryKind::inflow) continue;
      double most = 0;
      if (!side.profile || side.profile->empty())
        most = 1;
      else
        for (const double shape : *side.profile) most = std::max(most, std::fabs(shape));
      speed[d] = std::max(speed[d], most * side.given.largest());
    }
  return speed;
}

}  // namespace eulastic
