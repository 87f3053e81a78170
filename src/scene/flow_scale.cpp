#include "scene/flow_scale.hpp"

#include "bodies/shapes.hpp"
#include "field/open_boundaries.hpp"
#include "scene/lumens.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace eulastic {
namespace {

// A body from a file that fills the box but for a lumen.
bool is_vessel_of_file(const Config &config, std::size_t s) {
  const SpeciesSpec &spec = config.species[s];
  return spec.shape == Shape::voxels &&
         (spec.voxels.invert || count_bodies(config, s).total() > 0.5 * config.grid.volume());
}

// The largest velocity of a profile, whose mean is 1.
double largest_of_mean(const BoundaryCondition &side) {
  if (!side.profile || side.profile->empty()) return 1;
  double most = 0;
  for (const double shape : *side.profile) most = std::max(most, std::fabs(shape));
  return most;
}

class Estimate {
public:
  explicit Estimate(const Config &config) : config_(config), dimension_(config.grid.dimension()) {}

  FlowScale make() {
    find_length();
    driven_by_walls();
    driven_by_force();
    driven_by_inflow();
    driven_by_bodies();
    driven_by_initial_flow();
    if (rate_ == 0 && has_something_that_shears()) return scale_;
    scale_.shear_rate = rate_;
    return scale_;
  }

private:
  bool is_wall(int d) const { return d < dimension_ && config_.grid.boundary[d] == Boundary::wall; }

  // Slabs normal to direction d that stay where they are, as far as they lie in the box, from the low side on.
  std::vector<std::array<double, 2>> slabs(int d) const {
    std::vector<std::array<double, 2>> all;
    for (const SpeciesSpec &spec : config_.species) {
      const bool fixed = spec.law == Law::rigid || spec.material().anchored;
      if (spec.shape != Shape::slab || spec.axis != d || !fixed || spec.motion.velocity[d] != 0) continue;
      all.push_back({std::max(spec.interval[0], 0.0), std::min(spec.interval[1], config_.grid.length[d])});
    }
    std::sort(all.begin(), all.end());
    return all;
  }

  // The largest one between neighbouring walls and slabs; 0 where there is none. Planes of symmetry, and other sides
  // without a wall, mirror what is beside them; between periodic sides the last slab is beside the image of the first.
  double gap(int d) const {
    if (d >= dimension_) return 0;
    const double length = config_.grid.length[d];
    const std::array<bool, 2> wall{config_.boundary.is_wall(d, 0), config_.boundary.is_wall(d, 1)};
    const auto inside = slabs(d);
    if (inside.empty()) return wall[0] && wall[1] ? length : wall[0] || wall[1] ? 2 * length : 0;
    double widest = 0, end = inside[0][1];
    for (const auto &slab : inside) {
      widest = std::max(widest, slab[0] - end);
      end = std::max(end, slab[1]);
    }
    const double low = inside[0][0], high = length - end;
    if (!config_.boundary.bounded(d)) return std::max(widest, low + high);
    return std::max({widest, (wall[0] ? 1 : 2) * low, (wall[1] ? 1 : 2) * high});
  }

  // A fluid without walls or bodies moves uniformly.
  bool has_something_that_shears() const { return !config_.species.empty() || gap(0) > 0 || gap(1) > 0 || gap(2) > 0; }

  // The direction in which the flow is driven through a vessel from a file: of open sides, else of the largest force,
  // else the longest side of the box.
  int axis_of_vessels() const {
    const Real3 &force = config_.fluid.body_force.force, &length = config_.grid.length;
    int axis = 0;
    for (int d = 1; d < dimension_; ++d)
      if (std::pair{std::fabs(force[d]), length[d]} > std::pair{std::fabs(force[axis]), length[axis]}) axis = d;
    for (int d = dimension_ - 1; d >= 0; --d)
      if (config_.grid.open[d][0] || config_.sides[d][0].kind == BoundaryKind::inflow) axis = d;
    return axis;
  }

