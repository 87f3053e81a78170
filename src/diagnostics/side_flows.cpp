#include "diagnostics/side_flows.hpp"

#include "base/events.hpp"
#include "base/exact_sum.hpp"

namespace eulastic {
namespace {

enum Sum { into_box, pressure_sum, power_sum, faces_sum, sums };

// Sums over the faces of one boundary on this rank.
class SideSums {
public:
  SideSums(const Box &box, double density, const Field &velocity, const Field &pressure)
      : box_(box), density_(density), velocity_(velocity), pressure_(pressure) {}

  /// `profile`: that of an inflow boundary, 0 where solids cover it; or null.
  void add(const SideFlow &side, const InflowProfile *profile, int first, ExactSums *all) const {
    const int d = side.direction;
    for_points(box_.boundary_cells(d, side.high, 1), [&](int i, int j, int k) {
      const double along = (&velocity_[d](i, j, k))[side.high ? velocity_[d].stride(d) : 0];
      const double inward = side.high ? -along : along, p = pressure_on(side, {i, j, k});
      const double speed_squared = along * along + (is_open(side.kind) ? tangential_squared(d, {i, j, k}) : 0);
      all->add(first + into_box, inward);
      if (!profile || profile->empty() || (*profile)[index_on_side(d, {i, j, k})] != 0) {
        all->add(first + pressure_sum, p);
        all->add(first + faces_sum, 1);
      }
      // Fluid that enters through an outflow boundary has no more energy than fluid at rest outside.
      const double backflow = side.kind == BoundaryKind::outflow && inward > 0 ? 0.5 * density_ * along * along : 0;
      all->add(first + power_sum, inward * ((p - backflow) + 0.5 * density_ * speed_squared));
    });
  }

private:
  double pressure_on(const SideFlow &side, const Int3 &cell) const {
    const ConstView p = pressure_[0];
    const double *inside = &p(cell[0], cell[1], cell[2]);
    if (is_open(side.kind)) return side.pressure;
    return 1.5 * inside[0] - 0.5 * inside[side.high ? -p.stride(side.direction) : p.stride(side.direction)];
  }

  /// Index of a cell on a boundary normal to d, over all its cells, x before y before z.
  std::size_t index_on_side(int d, const Int3 &cell) const {
    const int a = d == 0 ? 1 : 0, b = d == 2 ? 1 : 2;
    const Int3 &begin = box_.layout().begin;
    return (begin[a] + cell[a]) + std::size_t(box_.domain_cells()[a]) * (begin[b] + cell[b]);
  }

  double tangential_squared(int d, const Int3 &cell) const {
    double sum = 0;
    for (int c = 0; c < box_.dimension(); ++c) {
      if (c == d) continue;
      const double *v = &velocity_[c](cell[0], cell[1], cell[2]), mean = 0.5 * (v[0] + v[velocity_[c].stride(c)]);
      sum += mean * mean;
    }
    return sum;
  }

  const Box &box_;
  double density_;
  const Field &velocity_, &pressure_;
};

}  // namespace

std::vector<SideFlow> crossed_boundaries(const BoundaryConditions &sides, const Box &box) {
  std::vector<SideFlow> flows;
  for (const auto [d, high] : box.sides()) {
    const BoundaryKind kind = sides[d][high].kind;
    if (!fluid_crosses(kind)) continue;
    SideFlow flow;
    flow.direction = d;
    flow.high = high;
    flow.kind = kind;
    flows.push_back(flow);
  }
  return flows;
}

PetscErrorCode measure_side_flows(const Domain &domain, const BoundaryConditions &sides, double time, double density,
                                  const Field &velocity, const Field &pressure, std::vector<SideFlow> *flows) {
  PetscFunctionBeginUser;
  *flows = crossed_boundaries(sides, domain);
  if (flows->empty()) PetscFunctionReturn(0);
  EventScope scope(Event::sums);
  ExactSums all(sums * static_cast<int>(flows->size()));
  std::vector<double> result(sums * flows->size());
  const SideSums add(domain, density, velocity, pressure);
  int first = 0;
  for (SideFlow &flow : *flows) {
    if (flow.kind == BoundaryKind::pressure) flow.pressure = sides[flow.direction][flow.high].given.at(time);
    add.add(flow, sides[flow.direction][flow.high].profile.get(), first, &all);
    first += sums;
  }
  PetscCall(all.reduce(domain.comm(), result.data()));
  const double *sum = result.data();
  for (SideFlow &flow : *flows) {
    const double area = domain.cell_volume() / domain.spacing()[flow.direction];
    flow.flow_rate = sum[into_box] * area;
    flow.power = sum[power_sum] * area;
    if (!is_open(flow.kind)) flow.pressure = sum[pressure_sum] / sum[faces_sum];
    sum += sums;
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
