#include "scene/check_only.hpp"

#include "base/one_line.hpp"
#include "flow/limits.hpp"
#include "flow/super_time_stepping.hpp"
#include "pressure/multigrid.hpp"
#include "scene/flow_scale.hpp"
#include "scene/lumens.hpp"
#include "scene/memory.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace eulastic {
namespace {

class Report {
public:
  std::string text;
  void line(const std::string &name, const std::string &value) { text += name + ": " + value + "\n"; }
  void limit(const std::string &name, double dt) {
    line("dt limit, " + name, std::isfinite(dt) ? print("%.6g", dt) : "none");
  }
};

class Check {
public:
  explicit Check(const Config &config) : config_(config), dimension_(config.grid.dimension()) {
    for (int d = 0; d < dimension_; ++d) spacing_[d] = config.grid.spacing(d);
  }

  void grid(Report &report, int ranks) const {
    const Int3 &n = config_.grid.cells, parts = Domain::decompose(config_.grid, ranks);
    const double cells = double(n[0]) * n[1] * n[2];
    report.line("cells", print("%d x %d x %d = %.0f", n[0], n[1], n[2], cells));
    if (dimension_ == 2)
      report.line("spacing", print("%g x %g", spacing_[0], spacing_[1]));
    else
      report.line("spacing", print("%g x %g x %g", spacing_[0], spacing_[1], spacing_[2]));
    report.line("ranks",
                print("%d x %d x %d = %d, about %.0f cells each", parts[0], parts[1], parts[2], ranks, cells / ranks));
    if (ranks > 1) boxes(report, parts);
    if (cells > std::numeric_limits<PetscInt>::max())
      report.line("warning", print("this case needs a PETSc with 64-bit indices (Debian: libpetsc64-real-dev); this "
                                   "one can number at most %.0f cells",
                                   double(std::numeric_limits<PetscInt>::max())));
    if (ranks > 1 && config_.method.pressure == PressureKind::acm && !config_.method.is_single_acm_step() &&
        config_.method.acm_coarse)
      report.line("V-cycle", Multigrid::shares(Domain::planned(config_.grid, ranks)));
    const double bytes = bytes_per_rank(config_, parts);
    report.line("memory", print("%.4g GB for all fields, %.4g GB per rank; this machine has %.4g GB",
                                1e-9 * bytes * ranks, 1e-9 * bytes, 1e-9 * memory_limit()));
    if (const double boxed = bytes_in_boxes(config_); boxed > 0)
      report.line("bodies in boxes (estimate)", print("%.4g GB per rank, part of the memory", 1e-9 * boxed / ranks));
  }

  void boxes(Report &report, const Int3 &parts) const {
    const Int3 box = Domain::largest_box(config_.grid, parts);
    double own = 1, travelling = 1, in_memory = 1;
    int around = 1;
    for (int d = 0; d < 3; ++d) {
      own *= box[d];
      travelling *= box[d] + (parts[d] > 1 ? 2 * Box::stencil_width : 0);
      in_memory *= box[d] + (d < dimension_ ? 2 * config_.grid.ghosts : 0);
      around *= std::min(parts[d], 3);
    }
    report.line("largest box of a rank", print("%d x %d x %d cells, %.3g times as many in memory with ghosts", box[0],
                                               box[1], box[2], in_memory / own));
    report.line("exchange of the velocity",
                print("%d neighbours, %.3g values per cell and component, %.4g MB for each rank", around - 1,
                      travelling / own - 1, 8e-6 * dimension_ * (travelling - own)));
  }

  void bodies(Report &report) const {
    const double box = config_.grid.volume();
    double walls = 0, cells = 0;
    for (std::size_t s = 0; s < config_.species.size(); ++s) {
      const SpeciesSpec &spec = config_.species[s];
      if (spec.shape == Shape::state) {
        report.line("species " + spec.name, print("from %s", config_.initial_state.c_str()));
        continue;
      }
      const bool file = spec.shape == Shape::voxels;
      const auto [count, volume] = count_bodies(config_, s);
      (is_wall_species(config_, s) ? walls : cells) += count * volume;
      report.line("species " + spec.name, print("%.0f bodies of %s %g, fraction of the box %.6g%s%s", count,
                                                dimension_ == 2 ? "area" : "volume", volume, count * volume / box,
                                                file ? ", from " : "", file ? spec.voxels.path.c_str() : ""));
    }
    if (cells > 0)
      report.line("hematocrit",
                  print("%.6g%s", cells / (box - walls), walls > 0 ? " (of the box less slabs, tubes, vessels)" : ""));
  }

