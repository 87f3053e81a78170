#include "field/net_force.hpp"

#include "grid/blocks.hpp"
#include "kernels/isa.hpp"

namespace eulastic {

NetForce::NetForce(const Domain &domain, bool wanted) : domain_(&domain) {
  if (wanted) sums_.assign(threads(), ExactSums(domain.dimension()));
}

EULASTIC_CLONES void add_force_row(int n, const double *added, double factor, double *force, double *slope) {
#pragma omp simd
  for (int i = 0; i < n; ++i) force[i] += added[i];
  if (!slope) return;
#pragma omp simd
  for (int i = 0; i < n; ++i) slope[i] = kernels::fma(factor, added[i], slope[i]);
}

void subtract_mean(const Box &box, const Real3 &mean, Field &force) {
  const int n = box.cells()[0];
  for (int d = 0; d < box.dimension(); ++d) {
    if (mean[d] == 0) continue;
    in_row_parts(box, [&](const RowPart &part) {
      for_rows_in_blocks(part, [&](int j, int k) {
        double *row = force[d].row(j, k);
        for (int i = 0; i < n; ++i) row[i] -= mean[d];
      });
    });
  }
}

PetscErrorCode NetForce::compute_mean(Real3 *mean) {
  PetscFunctionBeginUser;
  *mean = {};
  if (sums_.empty()) PetscFunctionReturn(0);
  double sum[3];
  PetscCall(reduce_parts(domain_->comm(), sums_, sum));
  for (int d = 0; d < domain_->dimension(); ++d)
    if (!domain_->is_wall(d)) (*mean)[d] = sum[d] / domain_->domain_cell_count();
  PetscFunctionReturn(0);
}

PetscErrorCode NetForce::subtract_mean_force(Field &force) {
  PetscFunctionBeginUser;
  Real3 mean;
  PetscCall(compute_mean(&mean));
  subtract_mean(*domain_, mean, force);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
