#include "output/snapshot_output.hpp"

#include "diagnostics/surface_shear_stress.hpp"
#include "diagnostics/wall_shear_stress.hpp"
#include "io/snapshot_fields.hpp"
#include "solver/synchronised_state.hpp"

#include <algorithm>

namespace eulastic {
namespace {

SnapshotField as_field(const WallStress &wall, Stored precision) {
  SnapshotField field;
  field.format.name = "wall_shear_stress_" + side_name(wall.direction, wall.high);
  field.format.stored = precision;
  field.format.plane = wall.direction;
  field.format.plane_high = wall.high;
  field.components = {wall.view(0), wall.view(1), wall.view(2)};
  return field;
}

// phi of the vessels and obstacles that are rigid, or of those that are not, with ghosts; empty if there are none.
// Collective.
PetscErrorCode solid_of_vessels(const Config &config, bool rigid, const std::vector<Phase> &phases, Solver *solver,
                                Field *solid) {
  PetscFunctionBeginUser;
  const Domain &domain = solver->domain();
  for (const Phase &phase : phases) {
    const SpeciesSpec *spec = config.species_of(phase);
    if (!spec || !spec->bears_load() || (spec->law == Law::rigid) != rigid) continue;
    if (!*solid) *solid = Field(domain, 1);
    for_points(domain.rows(), [&](int i, int j, int k) {
      double &sum = (*solid)[0](i, j, k);
      sum = std::min(1.0, sum + phase.fraction[0](i, j, k));
    });
  }
  if (!*solid) PetscFunctionReturn(0);
  PetscCall(solver->exchange().update_ghosts(*solid, 3));
  fill_wall_ghosts_even(domain, at_centre, (*solid)[0], 3);
  PetscFunctionReturn(0);
}

PetscErrorCode write_fields(const Config &config, Solver *solver, const std::vector<Phase> &phases,
                            SnapshotWriter *writer) {
  PetscFunctionBeginUser;
  const State &state = solver->state();
  const Domain &domain = solver->domain();
  const Field *viscosity = nullptr;
  PetscCall(solver->viscosity_now(&viscosity));
  const std::vector<std::string> &wanted = config.output.snapshot_fields;
  const bool stresses = std::find(wanted.begin(), wanted.end(), "wall_shear_stress") != wanted.end();
  const Stored precision = config.output.snapshot_single ? Stored::float32 : Stored::float64;
  SnapshotFields of_state(domain);
  std::vector<SnapshotField> fields = of_state.collect(wanted, precision, state.velocity, state.pressure, phases);
  std::vector<WallStress> walls;
  Field rigid, elastic, stress, widened;
  if (stresses || config.output.snapshot_vti) {
    EdgeViscosity of_place{domain, config.fluid.viscosity, config.fluid.density, viscosity};
    walls = wall_shear_stress(domain, config.sides, state.time, of_place, state.velocity, phases);
    PetscCall(solid_of_vessels(config, true, phases, solver, &rigid));
    PetscCall(solid_of_vessels(config, false, phases, solver, &elastic));
    if (rigid || elastic) stress = Field(domain, 3);
    if (rigid) add_rigid_surface_stress(domain, config.fluid.viscosity, rigid[0], state.velocity, stress);
    if (elastic && viscosity) {
      widened.copy_from(*viscosity);
      PetscCall(solver->exchange().update_ghosts(widened, 2));
      of_place.local = &widened;
    }
    if (elastic) add_elastic_surface_stress({of_place, state.velocity, phases}, elastic[0], stress);
  }
  for (const WallStress &wall : walls) fields.push_back(as_field(wall, precision));
  if (stress) {
    const Field &view = stress;
    SnapshotField &field = fields.emplace_back();
    field.format = {"wall_shear_stress", at_centre, precision};
    field.components = {view[0], view[1], view[2]};
  }
  PetscCall(writer->write(state.time, static_cast<long>(state.step), fields));
  PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode write_snapshot(const Config &config, Solver *solver, SnapshotWriter *writer) {
  PetscFunctionBeginUser;
  PetscCall(solver->synchronised().with_bodies_on_grid(
      [&](const std::vector<Phase> &phases) { return write_fields(config, solver, phases, writer); }));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
