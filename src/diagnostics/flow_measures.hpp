// Measures of a flow: energies, means, divergence, dissipation and volumes, from two passes and three Allreduces.
//
// Every value is an exact sum or a maximum, so that the bits do not depend on the number of ranks. In 2-D integrals are
// per unit depth. Velocity gradients on a wall have half a control volume.
#pragma once

#include "base/petsc.hpp"
#include "field/boundaries.hpp"
#include "field/phase.hpp"
#include "grid/domain.hpp"

namespace eulastic {

/// Parameters of the measures.
struct FlowParameters {
  double density = 1, viscosity = 1;       ///< rho and mu (dynamic)
  double dt = 0;                           ///< time step
  double force = 0;                        ///< |f|, per mass
  const Field *local_viscosity = nullptr;  ///< kinematic viscosity (flow/local_viscosity.hpp) if bodies have their own
  const BoundaryConditions *sides = nullptr;  ///< null: volume crosses no boundary
};

struct FlowMeasures {
  double kinetic_energy = 0;  ///< integral of rho |v|^2 / 2
  Real3 bulk_velocity{};      ///< means of u, v, w over the box
  double speed_max = 0;       ///< max |v| at cell centres
  double divergence_rms = 0;  ///< rms of div v h / U, with h the smallest spacing, U = max(speed_max, |f| dt), 0/0 = 0
  double divergence_max = 0;
  double viscous_dissipation = 0;    ///< integral of mu grad v : grad v, or tau : grad v; energy / time
  double elastic_energy = 0;         ///< strain energy: sum over phases of the integral of phi W
  std::vector<double> phase_volume;  ///< integral of phi, per phase
};

/// Measures the flow. `velocity`: u, v (, w) with one valid ghost layer. Non-finite values make the sums that contain
/// them NaN. Collective.
PetscErrorCode measure_flow(const Domain &domain, const Field &velocity, const FlowParameters &numbers,
                            FlowMeasures *measures);
/// Measures elastic_energy and phase_volume. `bodies`: bodies of this rank in boxes, which count with the phases of
/// their species. Collective.
PetscErrorCode measure_phases(const Domain &domain, const std::vector<Phase> &phases, FlowMeasures *measures,
                              const std::vector<BodyInBox> &bodies = {});

}  // namespace eulastic
