#include "diagnostics/energy_budget.hpp"

#include <algorithm>

namespace eulastic {

void EnergyBudget::advance(double time, const EnergyState &state) {
  const EnergyRates &r = state.rates;
  const std::array<double, works> rate{r.force_power + r.wall_power + r.side_power, state.dissipation,
                                       r.elastic_power + state.surface_power, r.extended_power};
  last_ = {state.kinetic, state.elastic + state.surface, r.extended_energy};
  if (time_ < 0) first_ = last_;
  for (int w = 0; w < works && time_ >= 0; ++w) work_[w] += 0.5 * (time - time_) * (rate_[w] + rate[w]);
  rate_ = rate;
  time_ = time;
}

double EnergyBudget::lost() const { return (work_[0] - work_[1]) - ((last_[0] - first_[0]) + (last_[1] - first_[1])); }

double EnergyBudget::lost_elastic() const { return work_[2] - (last_[1] - first_[1]); }

double EnergyBudget::lost_extended() const { return work_[3] - (last_[2] - first_[2]); }

std::vector<double> EnergyBudget::numbers() const {
  std::vector<double> all{time_};
  for (const auto &part : {rate_, work_}) all.insert(all.end(), part.begin(), part.end());
  for (const auto &part : {first_, last_}) all.insert(all.end(), part.begin(), part.end());
  return all;
}

void EnergyBudget::set_numbers(const std::vector<double> &numbers) {
  auto next = numbers.begin();
  time_ = *next++;
  for (auto *part : {&rate_, &work_}) std::copy_n(next, works, part->begin()), next += works;
  for (auto *part : {&first_, &last_}) std::copy_n(next, energies, part->begin()), next += energies;
}

}  // namespace eulastic
