// Where the energy of a run went: what came in, what viscosity took, what is left, and what the numerics lost or made.
//
// Works are trapezoidal sums over the rows of series.csv, so nothing is measured between them (docs/method.md).
#pragma once

#include "diagnostics/energy_rates.hpp"

namespace eulastic {

/// One state: its energies and the rates at which they change.
struct EnergyState {
  double kinetic = 0, elastic = 0;
  double surface = 0, surface_power = 0;  ///< of surface tension: its energy, what the flow gives to it
  double dissipation = 0;                 ///< by viscosity
  bool starts = false;                    ///< steps are still the small ones of a start
  double unknown = 0;      ///< energies below it say nothing: round-off, what body forces give the fluid in a step
  double force_range = 0;  ///< what the power of body forces may be at most with this kinetic energy
  double wall_range = 0;   ///< the power of rigid bodies at their largest velocity, in orders of magnitude
  EnergyRates rates;
};

class EnergyBudget {
public:
  /// Adds the works from the last state to this one. The first state begins the budget.
  void advance(double time, const EnergyState &state);

  /// Where artificial compressibility may give back what it has taken, nothing is made before all of that has come
  /// back.
  void allow_return(bool allowed) { may_return_ = allowed; }

  double supplied() const { return work_[0]; }    ///< by body force, walls and what comes in
  double dissipated() const { return work_[1]; }  ///< by viscosity
  /// supplied - dissipated - change of kinetic and elastic energy: what the numerics took; negative: made.
  double lost() const;
  /// The part of it between elastic stress and elastic energy, surface tension's included: work of the stress - change
  /// of that energy.
  double lost_elastic() const;
  /// The part of that in cells where B is extended instead of evolved.
  double lost_extended() const;

  /// Energy that passed through the run: what it held at the start, and the sizes of what was supplied or taken out
  /// since.
  double handled() const { return first_[0] + first_[1] + made_.handled; }
  /// How far lost() may be wrong as works are sums over rows: the rates are taken to be monotonic between two of them.
  double uncertain() const { return made_.uncertain; }
  /// What the run has made itself since the row for which that is the largest share of what the run held then and has
  /// handled since, beyond what is uncertain; 0 if nothing was made. The first row after the start is the first to be
  /// compared with: a boundary that starts at once gives energy in no time.
  double made_share() const { return made_share_; }
  /// The largest so far.
  double made_share_max() const { return made_share_max_; }

  /// The works and energies, for a checkpoint. made_share() begins anew with them, and goes on with its own numbers,
  /// which come second.
  std::vector<double> numbers() const;
  void set_numbers(const std::vector<double> &numbers);
  std::vector<double> made_numbers() const;
  void set_made_numbers(const std::vector<double> &numbers);

private:
  /// Sums since the start, at a row.
  struct Made {
    double made = 0;       ///< -lost()
    double uncertain = 0;  ///< of it
    double handled = 0;    ///< without what the run held at the start
    double held = 0;       ///< kinetic energy, elastic and surface energy above least_, and EnergyState::unknown
  };
  void see_made(double unknown);
  void compare_made();

  static constexpr int works = 4, energies = 3;
  /// Of made_share(): a window in which more than that was made is found.
  static constexpr std::array<double, 2> shares{0.02, 0.3};
  double time_ = -1;                               ///< of the last state; negative: none yet
  std::array<double, works> rate_{}, work_{};      ///< supplied, dissipated, elastic, elastic where extended
  std::array<double, energies> first_{}, last_{};  ///< kinetic, elastic, elastic where extended
  double least_ = 0;      ///< the least elastic and surface energy of all rows, at most 0: below 0 where det B < 1
  double exchanged_ = 0;  ///< sizes of the powers supplied, that of forces at its largest
  Made made_;             ///< now
  std::array<Made, shares.size()> since_;  ///< rows after which most was made beyond a share
  double made_share_ = 0, made_share_max_ = 0;
  bool started_ = false;     ///< there was a row after the start
  bool may_return_ = false;  ///< allow_return()
};

}  // namespace eulastic
