// Measures at a time between two at which they are known.
#pragma once

#include "diagnostics/energy_budget.hpp"
#include "output/guards.hpp"

namespace eulastic {

/// `measured` of a time goes `share` of the way to `other`, of a later one, of the same bodies and velocity: linearly,
/// roots of strain energies too. Volume drifts and loads
/// are left.
void go_between(const Measured &other, double share, Measured *measured);
void go_between(const EnergyState &other, double share, EnergyState *energy);

}  // namespace eulastic
