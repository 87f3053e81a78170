// The Poisson equation (10) solved by PETSc with any KSP and PC, set by -pressure_ksp_* and -pressure_pc_*.
//
// Default: conjugate gradients to a relative residual of 1e-10, preconditioned by one multigrid cycle. It is geometric
// (piecewise constant transfer, Chebyshev smoothing with Jacobi) if the spacings are about equal and all cells can be
// halved twice, else algebraic (GAMG).
#pragma once

#include "field/ghost_exchange.hpp"
#include "grid/domain.hpp"
#include "pressure/pressure_solver.hpp"

#include <petscksp.h>

namespace eulastic {

using KspHandle = Handle<KSP, KSPDestroy>;

class KspSolver final : public PressureSolver {
public:
  /// Memory in fields of the grid: matrices, levels and vectors, as measured with the default.
  static constexpr int fields = 55;
  /// Creates and sets up the solver, so that PETSc knows afterwards which options have been read. `domain` and
  /// `exchange` must outlive it. Fails with PETSC_ERR_USER_INPUT and PETSc's message if the value of an option is
  /// invalid. Collective.
  PetscErrorCode create(const Domain &domain, GhostExchange &exchange);

  /// Solves lap(increment) = (divergence - its mean) / dt up to the tolerance of the KSP on rms(D). The mean of the
  /// increment is 0 to round-off. The increment is NaN if D is not finite. Fails if the KSP does not converge. Does not
  /// change `pressure`. Sums are those of MPI, so that the bits depend on the ranks.
  PetscErrorCode solve(double dt, const Field &divergence, Field &pressure, Field &increment) override;
  long sweeps() const override { return iterations_; }
  KSP ksp() const { return ksp_.get(); }

private:
  PetscErrorCode set_preset();
  PetscErrorCode iterate();

  const Domain *domain_ = nullptr;
  GhostExchange *exchange_ = nullptr;
  DmHandle cells_;
  KspHandle ksp_;
  VecHandle rhs_, solution_;
  long iterations_ = 0;
};

}  // namespace eulastic