  // Of a tube its diameter, of a vessel from a file that of a tube with the mean cross-section of its lumen.
  void find_length() {
    const Real3 &box = config_.grid.length;
    double width = std::numeric_limits<double>::infinity();
    for (int d = 0; d < dimension_; ++d)
      if (gap(d) > 0) width = std::min(width, gap(d));
    for (std::size_t s = 0; s < config_.species.size(); ++s) {
      const SpeciesSpec &spec = config_.species[s];
      if (is_tube(spec.shape)) lumen_axis_ = spec.axis, lumen_ = 2 * spec.radius;
      if (!is_vessel_of_file(config_, s)) continue;
      lumen_axis_ = axis_of_vessels();
      const double section = (config_.grid.volume() - count_bodies(config_, s).total()) / box[lumen_axis_];
      lumen_ = dimension_ == 2 ? section : 2 * std::sqrt(std::max(section, 0.0) / M_PI);
    }
    if (lumen_ > 0) width = std::min(width, lumen_);
    scale_.length = std::isfinite(width) ? width : *std::min_element(box.begin(), box.begin() + dimension_);
  }

  void driven_by_walls() {
    for (int d = 0; d < dimension_; ++d) {
      if (!is_wall(d)) continue;
      const WallMotion &low = config_.sides[d][0].motion, &high = config_.sides[d][1].motion;
      for (int c = 0; c < dimension_; ++c) {
        scale_.speed[c] = std::max({scale_.speed[c], std::fabs(low.velocity[c]), std::fabs(high.velocity[c])});
        const double across = slabs(d).empty() ? std::fabs(high.velocity[c] - low.velocity[c])
                                               : std::max(std::fabs(low.velocity[c]), std::fabs(high.velocity[c]));
        if (gap(d) > 0) rate_ = std::max(rate_, across / std::min(gap(d), config_.grid.length[d]));
      }
    }
  }

  bool has_obstacles() const {
    for (std::size_t s = 0; s < config_.species.size(); ++s)
      if (is_wall_species(config_, s) && !is_tube(config_.species[s].shape) && !is_vessel_of_file(config_, s))
        return true;
    return false;
  }

  // A channel of height H reaches f H^2/(8 nu) with the shear rate f H/(2 nu) at its walls, a tube f R^2/(4 nu) and
  // f R/(2 nu) along its axis; what is free accelerates to the end.
  void driven_by_force() {
    const BodyForce &force = config_.fluid.body_force;
    const double nu = config_.fluid.kinematic_viscosity();
    const Real3 pressures = pressure_drive(config_.sides, config_.grid.length, config_.fluid.density);
    for (int c = 0; c < dimension_; ++c) {
      if (is_wall(c) && !(config_.grid.open[c][0] && config_.grid.open[c][1])) continue;  // pressure takes it
      double f = std::fabs(force.force[c]) + pressures[c];
      for (const SpeciesSpec &spec : config_.species) f += std::fabs(spec.body_force.force[c]);
      double speed = f * (force.frequency > 0 ? std::min(config_.time.end, 2 / force.frequency) : config_.time.end);
      const bool tube = lumen_ > 0 && lumen_axis_ == c;
      bool limited = tube && nu > 0;
      if (limited && dimension_ == 3) speed = limit(speed, f * lumen_ * lumen_ / (16 * nu), f * lumen_ / (4 * nu));
      if (limited && dimension_ == 2) speed = limit(speed, f * lumen_ * lumen_ / (8 * nu), f * lumen_ / (2 * nu));
      for (int d = 0; d < dimension_; ++d) {
        const double height = gap(d);
        if (tube || height == 0 || d == c || nu == 0) continue;
        limited = true;
        speed = limit(speed, f * height * height / (8 * nu), f * height / (2 * nu));
      }
      scale_.speed_is_bound = scale_.speed_is_bound || (f > 0 && !limited && has_obstacles());
      scale_.speed[c] = std::max(scale_.speed[c], speed);
    }
  }
  double limit(double speed, double developed, double shear_rate) {
    rate_ = std::max(rate_, shear_rate);
    return std::min(speed, developed);
  }

