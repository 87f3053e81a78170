// Coefficients of RKL2 (docs/method.md, section 5).
#pragma once

#include "kernels/super_time_stepping.hpp"

#include <vector>

namespace eulastic {

/// Returns b_j; b_0 = b_1 = b_2 = 1/3.
inline double rkl_weight(int j) { return j < 2 ? 1. / 3 : (double(j) * j + j - 2) / (2. * j * (j + 1)); }

/// Returns c_j, the fraction of dt that stage j reaches.
inline double rkl_stage_time(int j, int stages) {
  const double s = stages;
  return j == 1 ? rkl_stage_time(2, stages) / 3 : (double(j) * j + j - 2) / (s * s + s - 2);
}

/// Returns mu~_1 dt, the factor of M_0 in the first stage.
inline double rkl_first_step(int stages, double dt) {
  return dt * (stages == 1 ? 1 : rkl_weight(1) * 4. / (double(stages) * stages + stages - 2));
}

/// Returns the coefficients of stage j >= 2.
inline kernels::RklStage rkl_stage_coefficients(int j, int stages, double dt, double viscosity) {
  const double w = 4. / (double(stages) * stages + stages - 2);
  const double mu = (2. * j - 1) / j * rkl_weight(j) / rkl_weight(j - 1);
  const double nu = -(j - 1.) / j * rkl_weight(j) / rkl_weight(j - 2);
  const double mu_tilde = mu * w, gamma_tilde = -(1 - rkl_weight(j - 1)) * mu_tilde;
  return {mu, nu, mu_tilde * dt * viscosity, (mu_tilde + gamma_tilde) * dt,
          mu_tilde * dt * rkl_stage_time(j - 1, stages) * dt};
}

/// Returns the weights omega_j of (28c) of W_j-1, which stage j reads, in the mean of W over the step that determines
/// the viscous momentum: W_s = dt (M_0 + nu lap sum omega_j W_j-1). Index j, 2 ... stages.
inline std::vector<double> rkl_mean_weights(int stages) {
  std::vector<double> weights(stages + 1), factor_of_last(stages + 1);
  factor_of_last[stages] = 1;
  for (int j = stages; j > 1; --j) {
    const kernels::RklStage c = rkl_stage_coefficients(j, stages, 1, 1);
    weights[j] = c.viscous * factor_of_last[j];
    factor_of_last[j - 1] += c.mu * factor_of_last[j];
    factor_of_last[j - 2] += c.nu * factor_of_last[j];
  }
  return weights;
}

}  // namespace eulastic
