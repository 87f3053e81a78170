#include "diagnostics/side_flows.hpp"

#include "base/events.hpp"
#include "base/exact_sum.hpp"
#include "field/open_boundaries.hpp"

namespace eulastic {
namespace {

enum Sum { into_box, pressure_sum, power_sum, faces_sum, sums };

// Squared velocity along a boundary normal to d, at the centre of a cell.
double tangential_squared(const Box &box, const Field &velocity, int d, const Int3 &cell) {
  double sum = 0;
  for (int c = 0; c < box.dimension(); ++c) {
    if (c == d) continue;
    const double *v = &velocity[c](cell[0], cell[1], cell[2]), mean = 0.5 * (v[0] + v[velocity[c].stride(c)]);
    sum += mean * mean;
  }
  return sum;
}

}  // namespace

std::vector<SideFlow> crossed_boundaries(const BoundaryConditions &sides, const Box &box) {
  std::vector<SideFlow> flows;
  for (const auto [d, high] : box.sides()) {
    const BoundaryKind kind = sides[d][high].kind;
    if (!fluid_crosses(kind)) continue;
    SideFlow &flow = flows.emplace_back();
    flow.direction = d;
    flow.high = high;
    flow.kind = kind;
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
  int first = 0;
  for (SideFlow &flow : *flows) {
    const int d = flow.direction;
    const BoundaryCondition &side = sides[d][flow.high];
    const ConstView v = velocity[d], p = pressure[0];
    const std::ptrdiff_t to_face = flow.high ? v.stride(d) : 0, inwards = flow.high ? -p.stride(d) : p.stride(d);
    if (flow.kind == BoundaryKind::pressure) flow.pressure = side.given.at(time);
    for_points(domain.boundary_cells(d, flow.high, 1), [&](int i, int j, int k) {
      const double along = (&v(i, j, k))[to_face], inward = flow.high ? -along : along, *inside = &p(i, j, k);
      const bool open = is_open(flow.kind);
      const double on_face = open ? flow.pressure : 1.5 * inside[0] - 0.5 * inside[inwards];
      const double speed_squared = along * along + (open ? tangential_squared(domain, velocity, d, {i, j, k}) : 0);
      all.add(first + into_box, inward);
      if (inflow_shape(domain, side, d, {i, j, k}) != 0) {  // 0 where solids cover an inflow boundary
        all.add(first + pressure_sum, on_face);
        all.add(first + faces_sum, 1);
      }
      // Fluid that enters through an outflow boundary has no more energy than fluid at rest outside.
      const double backflow = flow.kind == BoundaryKind::outflow && inward > 0 ? 0.5 * density * along * along : 0;
      all.add(first + power_sum, inward * ((on_face - backflow) + 0.5 * density * speed_squared));
    });
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
