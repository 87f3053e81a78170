#include "diagnostics/places.hpp"
#include "grid/domain.hpp"

#include <cmath>
#include <limits>

namespace eulastic {
namespace {

// Centre of the cell with the largest value(i, j, k) >= 0; the first one in the order of indices if there are several.
template <class Value>
PetscErrorCode largest(const Domain &domain, Value value, Real3 *place) {
  PetscFunctionBeginUser;
  const Int3 &begin = domain.layout().begin, &N = domain.domain_cells();
  double most = -1, own = -1, first = std::numeric_limits<double>::infinity();
  for_points(domain.rows(), [&](int i, int j, int k) {
    const double q = value(i, j, k);
    if (!(q > own)) return;
    own = q;
    first = begin[0] + i + double(N[0]) * (begin[1] + j + double(N[1]) * (begin[2] + k));
  });
  PetscCallMPI(MPI_Allreduce(&own, &most, 1, MPI_DOUBLE, MPI_MAX, domain.comm()));
  if (own < most) first = std::numeric_limits<double>::infinity();
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_DOUBLE, MPI_MIN, domain.comm()));
  *place = std::isfinite(first) ? place_of_cell(domain, first) : Real3{};
  PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode place_of_speed(const Domain &domain, const Field &velocity, Real3 *place) {
  PetscFunctionBeginUser;
  const auto rate = [&](int i, int j, int k) {
    double sum = 0;
    for (int d = 0; d < velocity.count(); ++d) sum += std::fabs(velocity[d](i, j, k)) / domain.spacing()[d];
    return sum;
  };
  PetscCall(largest(domain, rate, place));
  PetscFunctionReturn(0);
}

PetscErrorCode place_of_divergence(const Domain &domain, const Field &velocity, Real3 *place) {
  PetscFunctionBeginUser;
  const auto divergence = [&](int i, int j, int k) {
    double sum = 0;
    for (int d = 0; d < velocity.count(); ++d)
      sum += (velocity[d](i + (d == 0), j + (d == 1), k + (d == 2)) - velocity[d](i, j, k)) / domain.spacing()[d];
    return std::fabs(sum);
  };
  PetscCall(largest(domain, divergence, place));
  PetscFunctionReturn(0);
}

Real3 place_of_cell(const Box &box, double index) {
  const Int3 &n = box.domain_cells();
  const Real3 &h = box.spacing();
  const double i = std::fmod(index, n[0]), j = std::fmod(std::floor(index / n[0]), n[1]);
  return {(i + 0.5) * h[0], (j + 0.5) * h[1], (std::floor(index / n[0] / n[1]) + 0.5) * h[2]};
}

}  // namespace eulastic
