#include "membranes/stretched_body.hpp"

#include <utility>

namespace eulastic {

StretchedBody::StretchedBody(const Box &box, const Phase &phase) : box_(&box), phase_(&phase) {
  std::vector<double> volumes(box.cells()[0], 0.0);
  const ConstView phi = phase.fraction[0];
  for (const Segment &whole : box.rows()) {
    const Segment row = phase.rows.within(whole);
    for (int i = row.i_begin; i < row.i_end; ++i) volumes[i] += phi(i, row.j, row.k) * box.cell_volume();
  }
  per_volume_ = phase.material.stretch_force.per_volume(volumes);
}

void StretchedBody::add_force(View force) const {
  const ConstView phi = phase_->fraction[0];
  const int n = box_->cells()[0];
  for (const Segment &whole : box_->rows()) {
    const Segment row = phase_->rows.within(whole);
    for (int i = row.i_begin; i < row.i_end; ++i) {
      const double half = 0.5 * per_volume_[i] * phi(i, row.j, row.k);
      force(i, row.j, row.k) += half;
      if (i + 1 < n) force(i + 1, row.j, row.k) += half;
    }
  }
}

void StretchedBody::add_power(ConstView velocity, int which, ExactSums *sum) const {
  const ConstView phi = phase_->fraction[0];
  for (const Segment &whole : box_->rows()) {
    const Segment row = phase_->rows.within(whole);
    for (int i = row.i_begin; i < row.i_end; ++i) {
      const double force = per_volume_[i] * phi(i, row.j, row.k);
      if (force != 0) sum->add(which, 0.5 * force * (velocity(i, row.j, row.k) + velocity(i + 1, row.j, row.k)));
    }
  }
}

}  // namespace eulastic
