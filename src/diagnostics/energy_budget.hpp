// Where the energy of a run went: what came in, what viscosity took, what is left, and what the numerics lost.
//
// Works are trapezoidal sums over the lines of series.csv, so nothing is measured between them (docs/method.md).
#pragma once

#include "diagnostics/energy_rates.hpp"

namespace eulastic {

/// One state: its energies and the rates at which they change.
struct EnergyState {
  double kinetic = 0, elastic = 0;
  double surface = 0, surface_power = 0;  ///< of surface tension: its energy, what the flow gives to it
  double dissipation = 0;                 ///< by viscosity
  EnergyRates rates;
};

class EnergyBudget {
public:
  /// Adds the works from the last state to this one. The first state begins the budget.
  void advance(double time, const EnergyState &state);

  double supplied() const { return work_[0]; }    ///< by body force, walls and what comes in
  double dissipated() const { return work_[1]; }  ///< by viscosity
  /// supplied - dissipated - change of kinetic and elastic energy: what the numerics took; negative: made.
  double lost() const;
  /// The part of it between elastic stress and elastic energy, surface tension's included: work of the stress - change
  /// of that energy.
  double lost_elastic() const;
  /// The part of that in cells where B is extended instead of evolved.
  double lost_extended() const;

  /// All there is, for a checkpoint.
  std::vector<double> numbers() const;
  void set_numbers(const std::vector<double> &numbers);

private:
  static constexpr int works = 4, energies = 3;
  double time_ = -1;                               ///< of the last state; negative: none yet
  std::array<double, works> rate_{}, work_{};      ///< supplied, dissipated, elastic, elastic where extended
  std::array<double, energies> first_{}, last_{};  ///< kinetic, elastic, elastic where extended
};

}  // namespace eulastic
