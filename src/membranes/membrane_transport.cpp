#include "membranes/membrane_transport.hpp"

#include "base/events.hpp"
#include "grid/row_scratch.hpp"
#include "grid/threads.hpp"

#include <algorithm>

namespace eulastic {
namespace {

bool is_on_grid(const Phase &phase) { return phase.material.is_membrane() && !phase.boxed; }

bool has_markers(const Phase &phase) {
  return is_on_grid(phase) && phase.material.membrane.scheme == kernels::MembraneScheme::markers;
}

}  // namespace

bool MembraneTransport::exists(const std::vector<Phase> &phases) {
  return std::any_of(phases.begin(), phases.end(), is_on_grid);
}

bool MembraneTransport::has_any_markers() const {
  return std::any_of(flow_.now.phases.begin(), flow_.now.phases.end(), has_markers);
}

PetscErrorCode MembraneTransport::find(const Phase &phase, WorkSpace::Lease *work) {
  PetscFunctionBeginUser;
  PetscCall(flow_.work.lease("membrane", fields, work));
  PetscCall(membrane_.find(phase, work->fields()));
  PetscFunctionReturn(0);
}

PetscErrorCode MembraneTransport::find_walls(const std::vector<const Phase *> &rigid) {
  std::vector<ConstView> fractions;
  PetscFunctionBeginUser;
  for (const Phase *phase : rigid) fractions.push_back(phase->fraction[0]);
  WorkSpace::Lease scratch;
  PetscCall(flow_.work.lease("walls beside membranes", WallFilm::work_fields, &scratch));
  film_.find(flow_.domain, flow_.spec.sides, fractions, scratch.fields());
  PetscFunctionReturn(0);
}

PetscErrorCode MembraneTransport::start() {
  std::vector<const Phase *> rigid;
  PetscFunctionBeginUser;
  for (Phase &phase : flow_.now.phases) {
    if (phase.material.is_rigid() && !phase.travels) rigid.push_back(&phase);
    if (!is_on_grid(phase)) continue;
    WorkSpace::Lease work;
    PetscCall(find(phase, &work));
    PetscCall(membrane_.start(&phase));
  }
  force_known_ = false;
  PetscCall(find_walls(rigid));
  PetscCall(place_markers());
  PetscFunctionReturn(0);
}

PetscErrorCode MembraneTransport::resume() {
  PetscFunctionBeginUser;
  for (Phase &phase : flow_.now.phases) PetscCall(rebuild_derived_fields(&phase));
  PetscFunctionReturn(0);
}

PetscErrorCode MembraneTransport::rebuild_derived_fields(Phase *phase) {
  PetscFunctionBeginUser;
  if (!is_on_grid(*phase)) PetscFunctionReturn(0);
  force_known_ = false;
  WorkSpace::Lease work;
  PetscCall(find(*phase, &work));
  PetscCall(membrane_.extend(phase));
  PetscFunctionReturn(0);
}

PetscErrorCode MembraneTransport::move(double dt, std::vector<Phase> *phases) {
  State &now = flow_.now;
  const bool of_state = phases == &now.phases;
  PetscFunctionBeginUser;
  PetscCall(flow_.update_velocity_ghosts(now.velocity, now.time, MembraneMechanics::velocity_ghosts));
  long unresolved = 0, all = 0;
  NetForce net(flow_.domain, of_state && accelerates_all(*phases));
  if (of_state) clear_force();
  if (of_state && has_any_markers()) PetscCall(markers_.move(dt, now.velocity, &now.markers));
  for (std::size_t p = 0; p < phases->size(); ++p) {
    Phase &phase = (*phases)[p];
    if (!is_on_grid(phase)) continue;
    WorkSpace::Lease work;
    PetscCall(find(phase, &work));
    const bool marked = of_state && has_markers(phase);
    std::vector<SurfaceMarkers::Strain> strains;
    if (marked) markers_.find_strain(membrane_.surface(), static_cast<int>(p), &strains);
    PetscCall(membrane_.move(dt, now.velocity, strains, &phase, &unresolved));
    if (marked)
      markers_.pull_to_surface(membrane_.surface(), membrane_.surface_fields(), static_cast<int>(p), &now.markers);
    if (of_state) PetscCall(add_phase_force(phase, &net));
  }
  if (!of_state) PetscFunctionReturn(0);
  PetscCall(finish_force(&net));
  PetscCallMPI(MPI_Allreduce(&unresolved, &all, 1, MPI_LONG, MPI_SUM, flow_.domain.comm()));
  now.forgotten += all;
  PetscFunctionReturn(0);
}

PetscErrorCode MembraneTransport::place_markers() {
  std::vector<Phase> &phases = flow_.now.phases;
  PetscFunctionBeginUser;
  flow_.now.markers.clear();
  for (std::size_t p = 0; p < phases.size(); ++p)
    if (is_on_grid(phases[p])) PetscCall(place_markers(phases[p], static_cast<int>(p), 0));
  PetscFunctionReturn(0);
}

PetscErrorCode MembraneTransport::set_markers(const std::vector<SurfaceMarker> &markers) {
  PetscFunctionBeginUser;
  flow_.now.markers = markers;
  if (has_any_markers()) PetscCall(markers_.send_to_owners(&flow_.now.markers));
  PetscFunctionReturn(0);
}

PetscErrorCode MembraneTransport::place_markers(const Phase &phase, int number, int label) {
  std::vector<SurfaceMarker> *markers = &flow_.now.markers;
  PetscFunctionBeginUser;
  if (!has_markers(phase)) PetscFunctionReturn(0);
  WorkSpace::Lease work;
  PetscCall(find(phase, &work));
  markers_.place(membrane_.surface(), membrane_.surface_fields(), phase, number, label, markers);
  PetscCall(markers_.send_to_owners(markers));  // the surface beside a rank's last cell may be in the next rank
  PetscFunctionReturn(0);
}

// Assigns each marker to the present phase of its body and removes those of bodies that have left.
PetscErrorCode MembraneTransport::update_after_labels() {
  std::vector<Phase> &phases = flow_.now.phases;
  std::vector<GhostUpdate> labels;
  PetscFunctionBeginUser;
  if (!has_any_markers()) PetscFunctionReturn(0);
  for (Phase &phase : phases)
    if (is_on_grid(phase) && phase.label) labels.push_back({&phase.label, 1, &phase.rows});
  if (labels.empty()) PetscFunctionReturn(0);
  PetscCall(flow_.exchange.update_ghosts(labels));
  markers_.update_phases(phases, &flow_.now.markers);
  PetscFunctionReturn(0);
}

bool MembraneTransport::accelerates_all(const std::vector<Phase> &phases) const {
  return flow_.drifts() && exists(phases);
}

void MembraneTransport::clear_force() {
  const int n = flow_.domain.cells()[0];
  in_row_parts(flow_.domain, [&](const RowPart &part) {
    for (int k = part.k_begin; k < part.k_end; ++k)
      for (int j = part.j_begin; j < part.j_end; ++j)
        for (int a = 0; a < force_.count(); ++a) std::fill_n(force_[a].row(j, k), n, 0.0);
  });
}

PetscErrorCode MembraneTransport::add_phase_force(const Phase &phase, NetForce *net) {
  PetscFunctionBeginUser;
  const int n = flow_.domain.cells()[0];
  PetscCall(membrane_.for_force_rows(phase, [&](int part, int a, int j, int k, const double *added) {
    add_force_row(n, added, 0, force_[a].row(j, k), nullptr);
    net->add_row(flow_.domain, part, a, added);
  }));
  film_.add_force(phase, force_);
  PetscFunctionReturn(0);
}

PetscErrorCode MembraneTransport::finish_force(NetForce *net) {
  PetscFunctionBeginUser;
  PetscCall(net->compute_mean(&net_force_));
  force_known_ = true;
  PetscFunctionReturn(0);
}

PetscErrorCode MembraneTransport::begin_slope(double dt, Field &slope) {
  return add_force(flow_.now.phases, -1 / (dt * flow_.fluid.density), false, slope);
}

PetscErrorCode MembraneTransport::add_rate(const MomentumRate &rate) {
  return add_force(flow_.now.phases, rate.scale / flow_.fluid.density, true, rate.field, rate.slope);
}

PetscErrorCode MembraneTransport::add_force(const std::vector<Phase> &phases, double scale, bool balanced, Field &force,
                                            const WeightedTarget &slope) {
  PetscFunctionBeginUser;
  if (!force_known_) {
    NetForce net(flow_.domain, accelerates_all(phases));
    clear_force();
    for (const Phase &phase : phases) {
      if (!is_on_grid(phase)) continue;
      WorkSpace::Lease work;
      PetscCall(find(phase, &work));
      PetscCall(add_phase_force(phase, &net));
    }
    PetscCall(finish_force(&net));
  }
  const int n = flow_.domain.cells()[0];
  in_row_parts(flow_.domain, [&](const RowPart &part) {
    RowScratch scratch(flow_.domain, 1);
    double *added = scratch.row(0);
    for (int k = part.k_begin; k < part.k_end; ++k)
      for (int j = part.j_begin; j < part.j_end; ++j) {
        const auto has_force = [&](const Phase &phase) { return is_on_grid(phase) && !phase.rows.idle(j, k); };
        if (std::none_of(phases.begin(), phases.end(), has_force)) continue;
        for (int a = 0; a < force_.count(); ++a) {
          const double *f = force_[a].row(j, k);
          for (int i = 0; i < n; ++i) added[i] = scale * f[i];
          add_force_row(n, added, slope.factor, force[a].row(j, k),
                        slope.field ? (*slope.field)[a].row(j, k) : nullptr);
        }
      }
  });
  const Real3 &mean = net_force_;
  if (balanced) subtract_mean(flow_.domain, {scale * mean[0], scale * mean[1], scale * mean[2]}, force);
  PetscFunctionReturn(0);
}

PetscErrorCode MembraneTransport::add_surface_energy(const SynchronisedBodies &bodies, SurfaceEnergy *measured,
                                                     std::vector<SurfaceSample> *samples) {
  PetscFunctionBeginUser;
  const double volume = flow_.domain.cell_volume();
  for (const Phase &phase : bodies.phases) {
    if (!is_on_grid(phase)) continue;
    WorkSpace::Lease work;
    PetscCall(find(phase, &work));
    std::vector<ExactSums> sum(row_parts(flow_.domain), ExactSums(MembraneMechanics::sums));
    PetscCall(membrane_.measure(phase, flow_.now.velocity, film_, &sum, samples));
    double total[MembraneMechanics::sums];
    PetscCall(reduce_parts(flow_.domain.comm(), sum, total));
    measured->power += total[MembraneMechanics::power] * volume;
    measured->energy += total[MembraneMechanics::stored] * volume;
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
