// Outputs: what is said of bodies.
#include "base/one_line.hpp"
#include "flow/limits.hpp"
#include "output/outputs.hpp"
#include "scene/red_cell.hpp"

#include <algorithm>
#include <climits>
#include <cmath>

namespace eulastic {

// Drifts of volume and strains, the largest of all bodies, those of other ranks too.
PetscErrorCode Outputs::measure_largest(Measured *measured) {
  Measured &m = *measured;
  Largest largest[3];  // drift of a resolved body; stretch; area of a red cell. MPI_DOUBLE_INT; of equal ones the first
  const auto see = [](double value, int label, Largest *of) {
    if (of->label == 0 || value > of->value) *of = {value, label};
  };
  PetscFunctionBeginUser;
  if (solver_->bodies().bodies() == 0) PetscFunctionReturn(0);
  m.volume_drift = 0;
  for (std::size_t b = 0; b < m.bodies.size(); ++b) {
    const BodyMeasure &body = m.bodies[b];
    const double first = solver_->bodies().first_volumes()[b];
    const double drift = first > 0 && !body.leaves ? std::fabs(body.volume / first - 1) : 0;
    m.volume_drift = std::max(m.volume_drift, drift);
    if (resolved(first)) see(drift, body.label, &largest[0]);
    see(largest_stretch(m.bodies, m.surfaces, b), body.label, &largest[1]);
    if (config_.species[body.species].law == Law::red_cell && b < m.surfaces.size())
      see(m.surfaces[b].area_strain, body.label, &largest[2]);
  }
  for (Largest &l : largest)
    if (l.label == 0) l = {-HUGE_VAL, INT_MAX};
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &m.volume_drift, 1, MPI_DOUBLE, MPI_MAX, domain_->comm()));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, largest, 3, MPI_DOUBLE_INT, MPI_MAXLOC, domain_->comm()));
  for (Largest &l : largest)
    if (l.label == INT_MAX) l = {};
  m.resolved_drift = largest[0];
  m.stretch = largest[1];
  m.red_cell_area = largest[2];
  Real3 place{};
  for (const BodyMeasure &body : m.bodies)
    if (body.label == m.resolved_drift.label) place = body.centroid;
  PetscCallMPI(MPI_Allreduce(place.data(), m.drifting_place.data(), 3, MPI_DOUBLE, MPI_SUM, domain_->comm()));
  PetscFunctionReturn(0);
}

// Of body b of `bodies`; of membranes that along the surface.
double Outputs::largest_stretch(const std::vector<BodyMeasure> &bodies, const std::vector<SurfaceMeasure> &surfaces,
                                std::size_t b) const {
  if (config_.species[bodies[b].species].is_membrane()) return b < surfaces.size() ? surfaces[b].largest_stretch : 1;
  return std::sqrt(stretch_squared(bodies[b].trace_max, domain_->dimension()));
}

std::string Outputs::strain_warning() {
  constexpr double stretched = 2;
  const Measured &m = written_;
  const auto once = [&](const Largest &of, double limit, bool *said) {
    const bool now = !*said && of.value > limit;
    *said = *said || now;
    return now;
  };
  if (once(m.red_cell_area, red_cell_bursts, &area_warned_)) {
    return print(
        "t = %.9g: the area of red cell %d has grown by %.2g %%, above the %g %% at which its membrane "
        "bursts; use a weaker flow, or a larger -NAME_skalak_c",
        m.time, m.red_cell_area.label, 100 * m.red_cell_area.value, 100 * red_cell_bursts);
  }
  if (once(m.stretch, stretched, &stretch_warned_)) {
    return print(
        "t = %.9g: body %d is stretched by a factor of %.3g, above %g: its strain is hard to resolve; use more "
        "-grid_cells, and read the verdict at the end of the run",
        m.time, m.stretch.label, m.stretch.value, stretched);
  }
  return {};
}

PetscErrorCode Outputs::unresolved_bodies(std::string *line) const {
  long small = 0;
  PetscFunctionBeginUser;
  for (const double volume : solver_->bodies().first_volumes()) small += !resolved(volume);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &small, 1, MPI_LONG, MPI_SUM, domain_->comm()));
  *line = small == 0 ? ""
                     : "bodies of less than " + std::to_string(few_cells()) + " cells: " + std::to_string(small) +
                           " of " + std::to_string(solver_->bodies().bodies()) +
                           "; they are hardly resolved, and -guard_volume_drift ignores them; use more -grid_cells";
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
    BodyRecord &record = records.emplace_back();
    record.body = body;
    record.largest_stretch = largest_stretch(bodies, surfaces, b);
    if (b < surfaces.size()) record.surface = surfaces[b];
    if (b < measured.body_bonds.size() && measured.body_bonds[b].body == body.label)
      record.bonds = measured.body_bonds[b];
    if (config_.species[body.species].law == Law::rigid && rigid < measured.loads.size()) {
      record.force = measured.loads[rigid].force;
      record.torque = measured.loads[rigid].torque;
    } else if (elastic < measured.surface_loads.size() && measured.surface_loads[elastic].label == body.label) {
      record.force = measured.surface_loads[elastic].force;
      record.torque = measured.surface_loads[elastic].torque;
    }
  }
  return records;
}

// The first of all bodies, on rank 0.
PetscErrorCode Outputs::list_bodies(std::vector<Json> *list) const {
  std::vector<BodyMeasure> bodies;
  std::vector<SurfaceMeasure> surfaces;
  PetscFunctionBeginUser;
  const MPI_Comm comm = domain_->comm();
  const int all = solver_->bodies().bodies();
  PetscCall(gather_bodies(comm, all, most_bodies, now_.bodies, &bodies));
  if (membranes_) PetscCall(gather_bodies(comm, all, most_bodies, now_.surfaces, &surfaces));
  for (const BodyRecord &record : records(now_, bodies, surfaces)) {
    Json &json = list->emplace_back();
    json.add("id", static_cast<long>(record.body.label)).add("species", config_.species[record.body.species].name);
    for_numbers(record, true, true, false, [&](const char *name, const auto &value) { json.add(name, value); });
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
