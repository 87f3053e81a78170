// Interpolates measures between two times.
#pragma once

#include "diagnostics/energy_budget.hpp"
#include "output/guards.hpp"

namespace eulastic {

/// Moves `measured` by the fraction `share` towards `other`, of a later time with the same bodies and velocity:
/// linearly, for strain energies their square roots. Volume drifts and loads are not changed.
void interpolate_between(const Measured &other, double share, Measured *measured);
void interpolate_between(const EnergyState &other, double share, EnergyState *energy);

}  // namespace eulastic
