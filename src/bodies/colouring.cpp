#include "bodies/colouring.hpp"

#include <algorithm>
#include <set>
#include <tuple>

namespace eulastic {

std::vector<int> colour_bodies(const std::vector<int> &bodies, const std::vector<NearBodies> &pairs) {
  const auto index = [&](int label) {
    return static_cast<int>(std::lower_bound(bodies.begin(), bodies.end(), label) - bodies.begin());
  };
  const std::size_t count = bodies.size();
  std::vector<std::vector<int>> near(count);
  for (const NearBodies &pair : pairs) {
    const int a = index(pair.body), b = index(pair.other);
    near[a].push_back(b);
    near[b].push_back(a);
  }
  for (std::vector<int> &list : near) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  std::vector<int> colour(count, -1);
  std::vector<std::set<int>> taken(count);
  const auto rank = [&](int b) { return std::tuple(-int(taken[b].size()), -int(near[b].size()), b); };
  std::set<std::tuple<int, int, int>> waiting;
  for (std::size_t b = 0; b < count; ++b) waiting.insert(rank(static_cast<int>(b)));
  while (!waiting.empty()) {
    const int next = std::get<2>(*waiting.begin());
    waiting.erase(waiting.begin());
    int &own = colour[next];
    for (own = 0; taken[next].count(own) > 0;) ++own;
    for (const int other : near[next]) {
      if (colour[other] >= 0 || taken[other].count(own) > 0) continue;
      waiting.erase(rank(other));
      taken[other].insert(own);
      waiting.insert(rank(other));
    }
  }
  return colour;
}

}  // namespace eulastic
