#include "scene/cuts.hpp"

#include <algorithm>

namespace eulastic {
namespace {

// First unit of each rank if every rank takes as many units from the end as `bound` allows. `sums`: costs of all units
// before each.
std::vector<int> earliest(const std::vector<double> &sums, int parts, double bound) {
  std::vector<int> first(parts + 1, static_cast<int>(sums.size()) - 1);
  for (int p = parts - 1; p >= 0; --p) {
    const auto end = sums.begin() + first[p + 1];
    first[p] = static_cast<int>(std::lower_bound(sums.begin(), end, *end - bound) - sums.begin());
  }
  return first;
}

}  // namespace

std::vector<int> equal_cuts(const std::vector<double> &cost, int parts, int least) {
  std::vector<double> sums{0};
  for (const double c : cost) sums.push_back(sums.back() + c);
  const int units = static_cast<int>(cost.size());
  double too_low = 0, bound = sums.back();
  for (int halving = 0; halving < 50; ++halving) {
    const double middle = (too_low + bound) / 2;
    (earliest(sums, parts, middle)[0] > 0 ? too_low : bound) = middle;
  }
  std::vector<int> first = earliest(sums, parts, bound);
  first[0] = 0;
  for (int p = 1; p < parts; ++p) {
    const double share = sums.back() * p / parts, reach = sums[first[p - 1]] + bound;
    int cut = static_cast<int>(std::lower_bound(sums.begin(), sums.end(), share) - sums.begin());
    if (cut > 0 && share - sums[cut - 1] < sums[cut] - share) --cut;
    const int last = static_cast<int>(std::upper_bound(sums.begin(), sums.end(), reach) - sums.begin()) - 1;
    cut = std::max(std::min(cut, last), first[p]);
    first[p] = std::clamp(cut, first[p - 1] + least, units - (parts - p) * least);
  }
  return first;
}

}  // namespace eulastic
