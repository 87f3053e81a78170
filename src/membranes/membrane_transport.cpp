#include "membranes/membrane_transport.hpp"

#include "base/events.hpp"
#include "grid/row_scratch.hpp"
#include "grid/threads.hpp"

#include <algorithm>

namespace eulastic {
namespace {

bool is_on_grid(const Phase &phase) { return phase.material.is_membrane() && !phase.boxed; }

}  // namespace

bool MembraneTransport::exists(const std::vector<Phase> &phases) {
  return std::any_of(phases.begin(), phases.end(), is_on_grid);
}

bool MembraneTransport::marks(const std::vector<Phase> &phases) {
  return std::any_of(phases.begin(), phases.end(), [](const Phase &phase) {
    return is_on_grid(phase) && phase.material.membrane.scheme == kernels::MembraneScheme::markers;
  });
}

PetscErrorCode MembraneTransport::find(const Phase &phase, WorkSpace::Lease *work) {
  PetscFunctionBeginUser;
  PetscCall(work_->take("membrane", work_fields, work));
  PetscCall(membrane_.find(phase, work->fields()));
  PetscFunctionReturn(0);
}

PetscErrorCode MembraneTransport::find_walls(const std::vector<const Phase *> &rigid) {
  std::vector<ConstView> fractions;
  PetscFunctionBeginUser;
  for (const Phase *phase : rigid) fractions.push_back(phase->fraction[0]);
  WorkSpace::Lease scratch;
  PetscCall(work_->take("walls beside membranes", WallFilm::work_fields, &scratch));
  film_.find(*domain_, *sides_, fractions, scratch.fields());
  PetscFunctionReturn(0);
}

PetscErrorCode MembraneTransport::start(Phase *phase) {
  PetscFunctionBeginUser;
  force_known_ = false;
  WorkSpace::Lease work;
  PetscCall(find(*phase, &work));
  PetscCall(membrane_.start(phase));
  PetscFunctionReturn(0);
}

PetscErrorCode MembraneTransport::extend(Phase *phase) {
  PetscFunctionBeginUser;
  force_known_ = false;
  WorkSpace::Lease work;
  PetscCall(find(*phase, &work));
  PetscCall(membrane_.extend(phase));
  PetscFunctionReturn(0);
}

PetscErrorCode MembraneTransport::advance(double dt, const Field &velocity, Memory *memory,
                                          std::vector<Phase> *phases) {
  PetscFunctionBeginUser;
  long unresolved = 0;
  NetForce net(*domain_, memory && drives_all(*phases));
  if (memory) begin_force();
  if (memory && marks(*phases)) PetscCall(markers_.move(dt, velocity, memory->markers));
  for (std::size_t p = 0; p < phases->size(); ++p) {
    Phase &phase = (*phases)[p];
    if (!is_on_grid(phase)) continue;
    WorkSpace::Lease work;
    PetscCall(find(phase, &work));
    const bool marked = memory && phase.material.membrane.scheme == kernels::MembraneScheme::markers;
    std::vector<SurfaceMarkers::Strain> strains;
    if (marked) markers_.find_strain(membrane_.surface(), static_cast<int>(p), &strains);
    PetscCall(membrane_.move(dt, velocity, strains, &phase, &unresolved));
    if (marked) markers_.settle(membrane_.surface(), membrane_.surface_fields(), static_cast<int>(p), memory->markers);
    if (memory) PetscCall(gather_force(phase, &net));
  }
  if (!memory) PetscFunctionReturn(0);
  PetscCall(end_force(&net));
  PetscCallMPI(MPI_Allreduce(&unresolved, &memory->unresolved, 1, MPI_LONG, MPI_SUM, domain_->comm()));
  PetscFunctionReturn(0);
}

PetscErrorCode MembraneTransport::place_markers(const Phase &phase, int number, int label,
                                                std::vector<SurfaceMarker> *markers) {
  PetscFunctionBeginUser;
  if (phase.material.membrane.scheme != kernels::MembraneScheme::markers) PetscFunctionReturn(0);
  WorkSpace::Lease work;
  PetscCall(find(phase, &work));
  markers_.place(membrane_.surface(), membrane_.surface_fields(), phase, number, label, markers);
  PetscCall(markers_.send_home(markers));  // the surface beside a rank's last cell may lie in the next one
  PetscFunctionReturn(0);
}

PetscErrorCode MembraneTransport::follow(std::vector<Phase> *phases, std::vector<SurfaceMarker> *markers) {
  std::vector<WantedGhosts> labels;
  PetscFunctionBeginUser;
  if (!marks(*phases)) PetscFunctionReturn(0);
  for (Phase &phase : *phases)
    if (is_on_grid(phase) && phase.label) labels.push_back({&phase.label, 1, &phase.rows});
  if (labels.empty()) PetscFunctionReturn(0);
  PetscCall(exchange_->update_ghosts(labels));
  markers_.follow(*phases, markers);
  PetscFunctionReturn(0);
}

bool MembraneTransport::drives_all(const std::vector<Phase> &phases) const {
  return drifts_ && std::any_of(phases.begin(), phases.end(), [](const Phase &phase) {
           return is_on_grid(phase) && phase.material.membrane.bending_modulus > 0;
         });
}

void MembraneTransport::begin_force() {
  const int n = domain_->cells()[0];
  in_row_parts(*domain_, [&](const RowPart &part) {
    for (int k = part.k_begin; k < part.k_end; ++k)
      for (int j = part.j_begin; j < part.j_end; ++j)
        for (int a = 0; a < force_.count(); ++a) std::fill_n(force_[a].row(j, k), n, 0.0);
  });
}

PetscErrorCode MembraneTransport::gather_force(const Phase &phase, NetForce *net) {
  PetscFunctionBeginUser;
  const int n = domain_->cells()[0];
  PetscCall(membrane_.for_force_rows(phase, [&](int part, bool bending, int a, int j, int k, const double *added) {
    add_force_row(n, added, 0, force_[a].row(j, k), nullptr);
    if (bending) net->add_row(*domain_, part, a, added);
  }));
  film_.add_force(phase, force_);
  PetscFunctionReturn(0);
}

PetscErrorCode MembraneTransport::end_force(NetForce *net) {
  PetscFunctionBeginUser;
  PetscCall(net->find_mean(&net_force_));
  force_known_ = true;
  PetscFunctionReturn(0);
}

PetscErrorCode MembraneTransport::add_force(const std::vector<Phase> &phases, double scale, bool balanced, Field &force,
                                            const WeightedTarget &slope) {
  PetscFunctionBeginUser;
  if (!force_known_) {
    NetForce net(*domain_, drives_all(phases));
    begin_force();
    for (const Phase &phase : phases) {
      if (!is_on_grid(phase)) continue;
      WorkSpace::Lease work;
      PetscCall(find(phase, &work));
      PetscCall(gather_force(phase, &net));
    }
    PetscCall(end_force(&net));
  }
  const int n = domain_->cells()[0];
  in_row_parts(*domain_, [&](const RowPart &part) {
    RowScratch scratch(*domain_, 1);
    double *added = scratch.row(0);
    for (int k = part.k_begin; k < part.k_end; ++k)
      for (int j = part.j_begin; j < part.j_end; ++j) {
        const auto felt = [&](const Phase &phase) { return is_on_grid(phase) && !phase.rows.idle(j, k); };
        if (std::none_of(phases.begin(), phases.end(), felt)) continue;
        for (int a = 0; a < force_.count(); ++a) {
          const double *f = force_[a].row(j, k);
          for (int i = 0; i < n; ++i) added[i] = scale * f[i];
          add_force_row(n, added, slope.factor, force[a].row(j, k),
                        slope.field ? (*slope.field)[a].row(j, k) : nullptr);
        }
      }
  });
  const Real3 &mean = net_force_;
  if (balanced) take_off_mean(*domain_, {scale * mean[0], scale * mean[1], scale * mean[2]}, force);
  PetscFunctionReturn(0);
}

PetscErrorCode MembraneTransport::measure(const std::vector<Phase> &phases, const Field &velocity,
                                          SurfaceEnergy *measured, std::vector<SurfaceSample> *samples) {
  PetscFunctionBeginUser;
  const double volume = domain_->cell_volume();
  for (const Phase &phase : phases) {
    if (!is_on_grid(phase)) continue;
    WorkSpace::Lease work;
    PetscCall(find(phase, &work));
    std::vector<ExactSums> sum(row_parts(*domain_), ExactSums(MembraneMechanics::sums));
    PetscCall(membrane_.measure(phase, velocity, film_, 0, &sum, samples));
    double total[MembraneMechanics::sums];
    PetscCall(reduce_parts(domain_->comm(), sum, total));
    measured->power += total[MembraneMechanics::power] * volume;
    measured->energy += total[MembraneMechanics::stored] * volume;
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
