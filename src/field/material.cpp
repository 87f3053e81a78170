#include "field/material.hpp"

#include <algorithm>

namespace eulastic {

std::vector<double> StretchForce::per_volume(const std::vector<double> &volumes) const {
  double all = 0;
  for (const double of_column : volumes) all += of_column;
  std::vector<double> pull(volumes.size(), 0.0);
  const double target = volume * all;
  const int n = static_cast<int>(volumes.size());
  for (const int sign : {1, -1}) {
    double left = target;
    for (int c = 0; c < n && left > 0; ++c) {
      const int column = sign > 0 ? n - 1 - c : c;
      const double here = volumes[column], taken = std::min(here, left);
      pull[column] += here > 0 ? sign * force * (taken / here) / target : 0;
      left -= taken;
    }
  }
  return pull;
}

}  // namespace eulastic
