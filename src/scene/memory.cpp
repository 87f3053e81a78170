#include "scene/memory.hpp"

#include "base/one_line.hpp"
#include "bodies/shapes.hpp"
#include "boxes/free_bodies.hpp"
#include "field/open_boundaries.hpp"
#include "grid/domain.hpp"
#include "io/fail_together.hpp"
#include "solver/scheme.hpp"
#include "solver/solver.hpp"

#include <unistd.h>
#include <algorithm>
#include <limits>

namespace eulastic {
namespace {

int tensor_fields(const Config &config) { return static_cast<int>(tensor_components(config.grid.dimension()).size()); }

/// Doubles of all bodies in boxes: phi and B with the ghosts around them, force, and for outputs a copy and a velocity,
/// of bodies without a surface that exerts forces in the cells alone that FreeBodies::look() keeps.
double boxed_values(const Config &config) {
  const int dimension = config.grid.dimension();
  double sum = 0;
  for (std::size_t s = 0; s < config.species.size(); ++s) {
    if (!config.lies_in_boxes(s)) continue;
    const Material material = config.species[s].material();
    const int tensor = material.carries_tensor() ? tensor_fields(config) : 0;
    const Surface surface(config.species[s], dimension);
    double reach = 0, cells = 1, around = 1, kept = 1;
    for (int d = 0; d < dimension; ++d) {
      Real3 along{};
      along[d] = 1;
      reach = std::max(reach, surface.support(along));
    }
    for (int d = 0; d < dimension; ++d) {
      const double bare = 2 * reach * config.grid.cells[d] / config.grid.length[d];
      const double own = bare + 2 * FreeBodies::margin(material);
      cells *= own;
      around *= own + 2 * config.grid.ghosts;
      kept *= material.has_surface() ? own + 2 * config.grid.ghosts : bare + FreeBodies::seen_around;
    }
    sum += config.places[s].count * (around * (1 + tensor) + kept * (1 + tensor + dimension) + cells * dimension);
  }
  return sum;
}

/// Doubles per cell of a species: fraction, label and deformation, with the staggered method a second copy at the time
/// of the output. Of bodies in boxes what is shown on the grid at the output, fraction, label and B, and of those with
/// a viscosity or a force of their own the fraction of the step and at its end.
double species_fields(const Config &config, std::size_t which) {
  const Material material = config.species[which].material();
  const bool felt = material.viscosity > 0 || material.body_force.acts();
  if (config.lies_in_boxes(which)) return 2 + 2 * felt + tensor_fields(config);
  const int fields = 1 + config.body_series + material.carries_tensor() * tensor_fields(config);
  return fields * (config.method.staggered() ? 2 : 1);
}

/// Doubles per cell of the pressure solver, without the work space. `rigid`: bodies give increments of their own, in
/// the place of those of the iterations, which then need scratch.
double pressure_fields(const Method &method, int dimension, bool rigid) {
  if (method.pressure == PressureKind::smac) return 2 + rigid * method.acm_memory;  // two copies to transform
  // Matrices, levels and vectors, as measured with CG and PCMG.
  if (method.pressure == PressureKind::ksp) return 55 + rigid * method.acm_memory;
  if (method.is_single_acm_step()) return 0;
  if (!method.acm_coarse) return method.acm_memory;
  return method.acm_memory + (dimension == 2 ? 1 : 0.4) + (method.acm_memory == 0 || rigid);  // coarse grids, scratch
}

/// Doubles per cell, as Solver allocates them: velocity, predictor, pressure; work space; what the parts of the method
/// add; the species.
double fields(const Config &config) {
  const Method &method = config.method;
  const int dimension = config.grid.dimension();
  Solver::Contents scene{has_open_boundary(config.sides), !config.species.empty()};
  bool travels = false, carries_tensor = false;
  ViscosityContrast contrast(config.fluid);
  double species = 0;
  for (std::size_t s = 0; s < config.species.size(); ++s) {
    const SpeciesSpec &spec = config.species[s];
    const bool on_grid = !config.lies_in_boxes(s);
    scene.surface_tension |= on_grid && spec.surface_tension > 0;
    scene.membranes |= on_grid && spec.is_membrane();
    scene.rigid |= spec.law == Law::rigid;
    travels |= spec.travels(dimension);
    carries_tensor |= spec.material().carries_tensor();
    contrast.add(spec.material(), 0);
    species += species_fields(config, s);
  }
  double sum = 2 * dimension + 1 + Solver::work_fields(method, dimension, scene) + species +
               pressure_fields(method, dimension, scene.rigid);
  if (travels) sum += dimension;  // which faces are inside; twice that beside bodies of a file
  for (const auto &pair : config.sides)
    for (const BoundaryCondition &side : pair)
      sum += side.kind == BoundaryKind::pressure && side.load.exists();  // its response
  if (method.staggered() && config.fluid.inertia) sum += dimension;      // of the step before
  if (config.species.empty()) return sum;
  const int tensor = carries_tensor ? tensor_fields(config) : 0;
  if (method.linear_force()) sum += dimension - tensor;  // one B at the output lies in idle velocities
  if (!method.staggered()) sum += tensor;
  if (scene.membranes) sum += dimension;  // their force
  if (method.interface == InterfaceScheme::weno5) sum += 1;
  if (contrast.exists()) sum += viscosity_fields(dimension) + tensor_fields(config);
  if (method.implicit_viscosity(contrast.exists(), scene.rigid))  // ImplicitViscosity
    sum += 5 * dimension + 3 + (dimension == 2 ? 1 : 0.4);
  if (Scheme::extrapolates_pressure(method, contrast, travels)) sum += 1;  // pressure before
  return sum;
}

double ghosted_cells(const Config &config, const Int3 &parts) {
  const Int3 box = Domain::largest_box(config.grid, parts);
  double cells = 1;
  for (int d = 0; d < 3; ++d) cells *= box[d] + (d < config.grid.dimension() ? 2 * config.grid.ghosts : 0);
  return cells;
}

std::string too_little(int ranks, double needed, double limit, double share) {
  return print(
      "-grid_cells: the fields need about %.4g GB on a node (%d ranks), which has %.4g GB; accepted: fewer "
      "cells, more nodes, or another -guard_memory (%g now; off disables the check)",
      1e-9 * needed, ranks, 1e-9 * limit, share);
}

}  // namespace

double bytes_per_rank(const Config &config, const Int3 &parts) {
  const double ranks = double(parts[0]) * parts[1] * parts[2];
  return sizeof(double) * (fields(config) * ghosted_cells(config, parts) + boxed_values(config) / ranks);
}

double bytes_in_boxes(const Config &config) { return sizeof(double) * boxed_values(config); }

double memory_limit() { return double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGESIZE)); }

PetscErrorCode check_sizes(MPI_Comm comm, const Config &config, std::string *refusal) {
  MPI_Comm node;
  int ranks, node_ranks;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  PetscCallMPI(MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &node));
  PetscCallMPI(MPI_Comm_size(node, &node_ranks));
  PetscCallMPI(MPI_Comm_free(&node));
  const Int3 parts = Domain::decompose(config.grid, ranks);
  const double share = config.guard.memory, limit = memory_limit();
  const double needed = bytes_per_rank(config, parts) * node_ranks;
  const double values = ghosted_cells(config, parts) * tensor_fields(config);
  std::string problem;
  if (share > 0 && needed > share * limit) {
    problem = too_little(node_ranks, needed, limit, share);
  } else if (values > std::numeric_limits<PetscInt>::max()) {
    problem = print(
        "-grid_cells: a rank would hold a field of %.0f numbers, more than this PETSc can count; accepted: at most "
        "%.0f, that is, more ranks or a PETSc with 64-bit indices",
        values, double(std::numeric_limits<PetscInt>::max()));
  }
  PetscCall(catch_together([&] { return fail_together(comm, problem); }, refusal));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
