#include "diagnostics/wall_shear_stress.hpp"

#include "base/events.hpp"
#include "diagnostics/edge_stress.hpp"

namespace eulastic {
namespace {

// Traction on one wall.
class WallTraction {
public:
  WallTraction(const Box &box, int direction, bool high)
      : box_(box), d_(direction), high_(high), last_(box.cells()[direction] - 1) {}

  /// Adds to the traction along c the mean of value(cell) at both c-faces of each cell beside the wall.
  template <class Value>
  void add(int c, WallStress *stress, Value value) const {
    Int3 end = box_.cells();
    end[d_] = 1;
    double *to = stress->components[c].data();
    for_points({{0, 0, 0}, end}, [&](int i, int j, int k) {
      Int3 cell{i, j, k};
      cell[d_] = high_ ? last_ : 0;
      const double low = value(cell);
      ++cell[c];
      *to++ += 0.5 * (low + value(cell));
    });
  }

  // Adds the viscous stress of the momentum equation.
  void add_viscous(int c, const EdgeViscosity &viscosity, double wall, ConstView q, WallStress *stress) const {
    add(c, stress, [&](const Int3 &cell) {
      Int3 edge = cell;
      edge[d_] += high_ ? 1 : 0;
      const double factor = 2 * viscosity.at(c, d_, edge) / box_.spacing()[d_];
      return factor * (q(cell[0], cell[1], cell[2]) - wall);
    });
  }

  void add_elastic(int c, const Phase &phase, WallStress *stress) const {
    if (!phase.material.elastic()) return;
    add(c, stress, [&](const Int3 &cell) {
      Int3 edge = cell;
      edge[d_] += high_ ? 1 : 0;
      const double traction = edge_stress(box_, phase, c, d_, edge[0], edge[1], edge[2]);
      return high_ ? -traction : traction;
    });
  }

private:
  const Box &box_;
  int d_;
  bool high_;
  int last_;
};

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
    const WallTraction wall(box, d, high);
    const Real3 speed = sides[d][high].motion.at(time);
    for (int c = 0; c < box.dimension(); ++c) {
      if (c == d) continue;
      wall.add_viscous(c, viscosity, speed[c], velocity[c], &stress);
      for (const Phase &phase : phases) wall.add_elastic(c, phase, &stress);
    }
  }
  return all;
}

}  // namespace eulastic
