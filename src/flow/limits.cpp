#include "flow/limits.hpp"

#include "base/exact_sum.hpp"
#include "field/law.hpp"
#include "field/open_boundaries.hpp"
#include "grid/threads.hpp"
#include "kernels/isa.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace eulastic {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
// Fractions of the limits for the automatic step (docs/method.md, section 8). Euler lowers the viscosity by U^2 dt/2; a
// tenth of 2 nu/U^2 keeps this below 10 % where the flow is fastest.
constexpr double combined_share = 0.8, inertial_share = 0.1;
constexpr double advective_euler = 0.25, advective_staggered = 0.3;
constexpr double elastic_share = 0.5, kelvin_voigt_share = 0.05, forcing_share = 1. / 40;
constexpr double capillary_share = 0.5, capillary_viscous_share = 0.4;
constexpr double pi = 3.14159265358979323846;

double ratio(double a, double b) { return b > 0 ? a / b : infinite; }

struct RowExtremes {
  double largest = 0;
  bool bad = false;  ///< whether there are infinities or NaN
};

// Returns the largest |value(i)| over all i for which counts(i) is true. Non-finite values are found at any i.
template <class Value, class Counts>
EULASTIC_INLINE RowExtremes extremes_of(int begin, int end, Value value, Counts counts) {
  double largest = 0;
  bool bad = false;
#pragma omp simd reduction(max : largest) reduction(| : bad)
  for (int i = begin; i < end; ++i) {
    const double a = __builtin_fabs(value(i)), counted = counts(i) ? a : 0;
    largest = counted > largest ? counted : largest;
    bad |= !(a <= std::numeric_limits<double>::max());
  }
  return {largest, bad};
}

EULASTIC_CLONES RowExtremes row_extremes(const double *q, int begin, int end) {
  return extremes_of(
      begin, end, [=](int i) EULASTIC_BODY { return q[i]; }, [](int) EULASTIC_BODY { return true; });
}

// Extremes of tr B where phi >= least. In 2-D B_zz = 1 and zz is null.
EULASTIC_CLONES RowExtremes trace_extremes(const double *xx, const double *yy, const double *zz, const double *phi,
                                           double least, int begin, int end) {
  const auto evolves = [=](int i) EULASTIC_BODY { return phi[i] >= least; };
  if (!zz)
    return extremes_of(
        begin, end, [=](int i) EULASTIC_BODY { return xx[i] + yy[i] + 1.0; }, evolves);
  return extremes_of(
      begin, end, [=](int i) EULASTIC_BODY { return xx[i] + yy[i] + zz[i]; }, evolves);
}

// Maxima of the speeds, of minus the index of the first bad cell, and of the traces of the phases.
class Extremes {
public:
  explicit Extremes(std::size_t phases) : largest_(first_trace + phases) { largest_[bad_cell] = -infinite; }

  void add_velocity(const Box &box, const RowPart &rows, const Field &velocity) {
    const int n = box.cells()[0];
    for (int d = 0; d < velocity.count(); ++d)
      for (int k = rows.k_begin; k < rows.k_end; ++k)
        for (int j = rows.j_begin; j < rows.j_end; ++j) {
          const double *row = velocity[d].row(j, k);
          const RowExtremes r = row_extremes(row, 0, n);
          largest_[d] = std::max(largest_[d], r.largest);
          if (r.bad) record_bad_cell(box, row, {0, n, j, k});
        }
    for (int d = 0; d < velocity.count() && rows.first; ++d)
      for (const Segment &row : box.boundary_faces(d, true))
        largest_[d] =
            std::max(largest_[d], row_extremes(velocity[d].row(row.j, row.k), row.i_begin, row.i_end).largest);
  }

  /// Adds part `part` of `parts` of the segments in which a phase evolves.
  void add_phase(const Box &box, int part, int parts, const Phase &phase, int number) {
    const Int3 &n = box.cells();
    const std::vector<Segment> &solid = phase.tensor.evolving.all();
    const Piece piece(solid.size(), part, parts);
    double most = 3;
    for (std::size_t at = piece.begin; at < piece.end; ++at) {
      Segment s = solid[at];
      if (s.j >= n[1] || s.k >= n[2]) continue;
      s.i_end = std::min(s.i_end, n[0]);
      const auto row = [&](int f) { return phase.tensor.field[f].row(s.j, s.k); };
      const double *xx = row(0), *yy = row(1), *zz = box.dimension() == 3 ? row(2) : nullptr;
      const RowExtremes r =
          trace_extremes(xx, yy, zz, phase.fraction[0].row(s.j, s.k), phase.tensor.rule.centre, s.i_begin, s.i_end);
      most = std::max(most, r.largest);
      if (!r.bad) continue;
      record_bad_cell(box, xx, s);
      record_bad_cell(box, yy, s);
      if (zz) record_bad_cell(box, zz, s);
    }
    largest_[first_trace + number] = std::max(largest_[first_trace + number], most);
  }

