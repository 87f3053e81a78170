#include "pressure/smac.hpp"

#include "base/events.hpp"
#include "field/open_boundaries.hpp"

#include <algorithm>

namespace eulastic {

#ifdef EULASTIC_HAVE_FFTW

bool SmacSolver::available() { return true; }

PetscErrorCode SmacSolver::create(const Domain &domain, GhostExchange &exchange,
                                  std::unique_ptr<PressureSolver> *solver) {
  PetscFunctionBeginUser;
  std::unique_ptr<SmacSolver> smac(new SmacSolver(domain, exchange));
  PetscCall(smac->set_up());
  *solver = std::move(smac);
  PetscFunctionReturn(0);
}

PetscErrorCode SmacSolver::set_up() {
  PetscFunctionBeginUser;
  const bool flat = domain_->dimension() == 2;
  // The directions are ordered such that each transfer splits a direction that is complete or still to come; slabs are
  // transferred only once.
  const CellBlocks own(domain_->split()), x = own.complete(0, 1), z = x.complete(2, 0), y = z.complete(1, flat ? 0 : 2);
  PetscCall(to_x_.create(domain_->comm(), own, x));
  PetscCall(to_z_.create(domain_->comm(), x, z));
  PetscCall(to_y_.create(domain_->comm(), z, y));
  const int me = domain_->rank();
  box_x_ = x.of(me);
  box_z_ = z.of(me);
  box_y_ = y.of(me);
  const std::ptrdiff_t size = std::max({own.of(me).size(), box_x_.size(), box_z_.size(), box_y_.size()});
  values_.resize(size);
  other_.resize(domain_->ranks() > 1 ? size : 0);

  const auto scaled = [&](const LineTransform &transform, int d, std::vector<double> &stiffness) {
    const double ratio = domain_->spacing()[1] / domain_->spacing()[d];
    for (int m = 0; m < box_y_.cells[d]; ++m)
      stiffness.push_back(ratio * ratio * transform.stiffness(box_y_.begin[d] + m));
  };
  PetscCall(transform_x_.create(domain_->boundary(0), domain_->domain_cells()[0], domain_->domain_shape().open[0]));
  scaled(transform_x_, 0, stiffness_x_);
  flops_ = 2 * transform_x_.flops_per_line() * box_x_.cells[1] * box_x_.cells[2];
  if (flat) {
    stiffness_z_ = {0.0};
  } else {
    PetscCall(transform_z_.create(domain_->boundary(2), domain_->domain_cells()[2], domain_->domain_shape().open[2]));
    scaled(transform_z_, 2, stiffness_z_);
    flops_ += 2 * transform_z_.flops_per_line() * box_z_.cells[0] * box_z_.cells[1];
  }
  lines_y_ = TridiagonalLines(domain_->domain_cells()[1], domain_->boundary(1) == Boundary::periodic,
                              domain_->domain_shape().open[1]);
  flops_ += TridiagonalLines::flops_per_value * double(box_y_.size());
  PetscFunctionReturn(0);
}

PetscErrorCode SmacSolver::solve(double dt, const Field &divergence, Field &, Field &increment) {
  PetscFunctionBeginUser;
  {
    EventScope scope(Event::smac);
    scope.flops(flops_);
    const Int3 owned = domain_->cells();
    const auto packed = [&](int j, int k) { return values_.begin() + owned[0] * (j + std::ptrdiff_t(owned[1]) * k); };
    const std::ptrdiff_t lines_x = std::ptrdiff_t(box_x_.cells[1]) * box_x_.cells[2];
    const std::ptrdiff_t lines_z = std::ptrdiff_t(box_z_.cells[0]) * box_z_.cells[1];
    const bool flat = domain_->dimension() == 2;
    double gain = transform_x_.gain();
    if (!flat) gain *= transform_z_.gain();

    for (const Segment &s : domain_->rows()) std::copy_n(divergence[0].row(s.j, s.k), owned[0], packed(s.j, s.k));
    PetscCall(to_x_.forward(values_, other_));
    transform_x_.forward(values_.data(), lines_x, box_x_.cells[0], 1);
    PetscCall(to_z_.forward(values_, other_));
    if (!flat) transform_z_.forward(values_.data(), lines_z, 1, lines_z);
    PetscCall(to_y_.forward(values_, other_));
    solve_y(-domain_->spacing()[1] * domain_->spacing()[1] / (dt * gain));
    PetscCall(to_y_.backward(values_, other_));
    if (!flat) transform_z_.backward(values_.data(), lines_z, 1, lines_z);
    PetscCall(to_z_.backward(values_, other_));
    transform_x_.backward(values_.data(), lines_x, box_x_.cells[0], 1);
    PetscCall(to_x_.backward(values_, other_));
    for (const Segment &s : domain_->rows()) std::copy_n(packed(s.j, s.k), owned[0], increment[0].row(s.j, s.k));
  }
  PetscCall(exchange_->update_ghosts(increment, 1));
  fill_ghosts_of_increment(*domain_, increment[0], 1);
  PetscFunctionReturn(0);
}

void SmacSolver::solve_y(double factor) {
  constexpr int lanes = TridiagonalLines::lanes;
  const int nx = box_y_.cells[0], ny = box_y_.cells[1];
  for (int k = 0; k < box_y_.cells[2]; ++k)
    for (int first = 0; first < nx; first += lanes) {
      const int n = std::min(lanes, nx - first);
      double *block = values_.data() + first + std::ptrdiff_t(nx) * ny * k;
      double shift[lanes];
      for (int l = 0; l < lanes; ++l) shift[l] = l < n ? stiffness_x_[first + l] + stiffness_z_[k] : 1;
      for (int j = 0; j < ny; ++j)
        for (int l = 0; l < lanes; ++l) lines_y_.row(j)[l] = l < n ? factor * block[l + std::ptrdiff_t(nx) * j] : 0;
      lines_y_.solve(shift);
      for (int j = 0; j < ny; ++j)
        for (int l = 0; l < n; ++l) block[l + std::ptrdiff_t(nx) * j] = lines_y_.row(j)[l];
    }
}

#else

bool SmacSolver::available() { return false; }

PetscErrorCode SmacSolver::create(const Domain &domain, GhostExchange &, std::unique_ptr<PressureSolver> *) {
  PetscFunctionBeginUser;
  SETERRQ(domain.comm(), PETSC_ERR_SUP, "-pressure_solver smac needs FFTW, and this eulastic was built without it");
}

#endif

}  // namespace eulastic
