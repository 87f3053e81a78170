#include "diagnostics/probes.hpp"

#include "base/events.hpp"
#include "base/exact_sum.hpp"
#include "field/boundaries.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

constexpr int values = 5;
static_assert(sizeof(Sample) == values * sizeof(double), "reduced as doubles");

// The cell that contains a point.
class ProbeCell {
public:
  ProbeCell(const Domain &domain, const Real3 &point) : domain_(domain) {
    for (int d = 0; d < domain.dimension(); ++d) {
      cells_[d] = point[d] / domain.spacing()[d];
      cell_[d] = std::clamp(static_cast<int>(std::floor(cells_[d])), 0, domain.domain_cells()[d] - 1);
    }
  }
  bool is_owned() const { return domain_.owner(cell_[0], cell_[1], cell_[2]) == domain_.rank(); }

  /// Interpolates linearly in every direction. `extrapolate`: extrapolate from inside instead of reading behind a
  /// boundary.
  double interpolate(ConstView q, const Staggering &at, bool extrapolate) const {
    Int3 base{};
    Real3 weight{};
    for (int d = 0; d < domain_.dimension(); ++d) {
      const double s = cells_[d] - (at[d] ? 0 : 0.5);
      int low = at[d] || s >= cell_[d] ? cell_[d] : cell_[d] - 1;
      if (extrapolate && domain_.is_wall(d)) low = std::clamp(low, 0, domain_.domain_cells()[d] - 2);
      base[d] = low - domain_.layout().begin[d];
      weight[d] = s - low;
    }
    return along(domain_.dimension() - 1, &q(base[0], base[1], base[2]), q, weight);
  }

private:
  static double along(int d, const double *p, const ConstView &q, const Real3 &weight) {
    if (d < 0) return *p;
    return (1 - weight[d]) * along(d - 1, p, q, weight) + weight[d] * along(d - 1, p + q.stride(d), q, weight);
  }

  const Domain &domain_;
  Real3 cells_{};
  Int3 cell_{};
};

}  // namespace

PetscErrorCode sample_points(const Domain &domain, const SampledFields &fields, const std::vector<Real3> &points,
                             std::vector<Sample> *samples) {
  PetscFunctionBeginUser;
  EventScope scope(Event::sums);
  samples->assign(points.size(), {});
  for (std::size_t n = 0; n < points.size(); ++n) {
    const ProbeCell place(domain, points[n]);
    if (!place.is_owned()) continue;
    Sample &sample = (*samples)[n];
    for (int c = 0; c < domain.dimension(); ++c)
      sample.velocity[c] = place.interpolate(fields.velocity[c], at_face[c], false);
    sample.pressure = place.interpolate(fields.pressure[0], at_centre, true);
    for (const Phase &phase : fields.phases)
      sample.solid_fraction += place.interpolate(phase.fraction[0], at_centre, false);
    sample.solid_fraction = std::min(sample.solid_fraction, 1.0);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, samples->data(), static_cast<int>(values * points.size()), MPI_DOUBLE,
                             MPI_SUM, domain.comm()));
  PetscFunctionReturn(0);
}

PetscErrorCode sample_planes(const Domain &domain, const SampledFields &fields, int direction,
                             std::vector<Sample> *samples) {
  PetscFunctionBeginUser;
  EventScope scope(Event::sums);
  const int planes = domain.domain_cells()[direction], n = domain.cells()[0], dimension = domain.dimension();
  const Int3 &begin = domain.layout().begin;
  ExactSums sums(values * planes);
  std::vector<double> row(n);
  const auto add = [&](const Segment &at, int value) {
    const int plane = direction == 1 ? begin[1] + at.j : begin[2] + at.k;
    if (direction > 0)
      sums.add_row(values * plane + value, row.data(), n, begin[0]);
    else
      for (int i = 0; i < n; ++i) sums.add(values * (begin[0] + i) + value, row[i]);
  };
  for (const Segment &at : domain.rows()) {
    for (int c = 0; c < dimension; ++c) {
      const ConstView view = fields.velocity[c];
      const double *q = view.row(at.j, at.k), *next = q + view.stride(c);
      for (int i = 0; i < n; ++i) row[i] = 0.5 * (q[i] + next[i]);
      add(at, c);
    }
    std::copy_n(fields.pressure[0].row(at.j, at.k), n, row.begin());
    add(at, 3);
    if (fields.phases.empty()) continue;
    std::fill(row.begin(), row.end(), 0.0);
    for (const Phase &phase : fields.phases)
      for (int i = 0; i < n; ++i) row[i] += phase.fraction[0](i, at.j, at.k);
    for (double &phi : row) phi = std::min(phi, 1.0);
    add(at, 4);
  }
  samples->assign(planes, {});
  std::vector<double> sum(values * planes);
  PetscCall(sums.reduce(domain.comm(), sum.data()));
  const double cells = domain.domain_cell_count() / planes;
  for (int plane = 0; plane < planes; ++plane) {
    const double *s = &sum[values * plane];
    (*samples)[plane] = {{s[0] / cells, s[1] / cells, s[2] / cells}, s[3] / cells, s[4] / cells};
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