  const std::vector<double> &largest() const { return largest_; }
  static constexpr int bad_cell = 3, first_trace = 4;

private:
  /// Records the cell of the first non-finite value of a row.
  void record_bad_cell(const Box &box, const double *row, const Segment &s) {
    const Int3 &N = box.domain_cells(), &begin = box.layout().begin;
    const double y = box.image(1, begin[1] + s.j), z = box.image(2, begin[2] + s.k);
    for (int i = s.i_begin; i < s.i_end; ++i)
      if (!std::isfinite(row[i])) {
        const double cell = box.image(0, begin[0] + i) + double(N[0]) * (y + double(N[1]) * z);
        largest_[bad_cell] = std::max(largest_[bad_cell], -cell);
        return;
      }
  }

  std::vector<double> largest_;
};

}  // namespace

double FlowExtremes::max_speed() const { return std::max({speed[0], speed[1], speed[2]}); }

double stretch_squared(double trace, int dimension) {
  if (dimension == 2) {
    const double t = std::max(trace - 1, 2.0);
    return 0.5 * (t + std::sqrt(t * t - 4));
  }
  // The largest root of x + 2/sqrt(x) = trace: with y = sqrt(x) the largest root of y^3 - trace y + 2 = 0.
  const double t = std::max(trace, 3.0);
  const double y = 2 * std::sqrt(t / 3) * std::cos(std::acos(-std::sqrt(27 / (t * t * t))) / 3);
  return y * y;
}

double inverse_stretch_squared(double trace, int dimension) {
  if (dimension == 2) return stretch_squared(trace, dimension);
  // With the least stretch y, 2/y + y^2 = trace: y is the least positive root of the same cubic.
  const double t = std::max(trace, 3.0);
  const double y = 2 * std::sqrt(t / 3) * std::cos((std::acos(-std::sqrt(27 / (t * t * t))) - 2 * pi) / 3);
  return 1 / (y * y);
}

double largest_stiffness(const Material &material, double trace, int dimension) {
  const kernels::StretchBounds bounds{stretch_squared(trace, dimension), inverse_stretch_squared(trace, dimension),
                                      std::max(trace - 3, 0.0)};
  return with_law(material, [&](const auto &law) { return law.stiffness(bounds); });
}

PetscErrorCode measure_extremes(const Domain &domain, const Field &velocity, const std::vector<Phase> &phases,
                                FlowExtremes *extremes, const std::vector<BodyInBox> &bodies) {
  PetscFunctionBeginUser;
  const int parts = row_parts(domain);
  std::vector<std::vector<double>> maxima(parts);
  in_parallel(parts, parts, [&](int part) {
    Extremes part_extremes(phases.size());
    part_extremes.add_velocity(domain, row_part(domain, part, parts), velocity);
    for (std::size_t p = 0; p < phases.size(); ++p)
      part_extremes.add_phase(domain, part, parts, phases[p], static_cast<int>(p));
    const Piece own(bodies.size(), part, parts);
    for (std::size_t b = own.begin; b < own.end; ++b)
      part_extremes.add_phase(*bodies[b].box, 0, 1, *bodies[b].phase, bodies[b].species);
    maxima[part] = part_extremes.largest();
  });
  std::vector<double> largest;
  PetscCall(reduce_maxima(domain.comm(), maxima, &largest));
  extremes->speed = {largest[0], largest[1], largest[2]};
  extremes->first_non_finite = largest[Extremes::bad_cell] == -infinite ? -1 : -largest[Extremes::bad_cell];
  extremes->trace.assign(largest.begin() + Extremes::first_trace, largest.end());
  extremes->stiffness = 0;
  for (std::size_t p = 0; p < phases.size(); ++p)
    extremes->stiffness =
        std::max(extremes->stiffness, largest_stiffness(phases[p].material, extremes->trace[p], domain.dimension()));
  PetscFunctionReturn(0);
}

