// The ranks that own blocks of cells.
#pragma once

#include "grid/domain.hpp"

#include <vector>

namespace eulastic {

/// The positions along d of the ranks that own any of the cells from `begin` to before `end`, which may wrap around a
/// periodic side; none of cells behind a side. Ascending.
std::vector<int> positions_over(const Domain &domain, int d, int begin, int end);
/// The ranks that own cells of such a block. Ascending.
std::vector<int> ranks_over(const Domain &domain, const Int3 &begin, const Int3 &end);

}  // namespace eulastic
