// What drives, drains and stores energy: the powers of body force, walls and elastic stress, and the strain energy.
//
// All as the discrete equations have them: the power of the elastic stress is minus that of the elastic force, and what
// the walls do is what viscosity and solids on them take (docs/method.md). Exact sums: the same bits on any ranks.
#pragma once

#include "base/petsc.hpp"
#include "field/phase.hpp"
#include "field/sides.hpp"
#include "flow/local_viscosity.hpp"
#include "grid/domain.hpp"

namespace eulastic {

/// What the rates depend on beside the fields.
struct EnergyNumbers {
  double density = 1, viscosity = 1;  ///< rho and mu (dynamic)
  Real3 force{};                      ///< body force per mass, now
  const BoxSides *sides = nullptr;    ///< null: no wall moves
  double time = 0;
  const Field *local_viscosity = nullptr;  ///< kinematic (flow/local_viscosity.hpp), where bodies have their own
};

/// Energy per time; 2-D: per unit depth.
struct EnergyRates {
  double force_power = 0;
  double wall_power = 0;       ///< of moving walls, through viscosity and solids attached to them
  double elastic_power = 0;    ///< integral of sigma_e : grad v: flow to solids
  double extended_power = 0;   ///< the part of it in cells where B is extended, and
  double extended_energy = 0;  ///< the strain energy there
  double side_power = 0;       ///< of what comes in through sides; by measure_side_flows()
};

/// phi W (energy per volume) of the cells of a row, into out[0 .. cells).
void strain_energy(const Box &box, const Phase &phase, const Segment &row, double *out);

/// `velocity` (of `time`), phi and B with one ghost layer; `bodies`: those of this rank that lie in boxes, with the
/// velocity. One Allreduce.
PetscErrorCode measure_energy_rates(const Domain &domain, const Field &velocity, const std::vector<Phase> &phases,
                                    const EnergyNumbers &numbers, EnergyRates *rates,
                                    const std::vector<BodyInBox> &bodies = {});

}  // namespace eulastic
