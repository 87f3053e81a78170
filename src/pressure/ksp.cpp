#include "pressure/ksp.hpp"

#include "base/exact_sum.hpp"
#include "field/global_vector.hpp"
#include "field/open_boundaries.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

constexpr double relative_tolerance = 1e-10;
constexpr int most_iterations = 1000;
constexpr int fewest_levels = 3;     // of geometric multigrid
constexpr double dense_cells = 512;  // largest coarsest grid that is solved by singular values

double shortest(const Box &box) {
  const Real3 &h = box.spacing();
  return *std::min_element(h.begin(), h.begin() + box.dimension());
}

// Assembles A of A q = b on the cells of any level: minus the Laplacian times the cell volume, in units of V/h^2 (V the
// volume, h the shortest side of the finest cells), so that PETSc's absolute thresholds do not depend on the units.
PetscErrorCode assemble(KSP ksp, Mat, Mat matrix, void *context) {
  const Domain &domain = *static_cast<const Domain *>(context);
  DM dm;
  DMDALocalInfo info;
  Handle<MatNullSpace, MatNullSpaceDestroy> constants;
  PetscFunctionBeginUser;
  PetscCall(KSPGetDM(ksp, &dm));
  PetscCall(DMDAGetLocalInfo(dm, &info));
  const PetscInt cells[3] = {info.mx, info.my, info.mz};
  double volume = 1, coupling[3] = {};
  for (int d = 0; d < domain.dimension(); ++d) {
    volume *= double(domain.domain_cells()[d]) / double(cells[d]);
    coupling[d] = std::pow(shortest(domain) / domain.domain_shape().length[d] * double(cells[d]), 2);
  }
  PetscCall(MatZeroEntries(matrix));
  for (PetscInt k = info.zs; k < info.zs + info.zm; ++k)
    for (PetscInt j = info.ys; j < info.ys + info.ym; ++j)
      for (PetscInt i = info.xs; i < info.xs + info.xm; ++i) {
        const PetscInt cell[3] = {i, j, k};
        const MatStencil row{k, j, i, 0};
        MatStencil column[7] = {row};
        double value[7] = {};
        PetscInt count = 1;
        for (int d = 0; d < domain.dimension(); ++d)
          for (const PetscInt side : {-1, 1}) {
            const PetscInt other = cell[d] + side;
            if (domain.is_wall(d) && (other < 0 || other >= cells[d])) {
              if (domain.is_open(d, side > 0)) value[0] += 2 * volume * coupling[d];  // the value is 0 half a cell away
              continue;
            }
            column[count] = row;
            (d == 0 ? column[count].i : d == 1 ? column[count].j : column[count].k) = other;
            value[count++] = -volume * coupling[d];
            value[0] += volume * coupling[d];
          }
        // Values are added, because with two cells around a periodic direction each is the other's neighbour on both
        // sides.
        PetscCall(MatSetValuesStencil(matrix, 1, &row, count, column, value, ADD_VALUES));
      }
  PetscCall(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
  if (domain.any_open()) PetscFunctionReturn(0);
  PetscCall(MatNullSpaceCreate(domain.comm(), PETSC_TRUE, 0, nullptr, constants.put()));
  PetscCall(MatSetNullSpace(matrix, constants.get()));
  PetscFunctionReturn(0);
}

// Beyond this ratio of spacings, halving all directions converges slowly (29 iterations at 2, 57 at 4). GAMG is used
// instead, which coarsens only along strong couplings.
constexpr double about_equal = 1.5;

bool about_equal_spacing(const Box &box) {
  const Real3 &h = box.spacing();
  return *std::max_element(h.begin(), h.begin() + box.dimension()) <= about_equal * shortest(box);
}

// Number of levels, as long as every direction can be halved and every rank keeps a cell, and the number of cells of
// the coarsest. With uneven ranks, PETSc moves both ends of a coarse block by up to a cell.
int geometric_levels(const Domain &domain, double *coarsest) {
  const int least = domain.spec().starts[0].empty() ? 1 : 3;
  Int3 cells = domain.domain_cells(), narrowest = cells;
  for (int d = 0; d < 3; ++d)
    for (int p = 0; p < domain.processors(d); ++p)
      narrowest[d] = std::min(narrowest[d], domain.split().cells_along(d, p));
  const auto halves = [&](int d) { return cells[d] % 2 == 0 && cells[d] / 2 >= 2 && narrowest[d] / 2 >= least; };
  int levels = 1;
  for (; halves(0) && halves(1) && (domain.dimension() == 2 || halves(2)); ++levels)
    for (int d = 0; d < domain.dimension(); ++d) cells[d] /= 2, narrowest[d] /= 2;
  *coarsest = double(cells[0]) * cells[1] * cells[2];
  return levels;
}

// An error handler that stores the message of the first error.
PetscErrorCode keep_first(MPI_Comm, int, const char *, const char *, PetscErrorCode code, PetscErrorType type,
                          const char *message, void *text) {
  if (type == PETSC_ERROR_INITIAL && message) *static_cast<std::string *>(text) = message;
  return code;
}

// Reports an invalid value of an option with PETSc's message; it is the same on all ranks.
PetscErrorCode set_from_options(KSP ksp) {
  std::string wrong;
  PetscFunctionBeginUser;
  PetscCall(PetscPushErrorHandler(keep_first, &wrong));
  const PetscErrorCode code = KSPSetFromOptions(ksp);
  PetscCall(PetscPopErrorHandler());
  PetscCheck(!code, PetscObjectComm(reinterpret_cast<PetscObject>(ksp)), PETSC_ERR_USER_INPUT,
             "-pressure_ksp_* or -pressure_pc_*: %s", wrong.c_str());
  PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode KspSolver::create(const Domain &domain, GhostExchange &exchange) {
  PetscFunctionBeginUser;
  domain_ = &domain;
  exchange_ = &exchange;
  PetscCall(domain.create_cell_dm(DMDA_STENCIL_STAR, 1, cells_.put()));
  PetscCall(DMDASetInterpolationType(cells_.get(), DMDA_Q0));
  PetscCall(DMCreateGlobalVector(cells_.get(), rhs_.put()));
  PetscCall(VecDuplicate(rhs_.get(), solution_.put()));
  PetscCall(KSPCreate(domain.comm(), ksp_.put()));
  PetscCall(KSPSetOptionsPrefix(ksp_.get(), "pressure_"));
  PetscCall(KSPSetDM(ksp_.get(), cells_.get()));
  PetscCall(KSPSetComputeOperators(ksp_.get(), assemble, const_cast<Domain *>(&domain)));
  PetscCall(set_preset());
  PetscCall(set_from_options(ksp_.get()));
  PetscCall(KSPSetUp(ksp_.get()));
  PetscCall(KSPSetUpOnBlocks(ksp_.get()));
  PetscFunctionReturn(0);
}

PetscErrorCode KspSolver::set_preset() {
  double coarsest;
  const int levels = geometric_levels(*domain_, &coarsest);
  PC pc, smoother;
  KSP level;
  PetscFunctionBeginUser;
  PetscCall(KSPSetType(ksp_.get(), KSPCG));
  // Preferred, since it is that of div v.
  PetscCall(KSPSetSupportedNorm(ksp_.get(), KSP_NORM_UNPRECONDITIONED, PC_LEFT, 4));
  PetscCall(KSPSetTolerances(ksp_.get(), relative_tolerance, PETSC_DEFAULT, PETSC_DEFAULT, most_iterations));
  PetscCall(KSPGetPC(ksp_.get(), &pc));
  if (levels < fewest_levels || !about_equal_spacing(*domain_)) {
    PetscCall(PCSetType(pc, PCGAMG));
    PetscReal threshold = 0.05;
    if (!about_equal_spacing(*domain_)) PetscCall(PCGAMGSetThreshold(pc, &threshold, 1));
    PetscFunctionReturn(0);
  }
  PetscCall(PCSetType(pc, PCMG));
  PetscCall(PCMGSetLevels(pc, levels, nullptr));
  for (int l = 1; l < levels; ++l) {
    PetscCall(PCMGGetSmoother(pc, l, &level));
    PetscCall(KSPSetType(level, KSPCHEBYSHEV));
    PetscCall(KSPGetPC(level, &smoother));
    PetscCall(PCSetType(smoother, PCJACOBI));
  }
  PetscCall(PCMGGetCoarseSolve(pc, &level));
  PetscCall(KSPSetType(level, KSPPREONLY));
  PetscCall(KSPGetPC(level, &smoother));
  PetscCall(PCSetType(smoother, coarsest > dense_cells ? PCGAMG : PCSVD));
  PetscFunctionReturn(0);
}

PetscErrorCode KspSolver::solve(double dt, const Field &divergence, Field &, Field &increment) {
  const double factor = -shortest(*domain_) * shortest(*domain_) / dt;
  ExactSums sum(1);
  double mean, rest;
  PetscFunctionBeginUser;
  for (const Segment &s : domain_->rows())
    sum.add_row(0, divergence[0].row(s.j, s.k), s.size(), domain_->layout().begin[0]);
  PetscCall(sum.reduce(domain_->comm(), &mean));
  mean = domain_->any_open() ? 0 : mean / domain_->domain_cell_count();
  PetscCall(to_global(*domain_, divergence[0], rhs_.get()));
  PetscCall(VecShift(rhs_.get(), -mean));
  PetscCall(VecScale(rhs_.get(), factor));
  PetscCall(VecNorm(rhs_.get(), NORM_2, &rest));
  // D is constant up to the rounding of its mean, so that no increment can reduce it.
  if (rest <= 1e-15 * std::abs(factor * mean) * std::sqrt(domain_->domain_cell_count()))
    PetscCall(VecSet(solution_.get(), 0));
  else if (!std::isfinite(rest))
    PetscCall(VecSet(solution_.get(), NAN));
  else
    PetscCall(iterate());
  PetscCall(from_global(*domain_, solution_.get(), increment[0]));
  PetscCall(exchange_->update_ghosts(increment, 1));
  fill_ghosts_of_increment(*domain_, increment[0], 1);
  PetscFunctionReturn(0);
}

PetscErrorCode KspSolver::iterate() {
  PetscInt iterations, limit;
  PetscReal residual;
  KSPConvergedReason reason;
  PetscFunctionBeginUser;
  PetscCall(KSPSolve(ksp_.get(), rhs_.get(), solution_.get()));
  PetscCall(KSPGetIterationNumber(ksp_.get(), &iterations));
  iterations_ += static_cast<long>(iterations);
  PetscCall(KSPGetConvergedReason(ksp_.get(), &reason));
  if (reason >= 0) PetscFunctionReturn(0);
  PetscCall(KSPGetTolerances(ksp_.get(), nullptr, nullptr, nullptr, &limit));
  PetscCall(KSPGetResidualNorm(ksp_.get(), &residual));
  SETERRQ(
      domain_->comm(), PETSC_ERR_NOT_CONVERGED,
      "-pressure_solver ksp did not converge (%s, residual %g); accepted: a larger -pressure_ksp_max_it (now %ld) or "
      "-pressure_ksp_rtol, another -pressure_ksp_type or -pressure_pc_type",
      KSPConvergedReasons[reason], residual, static_cast<long>(limit));
}

}  // namespace eulastic
