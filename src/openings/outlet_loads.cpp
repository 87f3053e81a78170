#include "openings/outlet_loads.hpp"

#include <petscblaslapack.h>
#include <algorithm>
#include <cmath>
#include <utility>

namespace eulastic {
namespace {

// Weight of the end of a step in docs/method.md, section 20: above 1/2, so that stiff loads are damped.
constexpr double damped = 0.6;

}  // namespace

bool OutletLoads::none(const BoundaryConditions &sides) { return OutletLoads(sides).count() == 0; }

OutletLoads::OutletLoads(const BoundaryConditions &sides) {
  for (int d = 0; d < 3; ++d)
    for (const int high : {0, 1}) {
      const BoundaryCondition &side = sides[d][high];
      if (side.kind != BoundaryKind::pressure || !side.load.exists()) continue;
      Load load;
      load.direction = d;
      load.high = high;
      load.spec = side.load;
      load.capacity = side.load.charge;
      loads_.push_back(std::move(load));
    }
}

std::size_t OutletLoads::bytes() const {
  std::size_t sum = 0;
  for (const Load &load : loads_) sum += load.response.bytes();
  return sum;
}

void OutletLoads::set_response(int n, Field &&pressure, const std::vector<double> &flow) {
  loads_[n].response = std::move(pressure);
  loads_[n].flow = flow;
}

// C dp_c/dt = Q - p_c/R', p = p_c + R Q: both by the theta method, so that any R, C and R' are stable. For the capacity
// theta is 1/2, of second order, where the step resolves it.
void OutletLoads::begin(const BoundaryConditions &sides, double middle, double dt, const std::vector<double> &flow) {
  for (std::size_t n = 0; n < loads_.size(); ++n) {
    Load &load = loads_[n];
    const OutletLoad &spec = load.spec;
    double theta = 0.5;
    load.kept = load.gain = 0;
    if (spec.capacity > 0) {
      const double drain = dt / (spec.capacity * spec.drain), fill = dt / spec.capacity;
      const double stiffness = drain * drain + dt * fill * std::fabs(load.flow[n]);  // (dt rate)^2 of its modes
      theta += (damped - 0.5) * (1 - 1 / (1 + stiffness));
      load.kept = ((1 - (1 - theta) * drain) * load.capacity + fill * (1 - theta) * flow[n]) / (1 + theta * drain);
      load.gain = theta * fill / (1 + theta * drain);
    }
    const double given = sides[load.direction][load.high].given.at(middle);
    load.base = given + (1 - theta) * load.capacity + theta * load.kept + spec.resistance * (1 - damped) * flow[n];
    load.share = theta * load.gain + spec.resistance * damped;
    load.pressure = load.base + load.share * flow[n];
  }
}

// A pressure acts most on the flow through its own boundary, so that the diagonal dominates and the matrix is regular.
std::vector<double> OutletLoads::end(double dt, const std::vector<double> &flow) {
  const std::size_t count = loads_.size();
  std::vector<double> a(count * count), changes(count);  // columns
  for (std::size_t s = 0; s < count; ++s) {
    const Load &load = loads_[s];
    for (std::size_t t = 0; t < count; ++t) a[s + t * count] = (s == t ? 1 : 0) - load.share * dt * loads_[t].flow[s];
    changes[s] = load.base + load.share * flow[s] - load.pressure;
  }
  const PetscBLASInt n = static_cast<PetscBLASInt>(count), one = 1;
  std::vector<PetscBLASInt> pivots(count);
  PetscBLASInt info;
  LAPACKgesv_(&n, &one, a.data(), &n, pivots.data(), changes.data(), &n, &info);
  for (std::size_t s = 0; s < count; ++s) loads_[s].pressure += changes[s];
  for (std::size_t s = 0; s < count; ++s) {
    double end = flow[s];
    for (std::size_t t = 0; t < count; ++t) end += dt * changes[t] * loads_[t].flow[s];
    loads_[s].capacity = loads_[s].kept + loads_[s].gain * end;
  }
  return changes;
}

void OutletLoads::add_up(const Box &box, const std::vector<double> &changes, Field &increment) const {
  const Int3 n = box.cells();
  const int last = box.dimension() == 3 ? 1 : 0;
  for (int k = -last; k < n[2] + last; ++k)
    for (int j = -1; j < n[1] + 1; ++j) {
      double *q = increment[0].row(j, k);
      std::fill(q - 1, q + n[0] + 1, 0.0);
      for (std::size_t t = 0; t < loads_.size(); ++t) {
        const double *unit = loads_[t].response[0].row(j, k);
        for (int i = -1; i < n[0] + 1; ++i) q[i] += changes[t] * unit[i];
      }
    }
}

BoundaryConditions OutletLoads::with_pressures(const BoundaryConditions &sides) const {
  BoundaryConditions now = sides;
  for (const Load &load : loads_) now[load.direction][load.high].given = {load.pressure, 0, 0, {}};
  return now;
}

std::vector<double *> OutletLoads::numbers() {
  std::vector<double *> numbers;
  for (Load &load : loads_) numbers.insert(numbers.end(), {&load.capacity, &load.pressure});
  return numbers;
}

}  // namespace eulastic