TimeStepLimits time_step_limits(const Real3 &spacing, int dimension, const Fluid &fluid,
                                const ViscosityContrast &contrast, const BoundaryConditions &sides,
                                const FlowExtremes &extremes, const StepScheme &scheme) {
  double S = 0, crossing = 0, gain = 0, speed_squared = 0, frequency = std::fabs(fluid.body_force.frequency);
  for (int d = 0; d < dimension; ++d) {
    double speed = extremes.speed[d];
    for (const auto &pair : sides)
      for (const BoundaryCondition &side : pair) {
        speed = std::max(speed, std::fabs(side.motion.velocity[d]));
        frequency = std::max({frequency, std::fabs(side.motion.frequency), side.given.angular_frequency()});
      }
    speed = std::max(speed, inflow_speed(sides)[d]);
    S += 1 / (spacing[d] * spacing[d]);
    crossing += speed / spacing[d];
    gain += std::fabs(fluid.body_force.force[d]) / spacing[d];
    speed_squared += speed * speed;
  }
  // In 3-D the spectrum of the deviatoric stress with variable viscosity extends to 4/3 of that of the Laplacian.
  const bool varies = contrast.exists();
  const double nu =
      varies ? (dimension == 3 ? 4. / 3 : 1) * contrast.most / fluid.density : fluid.kinematic_viscosity();
  const double least = varies ? contrast.least / fluid.density : nu;
  const double c_squared = extremes.stiffness / fluid.density;
  const double share = scheme.staggered ? advective_staggered : advective_euler;
  TimeStepLimits limits{};
  limits.scheme = scheme;
  limits.viscous = ratio(1, 2 * nu * S);
  limits.elastic = ratio(1, std::sqrt(c_squared * S));
  limits.combined = ratio(1, nu * S + std::sqrt(nu * nu * S * S + c_squared * S));
  limits.kelvin_voigt = varies ? contrast.kelvin_voigt : ratio(2 * fluid.viscosity, extremes.stiffness);
  limits.advective = ratio(2 * share, crossing + std::sqrt(crossing * crossing + 4 * gain * share));
  limits.inertial = fluid.inertia && least > 0 ? ratio(2 * least, speed_squared) : infinite;
  const double shortest = *std::min_element(spacing.begin(), spacing.begin() + dimension);
  limits.capillary =
      std::sqrt(ratio(fluid.density * shortest * shortest * shortest, 2 * pi * contrast.surface_tension));
  limits.capillary_viscous = ratio(shortest, contrast.capillary_speed);
  const double wave_number = pi / (2 * shortest), cubed = wave_number * wave_number * wave_number;
  limits.bending = std::sqrt(ratio(8 * fluid.density, contrast.bending_modulus * cubed * (wave_number * wave_number)));
  limits.bending_viscous = ratio(8, contrast.bending_rate * cubed);
  limits.forcing = ratio(2 * pi, frequency);
  return limits;
}

double TimeStepLimits::automatic(const char **name) const {
  struct Bound {
    double dt;
    const char *name;
  };
  std::vector<Bound> bounds{{advective, "advective"}, {forcing_share * forcing, "forcing period"}, {bonds, "bonds"}};
  if (scheme.rkl)
    bounds.push_back(elastic_share * elastic > kelvin_voigt_share * kelvin_voigt
                         ? Bound{elastic_share * elastic, "elastic wave"}
                         : Bound{kelvin_voigt_share * kelvin_voigt, "Kelvin-Voigt"});
  else
    bounds.push_back(combined_share * combined < elastic_share * elastic
                         ? Bound{combined_share * combined, elastic < viscous ? "elastic wave" : "viscous"}
                         : Bound{elastic_share * elastic, "elastic wave"});
  const double wave = capillary_share * capillary, viscous_surface = capillary_viscous_share * capillary_viscous;
  bounds.push_back({scheme.rkl ? std::max(wave, viscous_surface) : wave, "capillary wave"});
  const double bending_wave = capillary_share * bending, slow_bending = capillary_viscous_share * bending_viscous;
  bounds.push_back({scheme.rkl ? std::max(bending_wave, slow_bending) : bending_wave, "bending wave"});
  if (!scheme.staggered) bounds.push_back({inertial_share * inertial, "Euler 2 nu/U^2"});
  const auto least =
      std::min_element(bounds.begin(), bounds.end(), [](const Bound &a, const Bound &b) { return a.dt < b.dt; });
  if (name) *name = least->name;
  return least->dt;
}

const char *TimeStepLimits::exceeded_limit(double dt) const {
  const double share = scheme.staggered ? advective_staggered : advective_euler;
  if (scheme.rkl) {
    if (dt >= std::max(elastic, kelvin_voigt)) return "elastic wave and Kelvin-Voigt";
  } else if (dt >= combined) {
    return dt >= viscous ? "viscous" : "viscous + elastic wave";
  }
  if (dt >= (scheme.rkl ? std::max(capillary, capillary_viscous) : capillary)) return "capillary wave";
  if (dt >= (scheme.rkl ? std::max(bending, bending_viscous) : bending)) return "bending wave";
  if (dt >= advective / share) return "advective";
  if (!scheme.staggered && dt >= inertial) return "Euler 2 nu/U^2";
  return nullptr;
}

}  // namespace eulastic
