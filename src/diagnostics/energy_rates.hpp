// Powers of body force, walls and elastic stress, and the strain energy.
//
// All are sums of the discrete equations: the power of the elastic stress is minus that of the elastic force, and the
// power of the walls is that of viscous and elastic traction on them (docs/method.md, section 14). Sums are exact, so
// that the bits do not depend on the ranks.
#pragma once

#include "base/petsc.hpp"
#include "field/boundaries.hpp"
#include "field/phase.hpp"
#include "flow/local_viscosity.hpp"
#include "grid/domain.hpp"

namespace eulastic {

/// Parameters of the rates.
struct EnergyParameters {
  double density = 1, viscosity = 1;          ///< rho and mu (dynamic)
  Real3 force{};                              ///< body force per mass at `time`
  const BoundaryConditions *sides = nullptr;  ///< null: no wall moves
  double time = 0;
  const Field *local_viscosity = nullptr;  ///< kinematic viscosity (flow/local_viscosity.hpp) if bodies have their own
};

/// Energy per time; 2-D: per unit depth.
struct EnergyRates {
  double force_power = 0;
  double wall_power = 0;       ///< of moving walls, on fluid and anchored bodies
  double elastic_power = 0;    ///< integral of sigma_e : grad v, from flow to solids
  double extended_power = 0;   ///< the part of elastic_power in cells where B is extrapolated
  double extended_energy = 0;  ///< the strain energy in these cells
  double side_power = 0;       ///< supplied through boundaries; set by measure_side_flows()
};

/// Writes phi W (energy per volume) of the cells of a row to out[0 .. cells).
void strain_energy(const Box &box, const Phase &phase, const Segment &row, double *out);

/// Measures the rates except for side_power. Reads `velocity` (of `time`), phi and B with one ghost layer. `bodies`:
/// bodies of this rank in boxes, with the velocity. One Allreduce.
PetscErrorCode measure_energy_rates(const Domain &domain, const Field &velocity, const std::vector<Phase> &phases,
                                    const EnergyParameters &numbers, EnergyRates *rates,
                                    const std::vector<BodyInBox> &bodies = {});

}  // namespace eulastic