  void flow(Report &report) const {
    const FlowScale scale = flow_scale(config_);
    const double nu = config_.fluid.kinematic_viscosity(), speed = scale.largest_speed();
    const auto estimate = [&](const std::string &name, std::optional<double> value, const std::string &how) {
      report.line(name, (value ? print("%.6g", *value) : "unknown") + how);
    };
    const auto capillary = [&](const SpeciesSpec &spec, double per_rate, const char *what) {
      std::optional<double> number;
      if (scale.shear_rate) number = *scale.shear_rate * per_rate;
      estimate("capillary number of " + spec.name, number, std::string(" (viscosity x shear rate ") + what + ")");
    };
    if (speed == 0) {
      report.line("flow", print("none (no force, pressure, moving wall, inlet or initial velocity)%s",
                                stretched() ? ", but for what stretched bodies or -initial_state cause" : ""));
    } else {
      std::optional<double> reynolds;
      if (!scale.speed_is_bound && nu > 0) reynolds = speed * scale.length / nu;
      report.line("velocity scale (estimate)", print("%s%.6g", scale.speed_is_bound ? "less than " : "", speed));
      estimate("shear rate (estimate)", scale.shear_rate, "");
      const std::string length = print(" (length %.6g)", scale.length);
      estimate("Reynolds number", reynolds, nu > 0 ? length : " (no viscosity)");
    }
    for (const SpeciesSpec &spec : config_.species) {
      const double modulus = spec.material().shear_modulus;
      if (modulus != spec.shear_modulus)
        report.line("shear modulus of " + spec.name, print("%.6g (at rest: 2 (c1 + c2))", modulus));
      if (spec.viscosity)
        report.line("viscosity of " + spec.name,
                    print("%.6g, %.6g times the fluid's", *spec.viscosity, *spec.viscosity / config_.fluid.viscosity));
      if (modulus > 0 && speed > 0) capillary(spec, config_.fluid.viscosity / modulus, "/ shear modulus");
      const Membrane &membrane = spec.membrane;
      if (spec.is_membrane())
        report.line(
            "membrane of " + spec.name,
            print("shear modulus %.6g, area dilation modulus %.6g, bending modulus %.6g", membrane.shear_modulus,
                  membrane.largest_modulus() - membrane.shear_modulus, membrane.bending_modulus));
      const Real3 &axes = spec.semi_axes;
      const double radius = spec.shape == Shape::ellipsoid ? std::cbrt(axes[0] * axes[1] * axes[2]) : spec.radius;
      if (spec.surface_tension > 0 && radius > 0 && speed > 0)
        capillary(spec, config_.fluid.viscosity * radius / spec.surface_tension, "x radius / surface tension");
      if (spec.is_membrane() && radius > 0 && speed > 0)
        capillary(spec, config_.fluid.viscosity * radius / membrane.shear_modulus, "x radius / surface shear modulus");
    }
  }

