// Receptors in bins at least as wide as the reach of bonds, so that partners are in the neighbouring bins.
#pragma once

#include "grid/domain.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

namespace eulastic {

class ReceptorBins {
public:
  /// Divides the domain into bins at least `reach` wide, with its periodic boundaries.
  ReceptorBins(const Domain &domain, double reach) : domain_(domain) {
    for (int d = 0; d < domain.dimension(); ++d) count_[d] = std::max(1, static_cast<int>(length(d) / reach));
  }
  void add(std::size_t which, const Real3 &place) { bins_[bin_of(place)].push_back(which); }
  /// Calls visit(which) once for each receptor in the bin of a position and its neighbours.
  template <class Visit>
  void for_near(const Real3 &place, const Visit &visit) const;

private:
  double length(int d) const { return domain_.domain_shape().length[d]; }
  std::array<int, 3> bin_of(const Real3 &place) const {
    std::array<int, 3> bin{};
    for (int d = 0; d < domain_.dimension(); ++d) {
      const int plain = static_cast<int>(std::floor(place[d] / length(d) * count_[d]));
      bin[d] = domain_.is_wall(d) ? std::clamp(plain, 0, count_[d] - 1) : (plain % count_[d] + count_[d]) % count_[d];
    }
    return bin;
  }
  // Returns a bin and its neighbours along d.
  std::vector<int> near(int d, int bin) const {
    std::vector<int> found;
    for (int step = -1; step <= 1; ++step) {
      const int at = domain_.is_wall(d) ? bin + step : (bin + step + count_[d]) % count_[d];
      if (at >= 0 && at < count_[d] && std::find(found.begin(), found.end(), at) == found.end()) found.push_back(at);
    }
    return found;
  }

  const Domain &domain_;
  std::array<int, 3> count_{1, 1, 1};
  std::map<std::array<int, 3>, std::vector<std::size_t>> bins_;
};

template <class Visit>
void ReceptorBins::for_near(const Real3 &place, const Visit &visit) const {
  const std::array<int, 3> own = bin_of(place);
  for (const int x : near(0, own[0]))
    for (const int y : near(1, own[1]))
      for (const int z : near(2, own[2]))
        if (const auto bin = bins_.find({x, y, z}); bin != bins_.end())
          for (const std::size_t which : bin->second) visit(which);
}

}  // namespace eulastic