  // What comes in fills what rigid bodies leave of a side, and what elastic walls leave of the box; developed it is at
  // most twice as fast in the middle, with the shear rate 8 U/D at the wall.
  void driven_by_inflow() {
    const double box = config_.grid.volume();
    double free = 1;
    for (std::size_t s = 0; s < config_.species.size(); ++s)
      if (is_wall_species(config_, s) && config_.species[s].law != Law::rigid)
        free -= count_bodies(config_, s).total() / box;
    for (int d = 0; d < dimension_ && free > 0; ++d)
      for (const int high : {0, 1}) {
        if (config_.sides[d][high].kind != BoundaryKind::inflow) continue;
        const double shape = largest_of_mean(config_.sides[d][high]);
        const double speed = 2 * shape * largest_inflow(config_, d, high) / free;
        scale_.speed[d] = std::max(scale_.speed[d], speed);
        rate_ = std::max(rate_, 4 * speed / scale_.length);
      }
  }

  void driven_by_bodies() {
    for (const SpeciesSpec &spec : config_.species) {
      const Real3 &v = spec.motion.velocity, &w = spec.motion.angular_velocity, &l = config_.grid.length;
      double reach = spec.shape == Shape::voxels ? std::max(l[0], l[1]) / 2 : spec.radius;
      for (int d = 0; d < dimension_; ++d) reach = std::max(reach, spec.semi_axes[d]);
      for (int d = 0; d < dimension_; ++d)
        scale_.speed[d] =
            std::max(scale_.speed[d], std::fabs(v[d]) + reach * std::hypot(w[(d + 1) % 3], w[(d + 2) % 3]));
      rate_ = std::max({rate_, std::hypot(w[0], w[1], w[2]), std::hypot(v[0], v[1], v[2]) / scale_.length});
    }
  }

  void driven_by_initial_flow() {
    const InitialFlow &initial = config_.initial;
    const bool moves = initial.kind != InitialVelocity::zero && initial.kind != InitialVelocity::uniform &&
                       initial.kind != InitialVelocity::couette;
    const double amplitude = moves ? std::fabs(initial.amplitude) : 0;
    for (int d = 0; d < dimension_; ++d)
      scale_.speed[d] = std::max(scale_.speed[d], std::fabs(initial.mean[d]) + amplitude);
    rate_ = std::max(rate_, 2 * M_PI * amplitude / scale_.length);
  }

  const Config &config_;
  int dimension_, lumen_axis_ = 0;
  double lumen_ = 0;  // width of the lumen of a vessel, 0 without
  double rate_ = 0;
  FlowScale scale_;
};

}  // namespace

double FlowScale::largest_speed() const { return std::max({speed[0], speed[1], speed[2]}); }

BodyCount count_bodies(const Config &config, std::size_t s) {
  const SpeciesSpec &spec = config.species[s];
  if (spec.shape == Shape::state) return {};
  if (spec.shape == Shape::voxels) return {1, config.solid_volumes[s]};
  return {double(config.places[s].count), volume_in_box(spec, config.grid)};
}

bool is_wall_species(const Config &config, std::size_t s) {
  const SpeciesSpec &spec = config.species[s];
  if (spec.material().anchored || spec.law == Law::rigid || is_vessel_of_file(config, s)) return true;
  bool random = false;  // bodies from files are then what the others are put around
  for (const SpeciesSpec &other : config.species) random = random || other.placement == Placement::random;
  return spec.shape == Shape::voxels && random;
}

FlowScale flow_scale(const Config &config) { return Estimate(config).make(); }

}  // namespace eulastic
