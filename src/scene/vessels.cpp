#include "scene/vessels.hpp"

#include "bodies/shapes.hpp"
#include "grid/domain.hpp"
#include "solver/looks.hpp"

#include <algorithm>

namespace eulastic {

std::vector<VesselFlow> vessel_flows(const Config &config, double time, const Real3 &bulk,
                                     const std::vector<SideFlow> &sides) {
  std::vector<VesselFlow> flows;
  const DomainShape &grid = config.grid;
  const int dimension = grid.cells[2] == 1 ? 2 : 3;
  for (const SpeciesSpec &spec : config.species) {
    if (!is_tube(spec.shape) || spec.axis >= dimension) continue;
    double section = 1;
    for (int d = 0; d < dimension; ++d)
      if (d != spec.axis) section *= grid.length[d];
    double drop = config.fluid.density * config.fluid.body_force.at(time)[spec.axis] * grid.length[spec.axis];
    for (const SideFlow &side : sides)
      if (side.direction == spec.axis) drop += side.high ? -side.pressure : side.pressure;
    VesselFlow &flow = flows.emplace_back();
    flow.species = spec.name;
    flow.flow_rate = bulk[spec.axis] * section;
    if (flow.flow_rate != 0) flow.apparent_viscosity = drop / (flow.flow_rate * lumen_resistance(spec, grid));
  }
  return flows;
}

namespace {

// Of the bodies in `loads`.
PetscErrorCode measure_loads(const Config &config, const std::vector<Phase> &phases, Solver *solver,
                             std::vector<SurfaceLoad> *loads) {
  PetscFunctionBeginUser;
  const Domain &domain = solver->domain();
  const Field *viscosity = nullptr;
  PetscCall(solver->viscosity_now(&viscosity));
  std::vector<Field> labels(phases.size());
  std::vector<const Field *> wanted(phases.size(), nullptr);
  for (std::size_t p = 0; p < phases.size(); ++p) {
    const Phase &phase = phases[p];
    const SpeciesSpec *spec = config.species_of(phase);
    if (!spec || !spec->bears_load() || spec->law == Law::rigid) continue;
    labels[p] = Field(domain, 1);  // not one at rest: all of it is written
    const Int3 &n = domain.cells();
    for (int k = 0; k < n[2]; ++k)
      for (int j = 0; j < n[1]; ++j) std::copy_n(phase.label[0].row(j, k), n[0], labels[p][0].row(j, k));
    PetscCall(solver->exchange().update_ghosts(labels[p], 1));
    fill_wall_ghosts_even(domain, at_centre, labels[p][0], 1);
    wanted[p] = &labels[p];
  }
  const State &state = solver->state();
  PetscCall(measure_surface_loads(domain.comm(), {domain, config.fluid.viscosity, config.fluid.density, viscosity},
                                  state.velocity, state.pressure, phases, wanted, loads));
  PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode measure_vessel_loads(const Config &config, Solver *solver, std::vector<SurfaceLoad> *loads) {
  PetscFunctionBeginUser;
  const Domain &domain = solver->domain();
  loads->clear();
  const BodyTracker &bodies = solver->bodies();
  for (std::size_t s = 0; s < config.species.size(); ++s) {
    const SpeciesSpec &spec = config.species[s];
    if (!spec.bears_load() || spec.law == Law::rigid) continue;
    std::size_t n = 0;
    bodies.for_labels(static_cast<int>(s), bodies.bodies() + 1, [&](int label) {
      SurfaceLoad &load = loads->emplace_back();
      load.label = label;
      const std::vector<NumberedPlace> &places = config.places[s].known;
      for (int d = 0; d < domain.dimension(); ++d)
        load.centre[d] = n < places.size() ? places[n].centre[d] : 0.5 * domain.domain_shape().length[d];
      ++n;
    });
  }
  std::sort(loads->begin(), loads->end(), [](const auto &one, const auto &two) { return one.label < two.label; });
  if (loads->empty()) PetscFunctionReturn(0);
  PetscCall(solver->looks().on_grid(
      [&](const std::vector<Phase> &phases) { return measure_loads(config, phases, solver, loads); }));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
