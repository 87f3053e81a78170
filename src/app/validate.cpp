#include "app/validate.hpp"

#include <fstream>
#include <limits>

namespace eulastic {
namespace {

bool flat(const Config &config) { return config.grid.cells[2] == 1; }

std::string check_grid(const Config &config) {
  GridSpec serial = config.grid;
  serial.processors = {0, 0, 0};
  if (const std::string reason = Grid::why_not(serial, 1); !reason.empty()) return "-grid_cells: " + reason;
  if (flat(config) && config.grid.boundary[2] == Boundary::wall)
    return "-boundary_z: wall needs more than one cell in z; accepted in 2-D: periodic";
  double cells = 1;
  for (int n : config.grid.cells) cells *= n;
  if (!config.check_only && cells > std::numeric_limits<PetscInt>::max())
    return "-grid_cells: more cells than this PETSc can number; accepted: at most " +
           std::to_string(std::numeric_limits<PetscInt>::max()) + ", or a PETSc with 64-bit indices";
  return {};
}

std::string check_vector(const Config &config, const std::string &name, const Real3 &value) {
  if (flat(config) && value[2] != 0) return "-" + name + ": the z component must be 0 in 2-D (one cell in z)";
  return {};
}

std::string check_walls(const Config &config) {
  for (int d = 0; d < 3; ++d)
    for (int side = 0; side < 2; ++side) {
      const Real3 &velocity = config.walls.motion[d][side].velocity;
      const std::string name = std::string("wall_") + "xyz"[d] + (side ? "max" : "min") + "_velocity";
      if (velocity[d] != 0) return "-" + name + ": the " + "xyz"[d] + " component is normal to the wall and must be 0";
      if (const std::string wrong = check_vector(config, name, velocity); !wrong.empty()) return wrong;
    }
  return {};
}

std::string check_flow(const Config &config) {
  if (const std::string wrong = check_vector(config, "body_force", config.fluid.body_force.force); !wrong.empty())
    return wrong;
  const InitialFlow &initial = config.initial;
  if (const std::string wrong = check_vector(config, "initial_velocity_mean", initial.mean); !wrong.empty())
    return wrong;
  for (int d = 0; d < 3; ++d)
    if (config.grid.boundary[d] == Boundary::wall && initial.mean[d] != 0)
      return std::string("-initial_velocity_mean: the ") + "xyz"[d] + " component must be 0 between walls";
  const std::string &name = initial_velocity_names()[static_cast<int>(initial.kind)];
  const bool between_walls = initial.kind == InitialVelocity::couette || initial.kind == InitialVelocity::poiseuille;
  if (between_walls && config.grid.boundary[1] != Boundary::wall)
    return "-initial_velocity: " + name + " needs -boundary_y wall";
  const auto [component, along] = shear_wave_directions(initial.kind);
  if (flat(config) && (component == 2 || along == 2 || initial.kind == InitialVelocity::taylor_green_3d))
    return "-initial_velocity: " + name + " needs more than one cell in z";
  return {};
}

std::string check_species(const Config &config, const SpeciesSpec &spec) {
  if (spec.shape == Shape::slab) {
    const auto [low, high] = spec.interval;
    if (!(low < high)) return "-" + spec.name + "_interval: the low side must be below the high side";
    if (high <= 0 || low >= config.grid.length[spec.axis])
      return "-" + spec.name + "_interval: the slab is outside the box; accepted: a part of 0 to " +
             std::to_string(config.grid.length[spec.axis]);
    if (flat(config) && spec.axis == 2) return "-" + spec.name + "_axis: a slab in 2-D lies across x or y";
    if (spec.placement != Placement::one) return "-" + spec.name + "_placement: a slab is placed by its interval: one";
  }
  if (flat(config) && spec.initial_stretch[2] != 1)
    return "-" + spec.name + "_initial_stretch: the z stretch must be 1 in 2-D (one cell in z)";
  if (flat(config) && spec.count[2] != 1) return "-" + spec.name + "_count: must be 1 along z in 2-D";
  if (spec.placement == Placement::list && !std::ifstream(spec.positions_file))
    return "-" + spec.name + "_positions: " + spec.positions_file + " cannot be read";
  return {};
}

std::string check_method(const Config &config) {
#ifndef EULASTIC_HAVE_FFTW
  if (config.method.pressure == PressureKind::smac)
    return "-pressure_solver: smac needs FFTW, which this build has not; accepted: acm";
#endif
  (void)config;
  return {};
}

}  // namespace

std::string validate(const Config &config) {
  for (const auto check : {check_grid, check_walls, check_flow, check_method})
    if (const std::string wrong = check(config); !wrong.empty()) return wrong;
  for (const SpeciesSpec &spec : config.species)
    if (const std::string wrong = check_species(config, spec); !wrong.empty()) return wrong;
  return {};
}

}  // namespace eulastic
