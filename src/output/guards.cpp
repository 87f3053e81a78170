#include "output/guards.hpp"

#include "base/one_line.hpp"
#include "boxes/boxed_bodies.hpp"
#include "field/open_boundaries.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace eulastic {
namespace {

std::string where(const State &state, const Real3 &place) {
  return print("step %lld, t = %.9g, near x, y, z = %.6g, %.6g, %.6g: ", static_cast<long long>(state.step), state.time,
               place[0], place[1], place[2]);
}

// NaN is beyond every limit.
bool beyond(double value, double limit) { return limit > 0 && !(value <= limit); }

// Centre of the cell with this index, counted along x, then y, then z.
Real3 place_of_cell(const Box &box, double index) {
  const Int3 &n = box.domain_cells();
  const Real3 &h = box.spacing();
  const double i = std::fmod(index, n[0]), j = std::fmod(std::floor(index / n[0]), n[1]);
  return {(i + 0.5) * h[0], (j + 0.5) * h[1], (std::floor(index / n[0] / n[1]) + 0.5) * h[2]};
}

// For extremes that met such a value.
Stop not_finite(const Solver &solver, const FlowExtremes &extremes) {
  const State &state = solver.state();
  const char *broken = solver.limits(extremes).exceeded_limit(state.dt);
  return {"nonfinite", where(state, place_of_cell(solver.domain(), extremes.first_non_finite)) +
                           "a field is not finite; " + print("dt = %.3g, ", state.dt) +
                           (broken ? print("beyond the %s limit; lower -time_step", broken)
                                   : std::string("within all known limits; lower -time_step or raise -grid_cells"))};
}

Stop stop_reason(const Solver &solver) {
  const State &state = solver.state();
  return {"guard",
          print("step %lld, t = %.9g: ", static_cast<long long>(state.step), state.time) + solver.stop_reason()};
}

}  // namespace

Guards::Guards(const Config &config) : control_(config.guard) {
  const PressureKind pressure = config.method.pressure;
  pressure_advice_ = pressure == PressureKind::acm   ? "raise -acm_iterations_max, lower -acm_tolerance or -time_step"
                     : pressure == PressureKind::ksp ? "lower -pressure_ksp_rtol or -time_step"
                                                     : "lower -time_step";
}

PetscErrorCode Guards::before_step(const Solver &solver, const FlowExtremes &extremes, double dt, Stop *stop) const {
  PetscFunctionBeginUser;
  const State &state = solver.state();
  if (extremes.first_non_finite >= 0) {
    *stop = not_finite(solver, extremes);
    PetscFunctionReturn(0);
  }
  if (!solver.stop_reason().empty()) {
    *stop = stop_reason(solver);
    PetscFunctionReturn(0);
  }
  double courant = 0;
  for (int d = 0; d < solver.domain().dimension(); ++d)
    courant += extremes.speed[d] * dt / solver.domain().spacing()[d];
  const bool still = state.time + dt == state.time;
  if (!still && !beyond(courant, control_.cfl)) PetscFunctionReturn(0);
  Real3 place;
  PetscCall(place_of_speed(solver.domain(), state.velocity, &place));
  stop->reason = "guard";
  stop->message =
      where(state, place) +
      (still ? print("the time step %.3g is too short to change the time; check the units and that bodies leave "
                     "a way from inlets to outlets, or set -time_step",
                     dt)
             : print("CFL number %.4g, the sum of |v_i| dt/h_i, is above -guard_cfl %g; lower -time_step "
                     "(%.3g now)",
                     courant, control_.cfl, dt));
  PetscFunctionReturn(0);
}

