// Verdicts of a run on its own results: energy, volume and area, strain, each "fine", "look" or "do not trust", with a
// reason.
//
// Thresholds: docs/outputs.md, "The verdict".
#pragma once

#include "diagnostics/energy_budget.hpp"
#include "output/guards.hpp"

namespace eulastic {

struct Verdict {
  std::string of, verdict, why;
};

/// Input of the verdicts.
struct Evidence {
  const EnergyBudget &budget;
  const std::string &energy_unknown;  ///< why the budget cannot be judged, or empty
  const Measured &measured;           ///< at the end
  double forgotten;                   ///< strain_forgotten of summary.json
  double evolved;  ///< points at which B was evolved, and markers of membranes, as many as at the end in all steps
};

Verdict judge_energy(const Evidence &evidence);
Verdict judge_volume_and_area(const Config &config, const Evidence &evidence);
Verdict judge_strain(const Evidence &evidence);
/// One line.
std::string verdict_line(const Verdict &verdict);

}  // namespace eulastic