  void time_step(Report &report, int ranks) const {
    FlowExtremes extremes;
    extremes.speed = flow_scale(config_).speed;
    ViscosityContrast contrast(config_.fluid);
    for (const SpeciesSpec &spec : config_.species) {
      const Real3 &l = spec.initial_stretch;
      const double trace = l[0] * l[0] + l[1] * l[1] + l[2] * l[2];
      const double stiffness = largest_stiffness(spec.material(), trace, dimension_);
      contrast.add(spec.material(), stiffness);
      extremes.stiffness = std::max(extremes.stiffness, stiffness);
    }
    const TimeStepLimits limits =
        time_step_limits(spacing_, dimension_, config_.fluid, contrast, config_.sides, extremes,
                         {config_.method.staggered(), !config_.method.explicit_viscosity()});
    report.limit("viscous", limits.viscous);
    report.limit("elastic wave", limits.elastic);
    report.limit("viscous and elastic", limits.combined);
    report.limit("Kelvin-Voigt", limits.kelvin_voigt);
    if (contrast.surface_tension > 0) {
      report.limit("capillary wave", limits.capillary);
      report.limit("viscous surface", limits.capillary_viscous);
    }
    if (contrast.bending_modulus > 0) {
      report.limit("bending wave", limits.bending);
      report.limit("viscous bending", limits.bending_viscous);
    }
    report.limit("advective", limits.advective);
    if (!limits.scheme.staggered) report.limit("Euler 2 nu/U^2", limits.inertial);
    const char *name = "-time_step";
    double dt = limits.automatic(&name);
    if (config_.time.step > 0) {
      dt = config_.time.step;
      name = "-time_step";
      if (const char *broken = limits.exceeded_limit(dt))
        report.line("warning", print("-time_step %g exceeds the %s limit", dt, broken));
    }
    if (!std::isfinite(dt)) dt = config_.time.end, name = "-time_end: nothing limits it";
    double steps = std::ceil(config_.time.end / dt);
    if (config_.time.steps_max > 0) steps = std::min(steps, double(config_.time.steps_max));
    report.line("time step (estimate)", print("%.6g (%s)", dt, name));
    report.line("steps (estimate)", print("%.0f", steps));
    wall_time(report, steps, dt / limits.viscous, ranks, contrast.exists());
  }

private:
  struct StepCost {
    double per_cell, fixed;  ///< in ns per cell, and in us
  };
  /// In 3-D from user times of short runs on one core of 2024 (AVX-512): options/channel_rbc.opts, its plasma alone,
  /// and options/capillary_h20.opts at two time steps, reproduced within 15 %; with a viscosity contrast of
  /// options/channel_red_cells.opts. In 2-D, and for the fixed part, from runs of the validation on one rank, of 128 to
  /// 131072 cells, mostly within 50 %: fewer directions and components, and fields that fit into the cache. Crowds in
  /// 2-D take up to four times as long. `viscous`: time step over the viscous limit.
  StepCost step_cost(double viscous, bool contrast) const {
    const double phases = double(config_.species.size());
    const bool flat = dimension_ == 2;
    if (config_.method.explicit_viscosity()) return {flat ? 10 + 6 * phases : 45 + 85 * phases, 10 + 10 * phases};
    const double stages = rkl_stages(viscous, 1);
    if (config_.method.implicit_viscosity(contrast, has_rigid_bodies())) return {1700 + 250 * phases, 500};
    if (flat) return {15 + stages + 25 * phases, 20 + 3 * stages + 80 * phases};
    const double of_contrast = contrast ? 40 + 6 * stages : 0, of_phases = phases > 0 ? 10 * stages + 250 * phases : 0;
    return {70 + 8 * stages + of_phases + of_contrast, 20 + 3 * stages + 80 * phases};
  }
  void wall_time(Report &report, double steps, double viscous, int ranks, bool contrast) const {
    const Int3 &n = config_.grid.cells;
    const double cells = double(n[0]) * n[1] * n[2];
    const StepCost cost = step_cost(viscous, contrast);
    const int cores = ranks * config_.threads;
    const double of_step = 1e-9 * cost.per_cell * cells / cores + 1e-6 * cost.fixed, seconds = of_step * steps;
    const char *unit = "seconds";
    double time = seconds;
    if (seconds >= 100) time = seconds / 60, unit = "minutes";
    if (seconds >= 6000) time = seconds / 3600, unit = "hours";
    if (seconds >= 360000) time = seconds / 86400, unit = "days";
    report.line("wall time (estimate)", print("%.3g %s on %d core%s, %.2g us per cell, step and core", time, unit,
                                              cores, cores > 1 ? "s" : "", 1e6 * of_step * cores / cells));
  }
  bool has_rigid_bodies() const {
    return std::any_of(config_.species.begin(), config_.species.end(),
                       [](const SpeciesSpec &spec) { return spec.law == Law::rigid; });
  }
  bool stretched() const {
    bool any = !config_.initial_state.empty();
    for (const SpeciesSpec &spec : config_.species)
      for (int d = 0; d < dimension_; ++d) any = any || spec.initial_stretch[d] != 1 || spec.stretch_force.force > 0;
    return any;
  }

  const Config &config_;
  int dimension_;
  Real3 spacing_{};
};

}  // namespace

std::string check_report(const Config &config, int ranks) {
  const Check check(config);
  Report report;
  check.grid(report, ranks);
  check.bodies(report);
  for (const std::string &line : side_lines(config)) report.text += line + "\n";
  check.flow(report);
  check.time_step(report, ranks);
  return report.text;
}

}  // namespace eulastic
