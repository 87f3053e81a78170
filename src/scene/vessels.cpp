#include "scene/vessels.hpp"

#include "bodies/shapes.hpp"
#include "boxes/box_exchange.hpp"
#include "field/boundaries.hpp"
#include "grid/domain.hpp"
#include "solver/synchronised_state.hpp"

#include <algorithm>

namespace eulastic {

std::vector<VesselFlow> vessel_flows(const Config &config, double time, const Real3 &bulk,
                                     const std::vector<SideFlow> &sides) {
  std::vector<VesselFlow> flows;
  const DomainShape &grid = config.grid;
  for (const SpeciesSpec &spec : config.species) {
    if (!is_tube(spec.shape) || spec.axis >= grid.dimension()) continue;
    double drop = config.fluid.density * config.fluid.body_force.at(time)[spec.axis] * grid.length[spec.axis];
    for (const SideFlow &side : sides)
      if (side.direction == spec.axis) drop += side.high ? -side.pressure : side.pressure;
    VesselFlow &flow = flows.emplace_back();
    flow.species = spec.name;
    flow.flow_rate = bulk[spec.axis] * grid.side_area(spec.axis);
    if (flow.flow_rate != 0) flow.apparent_viscosity = drop / (flow.flow_rate * lumen_resistance(spec, grid));
  }
  return flows;
}

namespace {

// Copies `surfaces`, labels and phi of every phase that bears loads, to blocks around the elastic bodies that lie in
// boxes of their own.
PetscErrorCode bring_surfaces(const Domain &domain, const std::vector<Field> &surfaces,
                              const std::vector<BodyInBox> &boxed, std::vector<BodyAtSurfaces> *bodies) {
  std::vector<BoxExchange::NumberedBox> boxes;
  PetscFunctionBeginUser;
  for (const BodyInBox &body : boxed) {
    if (!body.phase->material.elastic()) continue;
    const Box block = body.phase->block(*body.box, 1, 1);
    const Layout &layout = block.layout();
    bodies->push_back(
        {body.phase, Box(block.domain_shape(), layout.begin, layout.cells, 1), block_offset(*body.box, block), {}});
    boxes.push_back({nullptr, body.number});
  }
  for (std::size_t b = 0; b < boxes.size(); ++b) boxes[b].box = &(*bodies)[b].box;
  BoxExchange exchange(domain, 2);
  PetscCall(exchange.connect(boxes, true));
  for (const Field &surface : surfaces) {
    if (!surface) continue;
    PetscCall(exchange.fetch(surface));
    for (std::size_t b = 0; b < bodies->size(); ++b) {
      BodyAtSurfaces &body = (*bodies)[b];
      Field &brought = body.surfaces.emplace_back(body.box, 2);
      exchange.copy_to_box(b, surface, brought);
      for (int c = 0; c < 2; ++c) fill_wall_ghosts_even(body.box, at_centre, brought[c], 1);
    }
  }
  PetscFunctionReturn(0);
}

// Of the bodies in `loads`.
PetscErrorCode measure_loads(const Config &config, Solver *solver, std::vector<SurfaceLoad> *loads) {
  PetscFunctionBeginUser;
  const Domain &domain = solver->domain();
  const Field *viscosity = nullptr;
  const std::vector<Phase> *phases = nullptr;
  PetscCall(solver->synchronised().phases(&phases));
  PetscCall(solver->viscosity_now(&viscosity));
  bool any_boxed = false;
  std::vector<Field> surfaces(phases->size()), labels(phases->size());
  std::vector<const Field *> wanted(phases->size(), nullptr);
  for (std::size_t p = 0; p < phases->size(); ++p) {
    const Phase &phase = (*phases)[p];
    any_boxed = any_boxed || (phase.boxed && phase.material.elastic());
    const SpeciesSpec *spec = config.species_of(phase);
    if (!spec || !spec->bears_load() || spec->law == Law::rigid) continue;
    surfaces[p] = Field(domain, 2);  // not one at rest: all of it is written
    labels[p] = surfaces[p].part(0, 1);
    for (const Segment &row : domain.rows()) {
      std::copy_n(phase.label[0].row(row.j, row.k), row.size(), surfaces[p][0].row(row.j, row.k));
      std::copy_n(phase.fraction[0].row(row.j, row.k), row.size(), surfaces[p][1].row(row.j, row.k));
    }
    PetscCall(solver->exchange().update_ghosts(labels[p], 1));
    fill_wall_ghosts_even(domain, at_centre, labels[p][0], 1);
    wanted[p] = &labels[p];
  }
  std::vector<BodyAtSurfaces> bodies;
  std::vector<BodyInBox> boxed;
  if (any_boxed) {
    PetscCall(solver->synchronised().bodies(&boxed));
    PetscCall(bring_surfaces(domain, surfaces, boxed, &bodies));
  }
  const State &state = solver->state();
  PetscCall(measure_surface_loads(domain.comm(), {domain, config.fluid.viscosity, config.fluid.density, viscosity},
                                  state.velocity, state.pressure, *phases, wanted, bodies, loads));
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
  PetscCall(measure_loads(config, solver, loads));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