PetscErrorCode Guards::check(const Solver &solver, const Measured &m, Stop *stop) const {
  PetscFunctionBeginUser;
  const State &state = solver.state();
  if (state.step == 0) PetscFunctionReturn(0);
  // Flow at rest has no velocity scale: as in the solver the scale is at least that of a Courant number of 1e-6.
  const Real3 &h = solver.domain().spacing();
  const double rest = 1e-6 * *std::min_element(h.begin(), h.begin() + solver.domain().dimension()) / state.dt;
  const double divergence = m.flow.divergence_rms * std::min(1.0, m.flow.speed_max / rest);
  std::string what;
  Real3 place{};
  auto find = place_of_speed;
  if (beyond(m.energy_made, control_.energy_growth)) {
    what = print(
        "the numerics have generated energy, %.3g of what the run held and was supplied with meanwhile, above "
        "-guard_energy_growth %g; lower -time_step (%.3g now), raise -grid_cells, or shorten -series_interval if the "
        "rows of series.csv are far apart",
        m.energy_made, control_.energy_growth, state.dt);
  } else if (beyond(divergence, control_.divergence)) {
    what = print("rms(div v) h/U = %.3g is above -guard_divergence %g; %s (%.3g now)", divergence, control_.divergence,
                 pressure_advice_.c_str(), state.dt);
    find = place_of_divergence;
  } else if (beyond(m.mach, control_.mach)) {
    what = print(
        "Mach number |v|/beta = %.3g of artificial compressibility is above -guard_mach %g; lower -time_step "
        "(%.3g now) or raise -acm_iterations_max",
        m.mach, control_.mach, state.dt);
  } else if (beyond(m.resolved_drift.value, control_.volume_drift)) {
    what = print(
        "the volume of body %d has changed by %.3g of its initial value, above -guard_volume_drift %g; raise "
        "-grid_cells, use -interface_scheme plic, or %s (%.3g now)",
        m.resolved_drift.label, m.resolved_drift.value, control_.volume_drift, pressure_advice_.c_str(), state.dt);
    find = nullptr;
    place = m.drifting_place;
  }
  if (what.empty()) PetscFunctionReturn(0);
  if (find) PetscCall(find(solver.domain(), state.velocity, &place));
  PetscCall(check_finite(solver, stop));  // a NaN is called what it is
  if (!*stop) *stop = {"guard", where(state, place) + what};
  PetscFunctionReturn(0);
}

PetscErrorCode Guards::check_finite(const Solver &solver, Stop *stop) const {
  PetscFunctionBeginUser;
  if (!solver.stop_reason().empty()) *stop = stop_reason(solver);
  if (*stop) PetscFunctionReturn(0);
  FlowExtremes extremes;
  PetscCall(measure_extremes(solver.domain(), solver.state().velocity, solver.state().phases, &extremes,
                             solver.boxed().bodies().list()));
  if (extremes.first_non_finite >= 0) *stop = not_finite(solver, extremes);
  PetscFunctionReturn(0);
}

namespace {

// Centre of the cell with the largest value(i, j, k) >= 0; the first one in the order of indices if there are several.
template <class Value>
PetscErrorCode largest(const Domain &domain, Value value, Real3 *place) {
  PetscFunctionBeginUser;
  const Int3 &begin = domain.layout().begin, &N = domain.domain_cells();
  double most = -1, own = -1, first = std::numeric_limits<double>::infinity();
  for_points(domain.rows(), [&](int i, int j, int k) {
    const double q = value(i, j, k);
    if (!(q > own)) return;
    own = q;
    first = begin[0] + i + double(N[0]) * (begin[1] + j + double(N[1]) * (begin[2] + k));
  });
  PetscCallMPI(MPI_Allreduce(&own, &most, 1, MPI_DOUBLE, MPI_MAX, domain.comm()));
  if (own < most) first = std::numeric_limits<double>::infinity();
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_DOUBLE, MPI_MIN, domain.comm()));
  *place = std::isfinite(first) ? place_of_cell(domain, first) : Real3{};
  PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode place_of_speed(const Domain &domain, const Field &velocity, Real3 *place) {
  PetscFunctionBeginUser;
  const auto rate = [&](int i, int j, int k) {
    double sum = 0;
    for (int d = 0; d < velocity.count(); ++d) sum += std::fabs(velocity[d](i, j, k)) / domain.spacing()[d];
    return sum;
  };
  PetscCall(largest(domain, rate, place));
  PetscFunctionReturn(0);
}

PetscErrorCode place_of_divergence(const Domain &domain, const Field &velocity, Real3 *place) {
  PetscFunctionBeginUser;
  const auto divergence = [&](int i, int j, int k) {
    double sum = 0;
    for (int d = 0; d < velocity.count(); ++d)
      sum += (velocity[d](i + (d == 0), j + (d == 1), k + (d == 2)) - velocity[d](i, j, k)) / domain.spacing()[d];
    return std::fabs(sum);
  };
  PetscCall(largest(domain, divergence, place));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
