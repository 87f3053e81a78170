// Outputs: what is said of bodies.
#include "app/outputs.hpp"
#include "physics/limits.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {

// Of all bodies, those of other ranks too.
PetscErrorCode Outputs::measure_drift(Measured *measured) {
  Measured &m = *measured;
  struct {
    double drift = 0;
    int label = 0;
  } resolved_one;  // MPI_DOUBLE_INT; of equal ones the first
  PetscFunctionBeginUser;
  m.volume_drift = 0;
  const std::vector<double> &first_volumes = solver_->bodies().first_volumes();
  for (std::size_t b = 0; b < m.bodies.size(); ++b) {
    const BodyMeasure &body = m.bodies[b];
    const double first = first_volumes[b];
    const double drift = first > 0 && !body.leaves ? std::fabs(body.volume / first - 1) : 0;
    m.volume_drift = std::max(m.volume_drift, drift);
    if (resolved(first) && (drift > resolved_one.drift || resolved_one.label == 0)) resolved_one = {drift, body.label};
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &m.volume_drift, 1, MPI_DOUBLE, MPI_MAX, grid_->comm()));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &resolved_one, 1, MPI_DOUBLE_INT, MPI_MAXLOC, grid_->comm()));
  m.resolved_drift = resolved_one.drift;
  m.drifting_body = resolved_one.label;
  Real3 place{};
  for (const BodyMeasure &body : m.bodies)
    if (body.label == m.drifting_body) place = body.centroid;
  PetscCallMPI(MPI_Allreduce(place.data(), m.drifting_place.data(), 3, MPI_DOUBLE, MPI_SUM, grid_->comm()));
  PetscFunctionReturn(0);
}

PetscErrorCode Outputs::unresolved_bodies(std::string *line) const {
  long small = 0;
  PetscFunctionBeginUser;
  for (const double volume : solver_->bodies().first_volumes()) small += !resolved(volume);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &small, 1, MPI_LONG, MPI_SUM, grid_->comm()));
  *line = small == 0 ? ""
                     : "bodies of less than " + std::to_string(few_cells()) + " cells: " + std::to_string(small) +
                           " of " + std::to_string(solver_->bodies().bodies()) +
                           "; hardly resolved, and -guard_volume_drift does not look at them; more -grid_cells";
  PetscFunctionReturn(0);
}

std::vector<BodyRecord> Outputs::records(const Measured &measured, const std::vector<BodyMeasure> &bodies,
                                         const std::vector<SurfaceMeasure> &surfaces) const {
  std::vector<BodyRecord> records;
  // Loads are those of all bodies that bear some, in their order.
  std::size_t rigid = 0, elastic = 0;
  const auto pass = [&](const SpeciesSpec &spec) { ++(spec.law == Law::rigid ? rigid : elastic); };
  for (int s = 0; s < static_cast<int>(config_.species.size()) && !bodies.empty(); ++s)
    if (config_.species[s].bears_load())
      solver_->bodies().for_labels(s, bodies.front().label, [&](int) { pass(config_.species[s]); });
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const BodyMeasure &body = bodies[b];
    if (b > 0 && config_.species[bodies[b - 1].species].bears_load()) pass(config_.species[bodies[b - 1].species]);
    BodyRecord record;
    record.id = body.label;
    record.species = config_.species[body.species].name;
    record.centroid = body.centroid;
    record.velocity = body.velocity;
    record.volume = body.volume;
    record.taylor_deformation = body.taylor_deformation;
    record.inclination = body.inclination;
    record.elastic_energy = body.elastic_energy;
    record.largest_stretch = std::sqrt(stretch_squared(body.trace_max, grid_->dimension()));
    record.rest_deformation = body.rest_deformation;
    if (config_.species[body.species].law == Law::rigid && rigid < measured.loads.size()) {
      record.force = measured.loads[rigid].force;
      record.torque = measured.loads[rigid].torque;
    } else if (elastic < measured.surface_loads.size() && measured.surface_loads[elastic].label == body.label) {
      record.force = measured.surface_loads[elastic].force;
      record.torque = measured.surface_loads[elastic].torque;
    }
    if (b < surfaces.size()) {
      const SurfaceMeasure &surface = surfaces[b];
      record.surface_area = surface.area;
      record.shear_energy = surface.shear_energy;
      record.area_energy = surface.area_energy;
      record.bending_energy = surface.bending_energy;
      record.turning_rate = surface.turning_rate;
    }
    records.push_back(record);
  }
  return records;
}

// The first of all bodies, on rank 0.
PetscErrorCode Outputs::list_bodies(Summary *summary) const {
  std::vector<BodyMeasure> bodies;
  std::vector<SurfaceMeasure> surfaces;
  PetscFunctionBeginUser;
  const MPI_Comm comm = grid_->comm();
  const int all = solver_->bodies().bodies();
  PetscCall(gather_bodies(comm, all, Summary::most_bodies, measured_.bodies, &bodies));
  if (membranes_) PetscCall(gather_bodies(comm, all, Summary::most_bodies, measured_.surfaces, &surfaces));
  summary->bodies = records(measured_, bodies, surfaces);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
