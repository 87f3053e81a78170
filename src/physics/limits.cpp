#include "physics/limits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace eulastic {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
// Shares of the limits that the automatic step uses. Euler lowers the viscosity by U^2 dt/2: a tenth of 2 nu/U^2
// keeps that below 10 % where the flow is fastest.
constexpr double combined_share = 0.8, advective_share = 0.25, inertial_share = 0.1;

double over(double a, double b) { return b > 0 ? a / b : infinite; }

struct RowExtremes {
  double largest = 0, bad = 0;
};

RowExtremes row_extremes(const double *q, int begin, int end) {
  RowExtremes r;
  for (int i = begin; i < end; ++i) {
    const double a = std::fabs(q[i]);
    r.largest = a > r.largest ? a : r.largest;
    r.bad += !(a <= std::numeric_limits<double>::max());
  }
  return r;
}

}  // namespace

double FlowExtremes::max_speed() const { return std::max({speed[0], speed[1], speed[2]}); }

double stretch_squared(double trace, int dimension) {
  if (dimension == 2) {
    const double t = std::max(trace - 1, 2.0);
    return 0.5 * (t + std::sqrt(t * t - 4));
  }
  // x + 2/sqrt(x) = trace, x >= 1: the fixed point x <- trace - 2/sqrt(x) falls monotonically from above.
  double x = std::max(trace, 3.0);
  const double t = x;
  for (int i = 0; i < 60; ++i) x = std::max(1.0, t - 2 / std::sqrt(x));
  return x;
}

PetscErrorCode measure_extremes(const Grid &grid, const FieldBlock &velocity, const std::vector<Phase> &phases,
                                FlowExtremes *extremes) {
  PetscFunctionBeginUser;
  const Int3 n = grid.owned(), &N = grid.cells(), &begin = grid.layout().begin;
  double largest[5] = {0, 0, 0, 3, -infinite};  // speeds, trace, - first bad cell: all by maximum
  const auto mark = [&](const double *row, int i0, int i1, int j, int k) {
    for (int i = i0; i < i1; ++i)
      if (!std::isfinite(row[i])) {
        const double cell = begin[0] + i + double(N[0]) * (begin[1] + j + double(N[1]) * (begin[2] + k));
        largest[4] = std::max(largest[4], -cell);
        return;
      }
  };
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int d = 0; d < velocity.count(); ++d) {
        const double *row = velocity[d].row(j, k);
        const RowExtremes r = row_extremes(row, 0, n[0]);
        largest[d] = std::max(largest[d], r.largest);
        if (r.bad > 0) mark(row, 0, n[0], j, k);
      }
  for (const Phase &phase : phases)
    for (const Segment &s : phase.solid.all()) {
      if (s.j >= n[1] || s.k >= n[2]) continue;
      const int end = std::min(s.i_end, n[0]);
      const bool flat = grid.dimension() == 2;
      const double *xx = phase.tensor[0].row(s.j, s.k), *yy = phase.tensor[1].row(s.j, s.k);
      const double *zz = flat ? xx : phase.tensor[2].row(s.j, s.k);
      double bad = 0;
      for (int i = s.i_begin; i < end; ++i) {
        const double trace = xx[i] + yy[i] + (flat ? 1.0 : zz[i]);
        largest[3] = trace > largest[3] ? trace : largest[3];
        bad += !(std::fabs(trace) <= std::numeric_limits<double>::max());
      }
      if (bad > 0) {
        mark(xx, s.i_begin, end, s.j, s.k);
        mark(yy, s.i_begin, end, s.j, s.k);
        mark(zz, s.i_begin, end, s.j, s.k);
      }
    }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, largest, 5, MPI_DOUBLE, MPI_MAX, grid.comm()));
  extremes->speed = {largest[0], largest[1], largest[2]};
  extremes->trace = largest[3];
  extremes->first_bad = largest[4] == -infinite ? -1 : -largest[4];
  PetscFunctionReturn(0);
}

TimeStepLimits euler_limits(const Real3 &spacing, int dimension, const Fluid &fluid, double shear_modulus,
                            const FlowExtremes &extremes) {
  double S = 0, crossing = 0, speed_squared = 0;
  for (int d = 0; d < dimension; ++d) {
    S += 1 / (spacing[d] * spacing[d]);
    crossing += extremes.speed[d] / spacing[d];
    speed_squared += extremes.speed[d] * extremes.speed[d];
  }
  const double nu = fluid.kinematic_viscosity();
  const double c_squared = shear_modulus * stretch_squared(extremes.trace, dimension) / fluid.density;
  return {over(1, 2 * nu * S), over(1, std::sqrt(c_squared * S)),
          over(1, nu * S + std::sqrt(nu * nu * S * S + c_squared * S)), over(1, crossing),
          fluid.inertia && nu > 0 ? over(2 * nu, speed_squared) : infinite};
}

TimeStepLimits euler_limits(const Grid &grid, const Fluid &fluid, double shear_modulus, const FlowExtremes &extremes) {
  return euler_limits(grid.spacing(), grid.dimension(), fluid, shear_modulus, extremes);
}

double TimeStepLimits::automatic(const char **name) const {
  const struct {
    double dt;
    const char *name;
  } bound[3] = {{combined_share * combined, elastic < viscous ? "elastic wave" : "viscous"},
                {advective_share * advective, "advective"},
                {inertial_share * inertial, "Euler 2 nu/U^2"}};
  const auto *least = std::min_element(bound, bound + 3, [](const auto &a, const auto &b) { return a.dt < b.dt; });
  if (name) *name = least->name;
  return least->dt;
}

const char *TimeStepLimits::broken(double dt) const {
  if (dt >= viscous) return "viscous";
  if (dt >= combined) return "viscous + elastic wave";
  if (dt >= advective) return "advective";
  if (dt >= inertial) return "Euler 2 nu/U^2";
  return nullptr;
}

}  // namespace eulastic
