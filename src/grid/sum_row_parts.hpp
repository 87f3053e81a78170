// Exact sums over the owned rows of all ranks.
#pragma once

#include "base/exact_sum.hpp"
#include "grid/domain.hpp"
#include "grid/threads.hpp"

#include <vector>

namespace eulastic {

/// Computes `count` exact sums over all ranks: add(part, sums) adds the contribution of every part of the owned rows.
/// Writes `count` doubles to `result`. Collective.
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
