#ifdef EULASTIC_HAVE_FFTW
#include "pressure/line_transforms.hpp"

#include <fftw3.h>

#include <algorithm>
#include <cmath>

namespace eulastic {

void LineTransform::Destroy::operator()(fftw_plan_s *plan) const noexcept { fftw_destroy_plan(plan); }
void LineTransform::Free::operator()(double *p) const noexcept { fftw_free(p); }

PetscErrorCode LineTransform::create(Boundary boundary, int cells, std::array<bool, 2> open) {
  PetscFunctionBeginUser;
  boundary_ = boundary;
  open_ = open;
  cells_ = cells;
  pitch_ = (cells + 7) / 8 * 8;
  if (pitch_ % 512 == 0) pitch_ += 8;  // lines that are multiples of 4 KiB apart would share cache sets
  const std::size_t size = std::size_t(batch) * pitch_;
  in_.reset(fftw_alloc_real(size));
  out_.reset(fftw_alloc_real(size));
  PetscCheck(in_ && out_, PETSC_COMM_SELF, PETSC_ERR_MEM, "no memory for transforms of %d cells", cells);
  const bool periodic = boundary == Boundary::periodic;
  const auto plan = [&](fftw_r2r_kind kind) {
    return fftw_plan_many_r2r(1, &cells_, batch, in_.get(), nullptr, 1, pitch_, out_.get(), nullptr, 1, pitch_, &kind,
                              FFTW_ESTIMATE | FFTW_DESTROY_INPUT);
  };
  const bool low = open[0], high = open[1];
  const fftw_r2r_kind mixed = low ? FFTW_RODFT11 : FFTW_REDFT11;
  forward_.reset(plan(periodic ? FFTW_R2HC : low != high ? mixed : low ? FFTW_RODFT10 : FFTW_REDFT10));
  backward_.reset(plan(periodic ? FFTW_HC2R : low != high ? mixed : low ? FFTW_RODFT01 : FFTW_REDFT01));
  PetscCheck(forward_ && backward_, PETSC_COMM_SELF, PETSC_ERR_LIB, "FFTW has no plan for %d cells", cells);
  double add, multiply, fused;
  fftw_flops(forward_.get(), &add, &multiply, &fused);
  flops_ = add + multiply + 2 * fused;
  PetscFunctionReturn(0);
}

double LineTransform::stiffness(int m) const {
  // In half-complex order cosine m is at m and sine m at N - m; the formula gives both the same value.
  const double waves = open_[0] != open_[1] ? m + 0.5 : open_[0] ? m + 1 : m;
  const double sine = std::sin(M_PI * waves / (boundary_ == Boundary::periodic ? cells_ : 2.0 * cells_));
  return 4 * sine * sine;
}

void LineTransform::forward(double *data, std::ptrdiff_t lines, std::ptrdiff_t distance, std::ptrdiff_t stride) {
  apply(forward_, data, lines, distance, stride);
}

void LineTransform::backward(double *data, std::ptrdiff_t lines, std::ptrdiff_t distance, std::ptrdiff_t stride) {
  apply(backward_, data, lines, distance, stride);
}

void LineTransform::apply(const Plan &plan, double *data, std::ptrdiff_t lines, std::ptrdiff_t distance,
                          std::ptrdiff_t stride) {
  for (std::ptrdiff_t first = 0; first < lines; first += batch) {
    const int n = static_cast<int>(std::min<std::ptrdiff_t>(batch, lines - first));
    double *block = data + first * distance;
    // Access the field with unit stride, whichever direction the lines have.
    if (stride == 1)
      for (int l = 0; l < n; ++l) std::copy_n(block + l * distance, cells_, in_.get() + l * pitch_);
    else
      for (int m = 0; m < cells_; ++m)
        for (int l = 0; l < n; ++l) in_[l * pitch_ + m] = block[l * distance + m * stride];
    // FFTW destroys its input. Clear the unused part, which would overflow if it were transformed repeatedly.
    std::fill_n(in_.get() + n * pitch_, (batch - n) * pitch_, 0.0);
    fftw_execute(plan.get());
    if (stride == 1)
      for (int l = 0; l < n; ++l) std::copy_n(out_.get() + l * pitch_, cells_, block + l * distance);
    else
      for (int m = 0; m < cells_; ++m)
        for (int l = 0; l < n; ++l) block[l * distance + m * stride] = out_[l * pitch_ + m];
  }
}

}  // namespace eulastic
#endif
