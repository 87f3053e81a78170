// The adaptive artificial compressibility method of the paper in a single explicit step: (11), (12), (13).
#pragma once

#include "base/petsc.hpp"
#include "field/ghost_exchange.hpp"
#include "grid/domain.hpp"
#include "kernels/momentum.hpp"
#include "pressure/pressure_solver.hpp"

namespace eulastic {

/// Coefficients kappa = beta^2 dt^2 and g = beta^2 dt^2 gamma of delta p = -(kappa D* + g p)/dt.
struct AcmCoefficients {
  double kappa = 0, g = 0;
  double sound_speed(double dt) const;  ///< beta
  double relaxation() const;            ///< gamma
};

/// The sums of (13): A1 = -<D lap D>, A2 = <(lap D)^2>, A3 = <(lap p)^2>, B1 = <D lap p>, B2 = <lap D lap p>.
struct AcmSums {
  double A1, A2, A3, B1, B2;
};

/// (12): the minimum of <(D + kappa lap D + g lap p)^2>. g = 0 if kappa or g would be negative, or if D and p are
/// parallel; both are 0 if A2 = 0.
AcmCoefficients acm_coefficients(const AcmSums &sums);

class AcmSolver : public PressureSolver {
public:
  explicit AcmSolver(const Domain &domain) : domain_(&domain) {}
  /// Computes formula() and fills no field. With an open boundary, where the increment is 0, it fills the increment
  /// instead, and overwrites ghosts of the pressure behind boundaries.
  PetscErrorCode solve(double dt, const Field &divergence, Field &pressure, Field &increment) override;
  const AcmCoefficients &last() const { return last_; }
  const kernels::AcmIncrement *formula() const override { return domain_->any_open() ? nullptr : &formula_; }
  double sound_speed() const override { return sound_speed_; }
  void forget_sound_speed() override { sound_speed_ = 0; }

private:
  const Domain *domain_;
  AcmCoefficients last_;
  kernels::AcmIncrement formula_{};
  double sound_speed_ = 0;
};

}  // namespace eulastic
