#include "field/material.hpp"

#include <algorithm>

namespace eulastic {

std::vector<double> StretchForce::per_volume(const std::vector<double> &volumes) const {
  double total = 0;
  for (const double column_volume : volumes) total += column_volume;
  std::vector<double> pull(volumes.size(), 0.0);
  const double target = volume * total;
  const int n = static_cast<int>(volumes.size());
  for (const int sign : {1, -1}) {
    double remaining = target;
    for (int c = 0; c < n && remaining > 0; ++c) {
      const int column = sign > 0 ? n - 1 - c : c;
      const double available = volumes[column], taken = std::min(available, remaining);
      pull[column] += available > 0 ? sign * force * (taken / available) / target : 0;
      remaining -= taken;
    }
  }
  return pull;
}

}  // namespace eulastic
