// Exact sums over all ranks of what a verb finds in the owned rows.
#pragma once

#include "base/exact_sum.hpp"
#include "grid/domain.hpp"
#include "grid/threads.hpp"

#include <vector>

namespace eulastic {

/// `count` exact sums over all ranks, of what add(part, sums) adds in every part of the owned rows. Collective.
template <class Add>
PetscErrorCode sum_row_parts(const Domain &domain, int count, const Add &add, double *result) {
  PetscFunctionBeginUser;
  const int parts = row_parts(domain);
  std::vector<ExactSums> sums(parts, ExactSums(count));
  in_parallel(parts, parts, [&](int part) { add(row_part(domain, part, parts), sums[part]); });
  PetscCall(reduce_parts(domain.comm(), sums, result));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
