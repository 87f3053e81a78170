// The Poisson equation (10) handed to PETSc: any KSP and PC by -pressure_ksp_* and -pressure_pc_*.
//
// Preset: conjugate gradients to a relative residual of 1e-10 with one multigrid cycle, geometric (piecewise constant
// transfer, Chebyshev with Jacobi) where cells of about equal sides can be halved twice, else algebraic (GAMG).
#pragma once

#include "field/ghost_exchange.hpp"
#include "grid/domain.hpp"
#include "pressure/pressure_solver.hpp"

#include <petscksp.h>

namespace eulastic {

using KspHandle = Handle<KSP, KSPDestroy>;

class KspSolver final : public PressureSolver {
public:
  /// Collective; `grid` and `exchange` must outlive the solver. Everything is set up here, so that afterwards PETSc
  /// can tell which options it has read. Fails with PETSC_ERR_USER_INPUT and PETSc's message where it cannot take the
  /// value of an option.
  PetscErrorCode create(const Domain &domain, GhostExchange &exchange);

  /// The increment with lap(increment) = (divergence - its mean) / dt, up to the tolerance of the KSP on rms(D); its
  /// mean is 0 to round-off. All NaN if D is not finite. Fails if the KSP does not converge. Leaves `pressure` alone.
  /// Sums are MPI's: the bits depend on the ranks.
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
