#include "output/guards.hpp"

#include "boxes/boxed_bodies.hpp"
#include "diagnostics/places.hpp"
#include "field/open_sides.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace eulastic {
namespace {

__attribute__((format(printf, 1, 2))) std::string text(const char *format, ...) {
  char line[512];
  va_list list;
  va_start(list, format);
  std::vsnprintf(line, sizeof line, format, list);
  va_end(list);
  return line;
}

std::string where(const State &state, const Real3 &place) {
  return text("step %lld, t = %.9g, near x, y, z = %.6g, %.6g, %.6g: ", static_cast<long long>(state.step), state.time,
              place[0], place[1], place[2]);
}

// NaN is beyond every limit.
bool beyond(double value, double limit) { return limit > 0 && !(value <= limit); }

// For extremes that met such a value.
Stop not_finite(const Solver &solver, const FlowExtremes &extremes) {
  const State &state = solver.state();
  const char *broken = solver.limits(extremes).broken(state.dt);
  return {"nonfinite", where(state, place_of_cell(solver.domain(), extremes.first_bad)) + "a field is not finite; " +
                           text("dt = %.3g, ", state.dt) +
                           (broken ? text("beyond the %s limit; lower -time_step", broken)
                                   : std::string("within all known limits; lower -time_step, more -grid_cells"))};
}

Stop stop_reason(const Solver &solver) {
  const State &state = solver.state();
  return {"guard",
          text("step %lld, t = %.9g: ", static_cast<long long>(state.step), state.time) + solver.stop_reason()};
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
  if (extremes.first_bad >= 0) {
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
      (still ? text("the time step %.3g is too short to change the time; check the units, give -time_step", dt)
             : text("CFL number %.4g, the sum of |v_i| dt/h_i, is above -guard_cfl %g; lower -time_step "
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
    what = text(
        "the numerics have generated energy, %.3g of what the run held and was supplied with meanwhile, above "
        "-guard_energy_growth %g; lower -time_step (%.3g now), more -grid_cells, or -series_interval if rows are far "
        "apart",
        m.energy_made, control_.energy_growth, state.dt);
  } else if (beyond(divergence, control_.divergence)) {
    what = text("rms(div v) h/U = %.3g is above -guard_divergence %g; %s (%.3g now)", divergence, control_.divergence,
                pressure_advice_.c_str(), state.dt);
    find = place_of_divergence;
  } else if (beyond(m.mach, control_.mach)) {
    what = text(
        "Mach number |v|/beta = %.3g of artificial compressibility is above -guard_mach %g; lower -time_step "
        "(%.3g now) or raise -acm_iterations_max",
        m.mach, control_.mach, state.dt);
  } else if (beyond(m.resolved_drift, control_.volume_drift)) {
    what = text(
        "the volume of body %d has changed by %.3g of its own, above -guard_volume_drift %g; more "
        "-grid_cells, -interface_scheme plic, or %s (%.3g now)",
        m.drifting_body, m.resolved_drift, control_.volume_drift, pressure_advice_.c_str(), state.dt);
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
                             solver.boxed().list()));
  if (extremes.first_bad >= 0) *stop = not_finite(solver, extremes);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
