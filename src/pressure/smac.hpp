// SMAC: solves the discrete Poisson equation (10) to round-off on any decomposition, by real transforms in x and z and
// a (cyclic) tridiagonal system in y. The bits do not depend on the number of ranks.
#pragma once

#include "base/petsc.hpp"
#include "field/ghost_exchange.hpp"
#include "grid/domain.hpp"
#include "pressure/line_transforms.hpp"
#include "pressure/pressure_solver.hpp"
#include "pressure/redistribute.hpp"
#include "pressure/tridiagonal.hpp"

namespace eulastic {

class SmacSolver final : public PressureSolver {
public:
  static constexpr int fields = 2;  ///< memory, in fields of the grid: two copies to transform
  /// Whether this build has FFTW.
  static bool available();
  /// Creates the solver; `domain` and `exchange` must outlive it. Fails without FFTW. Collective.
  static PetscErrorCode create(const Domain &domain, GhostExchange &exchange, std::unique_ptr<PressureSolver> *solver);

  /// Solves lap(increment) = (divergence - its mean) / dt for the increment with zero mean. Does not change `pressure`.
  PetscErrorCode solve(double dt, const Field &divergence, Field &pressure, Field &increment) override;

private:
  SmacSolver(const Domain &domain, GhostExchange &exchange) : domain_(&domain), exchange_(&exchange) {}
  PetscErrorCode set_up();
  /// Solves all y lines of values_, multiplied by `factor`.
  void solve_y(double factor);

  const Domain *domain_;
  GhostExchange *exchange_;
  Redistribution to_x_, to_z_, to_y_;  ///< grid -> complete x -> complete z -> complete y lines
  CellBlock box_x_, box_z_, box_y_;    ///< blocks of this rank with complete lines
  LineTransform transform_x_, transform_z_;
  TridiagonalLines lines_y_;
  std::vector<double> stiffness_x_, stiffness_z_;  ///< (h_y / h)^2 times the eigenvalues in box_y_
  std::vector<double> values_, other_;
  double flops_ = 0;
};

}  // namespace eulastic
