#include "diagnostics/energy_budget.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {

void EnergyBudget::advance(double time, const EnergyState &state) {
  const EnergyRates &r = state.rates;
  const std::array<double, works> rate{r.force_power + r.wall_power + r.side_power, state.dissipation,
                                       r.elastic_power + state.surface_power, r.extended_power};
  last_ = {state.kinetic, state.elastic + state.surface, r.extended_energy};
  const double exchanged = std::max(std::fabs(r.force_power), state.force_range) +
                           std::max(std::fabs(r.wall_power), state.wall_range) + std::fabs(r.side_power);
  const bool begins = time_ < 0;
  if (begins) {
    first_ = last_;
  } else {
    const double half = 0.5 * (time - time_);
    for (int w = 0; w < works; ++w) work_[w] += half * (rate_[w] + rate[w]);
    // The integral of a monotonic rate differs from its trapezoid by at most half the difference of the two values.
    made_.uncertainty += half * (std::fabs(rate[0] - rate_[0]) + std::fabs(rate[1] - rate_[1]));
    made_.throughput += half * (exchanged_ + exchanged);
  }
  rate_ = rate;
  exchanged_ = exchanged;
  time_ = time;
  least_ = std::min({least_, last_[1], 0.0});
  made_.made = -lost();
  const double held = last_[0] + (last_[1] - least_) + state.unknown;
  largest_ = std::max(largest_, held);
  made_.held = std::max(held, significant * largest_);
  if (started_ == 0) since_.fill(made_);
  if (!begins && !state.starts) started_ = 1;
  compare_made();
}

// A share x has been generated since row s if M = made - uncertainty - x throughput has grown since by more than x
// times the energy held at s. The criterion is strictest for the row with the least M + x held.
void EnergyBudget::compare_made() {
  made_share_ = 0;
  for (std::size_t n = 0; n < shares.size(); ++n) {
    const double x = shares[n];
    const auto beyond = [x](const Made &m) { return (m.made - m.uncertainty) - x * m.throughput + x * m.held; };
    Made &since = since_[n];
    if (!may_return_ && beyond(made_) < beyond(since)) since = made_;
    const double made = (made_.made - since.made) - (made_.uncertainty - since.uncertainty);
    const double of = since.held + (made_.throughput - since.throughput);
    if (made > 0 && of > 0) made_share_ = std::max(made_share_, made / of);
  }
  made_share_max_ = std::max(made_share_max_, made_share_);
}

double EnergyBudget::lost() const { return (work_[0] - work_[1]) - ((last_[0] - first_[0]) + (last_[1] - first_[1])); }

double EnergyBudget::lost_elastic() const { return work_[2] - (last_[1] - first_[1]); }

double EnergyBudget::lost_extended() const { return work_[3] - (last_[2] - first_[2]); }

std::vector<double *> EnergyBudget::numbers() {
  std::vector<double *> all{&time_};
  for (auto *part : {&rate_, &work_})
    for (double &value : *part) all.push_back(&value);
  for (auto *part : {&first_, &last_})
    for (double &value : *part) all.push_back(&value);
  return all;
}

std::vector<double *> EnergyBudget::generated_numbers() {
  // made_.held is left out, because the next row computes it again.
  std::vector<double *> all{&made_share_, &made_share_max_,   &started_,         &exchanged_,
                            &made_.made,  &made_.uncertainty, &made_.throughput, &least_};
  for (Made &m : since_) all.insert(all.end(), {&m.made, &m.uncertainty, &m.throughput, &m.held});
  return all;
}

}  // namespace eulastic
