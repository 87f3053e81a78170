#include "grid/cell_ranks.hpp"

#include <algorithm>
#include <set>

namespace eulastic {

std::vector<int> positions_over(const Domain &domain, int d, int begin, int end) {
  const Split &split = domain.split();
  const int count = domain.domain_cells()[d];
  if (domain.is_wall(d)) begin = std::max(begin, 0), end = std::min(end, count);
  std::set<int> positions;
  for (int i = begin; i < std::min(end, begin + count);) {
    const int cell = domain.image(d, i), position = split.position_along(d, cell);
    positions.insert(position);
    i += split.starts[d][position + 1] - cell;
  }
  return {positions.begin(), positions.end()};
}

std::vector<int> ranks_over(const Domain &domain, const Int3 &begin, const Int3 &end) {
  std::vector<int> ranks;
  const std::vector<int> x = positions_over(domain, 0, begin[0], end[0]),
                         y = positions_over(domain, 1, begin[1], end[1]);
  for (const int k : positions_over(domain, 2, begin[2], end[2]))
    for (const int j : y)
      for (const int i : x) ranks.push_back(domain.split().rank_at({i, j, k}));
  return ranks;
}

}  // namespace eulastic
