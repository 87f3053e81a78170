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
  update_made(state.unknown);
  if (!started_) since_.fill(made_);
  started_ = started_ || !(begins || state.starts);
  compare_made();
}

void EnergyBudget::update_made(double unknown) {
  least_ = std::min(least_, last_[1]);
  made_.made = -lost();
  made_.held = last_[0] + (last_[1] - least_) + unknown;
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
  exchanged_ = std::fabs(rate_[0]);
  update_made(0);
  since_.fill(made_);
  started_ = time_ >= 0;
}

std::vector<double> EnergyBudget::generated_numbers() const {
  // made_.held is left out, because the next row computes it again.
  std::vector<double> all{made_share_, made_share_max_,   started_ ? 1.0 : 0.0, exchanged_,
                          made_.made,  made_.uncertainty, made_.throughput,     least_};
  for (const Made &m : since_) all.insert(all.end(), {m.made, m.uncertainty, m.throughput, m.held});
  return all;
}

void EnergyBudget::set_generated_numbers(const std::vector<double> &numbers) {
  auto next = numbers.begin();
  made_share_ = *next++;
  made_share_max_ = *next++;
  started_ = *next++ != 0;
  exchanged_ = *next++;
  for (double *value : {&made_.made, &made_.uncertainty, &made_.throughput, &least_}) *value = *next++;
  least_ = std::min(least_, 0.0);  // by definition, even if the file has another value
  for (Made &m : since_)
    for (double *value : {&m.made, &m.uncertainty, &m.throughput, &m.held}) *value = *next++;
}

}  // namespace eulastic
