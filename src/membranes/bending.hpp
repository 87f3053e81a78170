// Bending of membranes: force and energy of E_b/2 (kappa - c0)^2 per area, with kappa the sum of the principal
// curvatures, from phi smoothed twice; docs/method.md, section 18, (27).
#pragma once

#include "base/petsc.hpp"
#include "field/phase.hpp"

namespace eulastic {

class MembraneBending {
public:
  static constexpr int work_fields = 6;

  explicit MembraneBending(const PhaseDomain &place) : place_(place) {}
  /// Computes curvature and force of a phase in `fields` (work_fields components). `smooth`: smoothed phi of
  /// SurfaceCells with valid ghosts, 0 around the rows of the phase. Collective on the grid.
  PetscErrorCode find(const Phase &phase, ConstView smooth, Field &fields);
  /// Writes the force per volume along `a` on the owned faces of a row to out[0 .. cells), from the last find().
  void force_row(const Field &fields, int a, int j, int k, double *out) const;
  /// Bending energy per area at a cell; 0 where the curvature is not known.
  static double energy(const Material &material, const Field &fields, std::ptrdiff_t at);

private:
  /// `weight` and `mean` are averages of delta and force.
  enum Scratch { smoothed, curvature, delta, force, level, weight, mean = level };
  struct CellBlock {
    Box::Range range[3];
    bool holds(const Int3 &place) const {
      bool inside = true;
      for (int d = 0; d < 3; ++d) inside = inside && place[d] >= range[d].begin && place[d] < range[d].end;
      return inside;
    }
  };
  struct Cell {
    std::ptrdiff_t at;  ///< offset from the origin
    bool forced;        ///< owned, or a ghost beside an owned cell, whose force acts on owned faces
  };
  CellBlock block_around(const Phase &phase, int ghosts) const;
  template <int Dim>
  void find_curvature(const Phase &phase, Field &fields);
  template <int Dim>
  void find_force(const Phase &phase, Field &fields);

  PetscErrorCode smooth_force(const Phase &phase, Field &fields);

  PhaseDomain place_;
  std::vector<Cell> cells_;  ///< cells with a curvature
};

}  // namespace eulastic
