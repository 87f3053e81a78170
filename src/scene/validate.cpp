#include "scene/validate.hpp"

#include "base/one_line.hpp"
#include "base/rank_zero.hpp"
#include "bodies/seeding.hpp"
#include "field/open_boundaries.hpp"
#include "grid/domain.hpp"
#include "io/option_values.hpp"
#include "openings/leaving.hpp"
#include "pressure/smac.hpp"
#include "scene/adhesion_checks.hpp"
#include "scene/closed_faces.hpp"
#include "scene/open_parts.hpp"
#include "scene/rigid_paths.hpp"
#include "scene/voxels.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

namespace eulastic {
namespace {

constexpr double most_unequal = 1000;  // spacings

bool flat(const Config &config) { return config.grid.dimension() == 2; }

std::string check_grid(const Config &config) {
  if (config.ranks > 0 && !config.check_only)
    return "-ranks: " + std::to_string(config.ranks) +
           " without -check_only; accepted: auto, because mpiexec -n sets the ranks of a run";
  GridSpec serial = config.grid;
  serial.processors = {0, 0, 0};
  if (const std::string reason = Domain::refusal_reason(serial, 1); !reason.empty()) return reason;
  if (flat(config) && config.grid.boundary[2] == Boundary::wall)
    return "-boundary_z: a boundary needs more than one cell in z; accepted in 2-D: periodic";
  double cells = 1;
  for (int n : config.grid.cells) cells *= n;
  if (!config.check_only && cells > std::numeric_limits<PetscInt>::max())
    return "-grid_cells: there are more cells than this PETSc can number; accepted: at most " +
           std::to_string(std::numeric_limits<PetscInt>::max()) +
           ", or a build with a PETSc of 64-bit indices (Debian: libpetsc64-real-dev)";
  return {};
}

std::string check_spacings(const Config &config) {
  const double shortest = config.grid.shortest_spacing(), longest = config.grid.longest_spacing();
  if (longest <= most_unequal * shortest) return {};
  return "-grid_length: one spacing is " + to_text(longest / shortest) + " times another; accepted: at most " +
         to_text(most_unequal) + " times";
}

std::string check_vector(const Config &config, const std::string &name, const Real3 &value) {
  if (flat(config) && value[2] != 0)
    return "-" + name + ": " + to_text(value[2]) + " along z in 2-D (one cell in z); accepted: 0 along z";
  return {};
}

std::string check_walls(const Config &config) {
  for (int d = 0; d < 3; ++d)
    for (int side = 0; side < 2; ++side) {
      const Real3 &velocity = config.sides[d][side].motion.velocity;
      const std::string name = "boundary_" + side_name(d, side) + "_velocity";
      if (velocity[d] != 0)
        return "-" + name + ": the " + "xyz"[d] + " component is normal to the wall; accepted: 0 along " + "xyz"[d];
      if (const std::string wrong = check_vector(config, name, velocity); !wrong.empty()) return wrong;
    }
  return {};
}

std::string check_flow(const Config &config) {
  if (const std::string wrong = check_vector(config, "body_force", config.fluid.body_force.force); !wrong.empty())
    return wrong;
  if (!config.initial_state.empty() && !is_file(config.initial_state))
    return "-initial_state: " + config.initial_state + " is not a file; accepted: an HDF5 file";
  const InitialFlow &initial = config.initial;
  if (const std::string wrong = check_vector(config, "initial_velocity_mean", initial.mean); !wrong.empty())
    return wrong;
  for (int d = 0; d < 3; ++d)
    if (config.grid.boundary[d] == Boundary::wall && initial.mean[d] != 0 &&
        !(fluid_crosses(config.sides[d][0].kind) && fluid_crosses(config.sides[d][1].kind)))
      return std::string("-initial_velocity_mean: a boundary in ") + "xyz"[d] + " is closed; accepted: 0 along " +
             "xyz"[d];
  const std::string &name = initial_velocity_names()[static_cast<int>(initial.kind)];
  const bool between_walls = initial.kind == InitialVelocity::couette || initial.kind == InitialVelocity::poiseuille;
  if (between_walls && !(config.boundary.is_wall(1, 0) && config.boundary.is_wall(1, 1)))
    return "-initial_velocity: " + name + " is a flow between walls; accepted: with -boundary_y wall";
  const auto [component, along] = shear_wave_directions(initial.kind);
  if (flat(config) && (component == 2 || along == 2 || initial.kind == InitialVelocity::taylor_green_3d))
    return "-initial_velocity: " + name + " is three-dimensional; accepted: with more than one cell in z";
  return {};
}

std::string check_membrane(const Config &config, const SpeciesSpec &spec) {
  if (!spec.is_membrane()) return {};
  const std::string name = spec.law == Law::red_cell ? "red_cell" : "membrane",
                    law = "-" + spec.name + "_law: " + name + " needs ";
  if (!config.method.staggered() || config.method.interface != InterfaceScheme::plic)
    return law + "-method fast and -interface_scheme plic; accepted here: neo_hookean, mooney_rivlin, rigid";
  if (is_anchored(spec.shape) || spec.shape == Shape::cylinder || spec.anchored.value_or(false))
    return law + "a closed surface; accepted: -" + spec.name + "_shape sphere, biconcave, ellipsoid, voxels";
  if (spec.shape == Shape::state)
    return law + "an initial shape at rest, which -initial_state does not contain; accepted: -" + spec.name +
           "_shape sphere, biconcave, ellipsoid, voxels with a file of velocities, or a run without -initial_state";
  if (spec.membrane.spontaneous_curvature != 0 && spec.membrane.bending_modulus == 0)
    return "-" + spec.name + "_spontaneous_curvature: requires a bending modulus; accepted: 0, or -" + spec.name +
           "_bending_modulus > 0";
  if (spec.stretch_force.force == 0 && spec.stretch_force.volume != StretchForce{}.volume)
    return "-" + spec.name + "_stretch_volume_fraction: requires a force on these ends; accepted: with -" + spec.name +
           "_stretch_force > 0, or " + to_text(StretchForce{}.volume);
  if (spec.stretch_force.force > 0 && !config.body_series)
    return "-" + spec.name + "_stretch_force: requires labelled bodies; accepted: -body_series true, or 0";
  return {};
}

// A slab that moves along its axis must not compress the fluid on its two sides.
bool piston_has_way_out(const Config &config, const SpeciesSpec &slab) {
  const DomainShape &grid = config.grid;
  for (int e = 0; e < 3; ++e)
    if (e != slab.axis && (grid.open[e][0] || grid.open[e][1])) return true;
  const auto across = [&](const SpeciesSpec &other) { return other.shape == Shape::slab && other.axis == slab.axis; };
  if (std::count_if(config.species.begin(), config.species.end(), across) > 1) return false;
  return grid.boundary[slab.axis] == Boundary::periodic || (grid.open[slab.axis][0] && grid.open[slab.axis][1]);
}

// Fluid must be able to pass around it; check_paths() checks its path.
std::string check_rigid(const Config &config, const SpeciesSpec &spec) {
  if (spec.law != Law::rigid) return {};
  const std::string name = "-" + spec.name + "_";
  const auto no = [&](const char *option, const char *why) { return name + option + ": " + why; };
  const RigidMotion &motion = spec.motion;
  const bool closed = is_closed(spec.shape) || spec.shape == Shape::voxels;
  for (int d = 0; d < 3; ++d) {
    const bool about_axis = spec.shape == Shape::cylinder && d == spec.axis;
    if (motion.angular_velocity[d] != 0 && ((flat(config) && d != 2) || !(closed || about_axis)))
      return no("angular_velocity",
                "cannot rotate this body about this axis; accepted: any axis of a sphere, ellipsoid, biconcave or "
                "voxels; the axis of a cylinder; in 2-D z only; otherwise 0,0,0");
    if (motion.velocity[d] == 0) continue;
    if (flat(config) && d == 2 && spec.shape != Shape::slab)
      return no("velocity", "the body moves along z in 2-D (one cell in z); accepted: 0 along z");
    const bool fluid_around = closed || (spec.shape == Shape::cylinder && !(flat(config) && spec.axis != 2));
    if (spec.shape == Shape::slab && d == spec.axis) {
      if (!piston_has_way_out(config, spec))
        return no("velocity",
                  "the slab would compress fluid that cannot leave the box; accepted: no other slab in its way, and "
                  "pressure, outflow or periodic boundaries at both ends of its way; or a pressure or outflow boundary "
                  "beside it");
    } else if (!spec.slides(d) && !fluid_around)
      return no(
          "velocity",
          "would carry the body through the grid, and fluid cannot pass around it; accepted: a velocity along the axis "
          "of a tube; any velocity of a slab, sphere, ellipsoid, biconcave, voxels or cylinder; otherwise 0,0,0");
    if (spec.slides(d) && config.grid.boundary[d] == Boundary::wall)
      return no("velocity",
                "the body would slide into the boundaries of the box; accepted: 0 along a direction that is not "
                "periodic");
  }
  return {};
}

// Sizes that the rows of the options do not relate to each other.
std::string check_shape(const Config &config, const SpeciesSpec &spec) {
  const std::string own = "-" + spec.name + "_";
  if (spec.shape == Shape::state && config.initial_state.empty())
    return own + "shape: state requires -initial_state, which is not given; accepted: another shape, or -initial_state";
  const bool varies_along_axis =
      spec.shape == Shape::biconcave || spec.shape == Shape::slab || spec.shape == Shape::constricted_tube;
  if (flat(config) && varies_along_axis && spec.axis == 2)
    return own + "axis: z cannot be the axis of this shape in 2-D (one cell in z); accepted: x, y";
  if (spec.shape == Shape::constricted_tube && !(spec.throat_radius < spec.radius))
    return own + "throat_radius: " + to_text(spec.throat_radius) +
           " is no narrower than the tube; accepted: less than " + to_text(spec.radius) + ", -" + spec.name + "_radius";
  if (spec.shape != Shape::slab) return {};
  const auto [low, high] = spec.interval;
  if (!(low < high))
    return own + "interval: the low side is not below the high side; accepted: low,high with low < high";
  if (high <= 0 || low >= config.grid.length[spec.axis])
    return own + "interval: the slab is outside the box; accepted: a part of 0," +
           to_text(config.grid.length[spec.axis]);
  return {};
}

std::string check_placement(const Config &config, const SpeciesSpec &spec) {
  const std::string own = "-" + spec.name + "_";
  const bool random = spec.placement == Placement::random;
  if ((is_from_file(spec.shape) || is_anchored(spec.shape)) && spec.placement != Placement::one)
    return own + "placement: a slab, a tube, voxels and state are a single body; accepted: one";
  if (spec.placement == Placement::lattice && spec.number >= 0)
    return own + "count: a lattice needs a number for each direction; accepted: 3 integers >= 1, separated by commas";
  if (random && spec.count != Int3{1, 1, 1})
    return own + "count: random placement needs a single number; accepted: an integer >= 0";
  if (flat(config) && spec.count[2] != 1)
    return own + "count: " + std::to_string(spec.count[2]) + " along z in 2-D (one cell in z); accepted: 1 along z";
  const double bodies = double(spec.count[0]) * spec.count[1] * spec.count[2];
  const Int3 &n = config.grid.cells;
  const double most = std::min(double(most_bodies), double(n[0]) * n[1] * n[2]);
  if (bodies > most)
    return own + "count: " + to_text(bodies) + " bodies; accepted: at most " + to_text(most) +
           (most < most_bodies ? ", one per cell" : "");
  if (random && (spec.number >= 0) == (spec.hematocrit >= 0))
    return own + "placement: random needs either " + own + "count or " + own + "hematocrit; accepted: one of them";
  if (random && spec.shape == Shape::cylinder)
    return own + "placement: random needs finite bodies; accepted: " + own + "shape sphere, biconcave, ellipsoid";
  if (spec.placement == Placement::list && !is_file(spec.positions_file))
    return own + "positions: " + spec.positions_file + " is not a file; accepted: a file with rows of x,y,z";
  return {};
}

// Solids are incompressible, so that det B must be 1; the surface of a membrane may have any area.
std::string check_initial_volume(const SpeciesSpec &spec) {
  constexpr double tolerance = 1e-3;
  const Real3 &stretch = spec.initial_stretch;
  const double product = stretch[0] * stretch[1] * stretch[2];
  if (spec.is_membrane() || std::fabs(product - 1) <= tolerance) return {};
  return "-" + spec.name + "_initial_stretch: the product of the stretches is " + print("%.4g", product) +
         ", but solids are incompressible; accepted: stretches with a product of 1 within " + to_text(tolerance);
}

std::string check_material(const Config &config, const SpeciesSpec &spec) {
  const std::string own = "-" + spec.name + "_";
  if (spec.viscosity && config.fluid.viscosity == 0)
    return own + "viscosity: needs a viscous fluid; accepted: -fluid_viscosity > 0, or without this option";
  if (const std::string wrong = check_vector(config, spec.name + "_body_force", spec.body_force.force); !wrong.empty())
    return wrong;
  if (spec.initial_stretch != Real3{1, 1, 1} && !spec.material().carries_tensor())
    return own + "initial_stretch: a body without a modulus has no stretch; accepted: 1,1,1, or " + own +
           "shear_modulus > 0";
  if (spec.surface_tension > 0 && config.method.interface != InterfaceScheme::plic)
    return own + "surface_tension: needs a sharp interface; accepted: -method fast and -interface_scheme plic, or 0";
  if (flat(config) && spec.initial_stretch[2] != 1)
    return own + "initial_stretch: " + to_text(spec.initial_stretch[2]) +
           " along z in 2-D (one cell in z); accepted: 1 along z";
  return check_initial_volume(spec);
}

std::string check_contact(const Config &config, const SpeciesSpec &spec) {
  if (spec.contact != Contact::separate || spec.placement == Placement::one) return {};
  const std::string needed = config.why_no_boxes(spec);
  return needed.empty() ? needed : "-" + spec.name + "_contact: separate needs " + needed + "; accepted here: merge";
}

bool is_random(const SpeciesSpec &spec) { return spec.placement == Placement::random; }

// Walls and posts, which others are compared with wherever they are, and whose loads every rank knows.
bool is_known_everywhere(const SpeciesSpec &spec) {
  return spec.bears_load() || spec.material().anchored || spec.shape == Shape::cylinder;
}

// Bodies at random keep clear of all that come before them, which every rank knows until they are placed; then it keeps
// its share.
std::string place_all(const SolidBodies &solids, Config *config) {
  const std::vector<SpeciesSpec> &species = config->species;
  int rank, ranks;
  (void)MPI_Comm_rank(run_communicator(), &rank);
  (void)MPI_Comm_size(run_communicator(), &ranks);
  config->places.clear();
  for (std::size_t s = 0; s < species.size(); ++s) {
    const bool all = is_known_everywhere(species[s]) || std::any_of(species.begin() + s, species.end(), is_random);
    std::vector<BodyPlace> seeded;
    Places places;
    const std::string wrong =
        is_random(species[s])
            ? seed_bodies(species, s, config->grid, solids, config->places, &seeded)
            : place_bodies(species[s], config->grid, &places, all ? KeptBodies{} : KeptBodies{rank, ranks});
    if (!wrong.empty()) return wrong;
    config->places.push_back(is_random(species[s]) ? Places(seeded) : std::move(places));
  }
  for (std::size_t s = 0; s < species.size(); ++s)
    if (!is_known_everywhere(species[s])) config->places[s].share_among(rank, ranks);
  return {};
}

std::string check_point(const Config &config, const std::string &option, const Real3 &point) {
  for (int d = 0; d < config.grid.dimension(); ++d)
    if (!(point[d] >= 0 && point[d] <= config.grid.length[d]))
      return "-" + option + ": " + "xyz"[d] + " = " + to_text(point[d]) + " is outside the box; accepted: 0 ... " +
             to_text(config.grid.length[d]);
  return {};
}

std::string check_samples(const Config &config) {
  for (const Real3 &point : config.samples.probes)
    if (const std::string wrong = check_point(config, "probe_points", point); !wrong.empty()) return wrong;
  for (int d = 0; d < 3; ++d) {
    const std::string name = std::string("profile_") + "xyz"[d];
    const ProfileSpec &profile = config.samples.profile[d];
    if (const std::string wrong = check_point(config, name, profile.line); !wrong.empty()) return wrong;
    if (d == 2 && flat(config) && profile.kind != ProfileSpec::Kind::none)
      return "-profile_z: there is one cell in z; accepted in 2-D: none";
  }
  return {};
}

std::string check_method(const Config &config) {
  if (config.method.pressure == PressureKind::smac && !SmacSolver::available())
    return "-pressure_solver: smac needs FFTW, which this build lacks; accepted: acm, ksp";
  return {};
}

std::string check_time(const Config &config) {
  const double resolution = std::numeric_limits<double>::epsilon() / 2 * config.time.end;
  if (config.time.step == 0 || config.time.step > resolution) return {};
  return "-time_step: " + to_text(config.time.step) + " cannot be added to times near -time_end " +
         to_text(config.time.end) + "; accepted: auto, or a number > " + to_text(resolution);
}

std::string check_snapshots(const Config &config) {
  const OutputControl &output = config.output;
  if (!output.snapshot_exact) return {};
  if (!config.method.staggered()) return "-snapshot_times: exact needs -method fast; accepted here: steps";
  constexpr double most = 1e5, most_in_step = 100;
  const double least = std::max(config.time.end / most, config.time.step / most_in_step);
  if (output.snapshot_interval == 0 || output.snapshot_interval >= least) return {};
  return "-snapshot_interval: " + to_text(output.snapshot_interval) + " with -snapshot_times exact makes more than " +
         to_text(most) + " snapshots until -time_end, or " + to_text(most_in_step) +
         " in a -time_step; accepted: at least " + to_text(least) + ", or -snapshot_times steps";
}

std::string check_restart(const Config &config) {
  const std::string &path = config.checkpoint.restart;
  const auto is_there = [&] {
    std::error_code ignored;
    return std::filesystem::exists(path, ignored);
  };
  if (!path.empty() && !on_rank_0(is_there))
    return "-restart: there is no file or directory " + path + "; accepted: a checkpoint, or a directory with some";
  return {};
}

}  // namespace

std::string check_single_sides(const Config &config) {
  for (int d = 0; d < 3; ++d) {
    const std::string name = std::string("-boundary_") + "xyz"[d];
    for (int high = 0; high < 2; ++high)
      if (!config.boundary.bounded(d) && config.boundary.side[d][high] != SideChoice::same)
        return name + (high ? "max" : "min") + ": a single boundary cannot be periodic; accepted: same, or with " +
               name + (high ? "min" : "max") + " or " + name;
  }
  return {};
}

std::string validate(Config *whole) {
  const Config &config = *whole;
  for (const auto check : {check_grid, check_spacings, check_walls, check_flow, check_method, check_time, check_samples,
                           check_snapshots, check_restart})
    if (const std::string wrong = check(config); !wrong.empty()) return wrong;
  for (const SpeciesSpec &spec : config.species)
    for (const auto check : {check_shape, check_material, check_membrane, check_rigid, check_placement, check_contact})
      if (const std::string wrong = check(config, spec); !wrong.empty()) return wrong;
  SolidBodies solids;
  for_crossed_sides(config, [&](int d, int high) {
    solids.free[d][high] = (free_layers + 1) * config.grid.length[d] / config.grid.cells[d];
  });
  const bool random = std::any_of(config.species.begin(), config.species.end(), is_random);
  if (const std::string wrong = measure_voxels(config.species, config.grid, random, &solids, &whole->solid_volumes);
      !wrong.empty())
    return wrong;
  if (const std::string wrong = place_all(solids, whole); !wrong.empty()) return wrong;
  if (const std::string wrong = check_small_bodies(config); !wrong.empty()) return wrong;
  if (const std::string wrong = measure_open_parts(whole); !wrong.empty()) return wrong;
  if (const std::string wrong = check_adhesion(whole); !wrong.empty()) return wrong;
  return check_paths(config);
}

}  // namespace eulastic
