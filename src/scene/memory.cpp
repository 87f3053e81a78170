#include "scene/memory.hpp"

#include "base/one_line.hpp"
#include "bodies/shapes.hpp"
#include "boxes/free_bodies.hpp"
#include "field/open_boundaries.hpp"
#include "flow/viscosity.hpp"
#include "grid/domain.hpp"
#include "io/fail_together.hpp"
#include "solver/solver.hpp"

#include <unistd.h>
#include <algorithm>
#include <limits>

namespace eulastic {
namespace {

int tensor_fields(const Config &config) { return static_cast<int>(tensor_components(config.grid.dimension()).size()); }

/// Doubles of all bodies in boxes, which may be turned in any direction.
double boxed_values(const Config &config) {
  const int dimension = config.grid.dimension();
  double sum = 0;
  for (std::size_t s = 0; s < config.species.size(); ++s) {
    if (!config.lies_in_boxes(s)) continue;
    const Surface surface(config.species[s], dimension);
    double reach = 0;
    for (int d = 0; d < dimension; ++d) {
      Real3 along{};
      along[d] = 1;
      reach = std::max(reach, surface.support(along));
    }
    Real3 cells{};
    for (int d = 0; d < dimension; ++d) cells[d] = 2 * reach * config.grid.cells[d] / config.grid.length[d];
    sum +=
        config.places[s].count * FreeBodies::values(config.species[s].material(), dimension, cells, config.grid.ghosts);
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

/// Doubles per cell of all fields.
double fields(const Config &config) {
  const int dimension = config.grid.dimension();
  SolverSpec spec;
  static_cast<Method &>(spec) = config.method;
  spec.fluid = config.fluid;
  Solver::Contents scene;
  scene.open = has_open_boundary(config.sides);
  scene.bodies = !config.species.empty();
  ViscosityContrast contrast(config.fluid);
  double sum = 0;
  for (std::size_t s = 0; s < config.species.size(); ++s) {
    const SpeciesSpec &species = config.species[s];
    const bool on_grid = !config.lies_in_boxes(s);
    scene.surface_tension |= on_grid && species.surface_tension > 0;
    scene.membranes |= on_grid && species.is_membrane();
    scene.rigid |= species.law == Law::rigid;
    scene.travel |= species.travels(dimension);
    scene.elastic |= species.material().carries_tensor();
    contrast.add(species.material(), 0);
    sum += species_fields(config, s);
  }
  // One B at the time of the output lies in fields that are idle between steps.
  if (scene.elastic && config.method.linear_force()) sum -= tensor_fields(config);
  for (const auto &pair : config.sides)
    for (const BoundaryCondition &side : pair)
      scene.loaded_outlets += side.kind == BoundaryKind::pressure && side.load.exists();
  return sum + Solver::fields(spec, dimension, scene, contrast);
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
