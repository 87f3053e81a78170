// A solver set up from functions of position, for tests of the whole step.
#pragma once

#include "solver/solver.hpp"

#include <cmath>
#include <functional>

namespace eulastic::test {

using Function = std::function<double(double x, double y, double z)>;

/// Position of point i of a field along direction d.
inline double position(const Domain &domain, int d, bool staggered, int i) {
  return (domain.layout().begin[d] + i + (staggered ? 0.0 : 0.5)) * domain.spacing()[d];
}

/// Calls f(value, x, y, z) at every owned point of a field, the high wall of staggered fields included.
template <class View, class F>
void for_points(const Domain &domain, View view, const Staggering &at, F &&f) {
  for (int k = 0; k < domain.points_end(2, at[2]); ++k)
    for (int j = 0; j < domain.points_end(1, at[1]); ++j)
      for (int i = 0; i < domain.points_end(0, at[0]); ++i)
        f(view(i, j, k), position(domain, 0, at[0], i), position(domain, 1, at[1], j), position(domain, 2, at[2], k));
}

inline void set(const Domain &domain, View view, const Staggering &at, const Function &value) {
  for_points(domain, view, at, [&](double &q, double x, double y, double z) { q = value(x, y, z); });
}

/// Root mean square of field - exact over the owned points (one rank).
inline double rms_error(const Domain &domain, ConstView view, const Staggering &at, const Function &exact) {
  double sum = 0;
  int n = 0;
  for_points(domain, view, at, [&](const double &q, double x, double y, double z) {
    const double e = q - exact(x, y, z);
    sum += e * e;
    ++n;
  });
  return std::sqrt(sum / n);
}

struct Scene {
  Domain domain;
  Solver solver;

  PetscErrorCode create(MPI_Comm comm, const GridSpec &grid_spec, const SolverSpec &spec) {
    PetscFunctionBeginUser;
    PetscCall(domain.create(comm, grid_spec));
    PetscCall(solver.create(domain, spec));
    PetscFunctionReturn(0);
  }

  /// Adds a phase with the given solid fraction and B = I.
  Phase &add_phase(double shear_modulus, const Function &fraction, bool anchored = false) {
    Phase phase;
    phase.species = "solid";
    phase.material.shear_modulus = shear_modulus;
    phase.material.anchored = anchored;
    phase.empty(domain, false);
    set(domain, phase.fraction[0], at_centre, fraction);
    solver.state().phases.push_back(std::move(phase));
    return solver.state().phases.back();
  }

  /// `steps` steps of `share` of the automatic one; 0 also where nothing was found to be bad.
  PetscErrorCode advance(int steps, double share) {
    PetscFunctionBeginUser;
    FlowExtremes extremes;
    for (int n = 0; n < steps; ++n) {
      PetscCall(solver.measure(&extremes));
      PetscCheck(extremes.first_non_finite == -1, domain.comm(), PETSC_ERR_FP, "step %d", n);
      PetscCall(solver.step(share * solver.limits(extremes).automatic()));
    }
    PetscFunctionReturn(0);
  }

  /// `steps` equal steps to time `end`.
  PetscErrorCode run(double end, int steps) {
    PetscFunctionBeginUser;
    const double begin = solver.state().time, dt = (end - begin) / steps;
    FlowExtremes extremes;
    for (int n = 0; n < steps; ++n) {
      if (n % 10 == 0) PetscCall(solver.measure(&extremes));
      PetscCall(solver.step(dt));
    }
    PetscFunctionReturn(0);
  }
};

/// log2 of the error ratio of a grid and the next finer one.
inline double order(double coarse, double fine) { return std::log2(coarse / fine); }

}  // namespace eulastic::test
