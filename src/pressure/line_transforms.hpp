// Real transforms that diagonalise the second difference along a line, by FFTW (Frigo and Johnson, Proc. IEEE 93,
// 2005): R2HC if periodic; DCT-II and DCT-III between two closed boundaries (even about the face), DST-II and DST-III
// between two open ones (odd about it), and DCT-IV or DST-IV, which are their own inverses, between one of each.
#pragma once

#include "base/petsc.hpp"
#include "grid/box.hpp"

#include <memory>

struct fftw_plan_s;

namespace eulastic {

/// Transforms lines in batches of fixed size in aligned scratch. Plans are estimated, so that the bits of a line depend
/// neither on its position in a batch nor on the rank.
class LineTransform {
public:
  static constexpr int batch = 8;

  /// `open`: whether the low and the high boundary are open, if not periodic.
  PetscErrorCode create(Boundary boundary, int cells, std::array<bool, 2> open = {});
  /// The eigenvalue of value m of a transformed line: q(i-1) - 2 q(i) + q(i+1) = -stiffness(m) q(i).
  double stiffness(int m) const;
  /// Factor by which forward() followed by backward() multiplies a line.
  double gain() const { return boundary_ == Boundary::periodic ? cells_ : 2.0 * cells_; }
  /// Transform in place; value m of line l is data[l distance + m stride].
  void forward(double *data, std::ptrdiff_t lines, std::ptrdiff_t distance, std::ptrdiff_t stride);
  void backward(double *data, std::ptrdiff_t lines, std::ptrdiff_t distance, std::ptrdiff_t stride);
  /// Flops of one transform of one line, forward or backward.
  double flops_per_line() const { return flops_ / batch; }

private:
  struct Destroy {
    void operator()(fftw_plan_s *plan) const noexcept;
  };
  struct Free {
    void operator()(double *p) const noexcept;
  };
  using Plan = std::unique_ptr<fftw_plan_s, Destroy>;
  void apply(const Plan &plan, double *data, std::ptrdiff_t lines, std::ptrdiff_t distance, std::ptrdiff_t stride);

  Boundary boundary_ = Boundary::periodic;
  std::array<bool, 2> open_{};
  int cells_ = 0;
  int pitch_ = 0;  ///< doubles between two lines in scratch, a multiple of 8
  double flops_ = 0;
  std::unique_ptr<double[], Free> in_, out_;
  Plan forward_, backward_;
};

}  // namespace eulastic
