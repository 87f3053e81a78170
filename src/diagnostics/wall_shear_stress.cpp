#include "diagnostics/wall_shear_stress.hpp"

#include "base/events.hpp"
#include "diagnostics/edge_stress.hpp"

namespace eulastic {
namespace {

// Adds to the traction along c the mean of value(cell) at both c-faces of each cell beside the wall. `value` takes the
// cell and that of its edge on the wall.
template <class Value>
void add(const Box &box, int c, WallStress *stress, const Value &value) {
  const int d = stress->direction, last = box.cells()[d] - 1;
  Int3 end = box.cells();
  end[d] = 1;
  double *to = stress->components[c].data();
  const auto at = [&](const Int3 &cell) {
    Int3 edge = cell;
    edge[d] += stress->high ? 1 : 0;
    return value(cell, edge);
  };
  for_points({{0, 0, 0}, end}, [&](int i, int j, int k) {
    Int3 cell{i, j, k};
    cell[d] = stress->high ? last : 0;
    const double low = at(cell);
    ++cell[c];
    *to++ += 0.5 * (low + at(cell));
  });
}

}  // namespace

std::vector<WallStress> wall_shear_stress(const Box &box, const BoundaryConditions &sides, double time,
                                          const EdgeViscosity &viscosity, const Field &velocity,
                                          const std::vector<Phase> &phases) {
  const EventScope scope(Event::sums);
  std::vector<WallStress> all;
  for (const auto [d, high] : box.sides()) {
    if (sides[d][high].kind != BoundaryKind::wall) continue;
    WallStress &stress = all.emplace_back();
    stress.direction = d;
    stress.high = high;
    Int3 n = box.cells();
    n[d] = box.touches(d, high) ? 1 : 0;
    stress.sy = n[0];
    stress.sz = std::ptrdiff_t(n[0]) * n[1];
    for (auto &values : stress.components) values.assign(std::size_t(n[0]) * n[1] * n[2], 0.0);
    if (n[d] == 0) continue;
    const Real3 speed = sides[d][high].motion.at(time);
    for (int c = 0; c < box.dimension(); ++c) {
      if (c == d) continue;
      add(box, c, &stress, [&, d = d](const Int3 &cell, const Int3 &edge) {  // as in the momentum equation
        const double factor = 2 * viscosity.at(c, d, edge) / box.spacing()[d];
        return factor * (velocity[c](cell[0], cell[1], cell[2]) - speed[c]);
      });
      for (const Phase &phase : phases)
        if (phase.material.elastic())
          add(box, c, &stress, [&, d = d, high = high](const Int3 &, const Int3 &edge) {
            const double traction = edge_stress(box, phase, c, d, edge[0], edge[1], edge[2]);
            return high ? -traction : traction;
          });
    }
  }
  return all;
}

}  // namespace eulastic
