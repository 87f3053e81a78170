// The bending of membranes: force and energy of E_b/2 (kappa - c0)^2 per area, kappa the sum of the principal
// curvatures, from a solid fraction that is smoothed twice; docs/method.md, section 18.
#pragma once

#include "base/petsc.hpp"
#include "field/phase.hpp"

namespace eulastic {

class MembraneBending {
public:
  static constexpr int work_fields = 6;

  explicit MembraneBending(const PhasePlace &place) : place_(place) {}
  /// Curvature and force of a phase into `fields` of the work space. `smooth`: SurfaceCells' fraction, ghosts filled, 0
  /// around the rows of the phase.
  PetscErrorCode find(const Phase &phase, ConstView smooth, Field &fields);
  /// The force along `a` on the owned faces of a row into out[0 .. cells); of the last find().
  void force_row(const Field &fields, int a, int j, int k, double *out) const;
  /// Energy per area at a cell; 0 where no curvature is known.
  static double energy(const Material &material, const Field &fields, std::ptrdiff_t at);

private:
  /// The last two are the means of force and delta around.
  enum Scratch { smoothed, curvature, delta, force, level, weight, mean = level };
  struct Window {
    Box::Range range[3];
    bool holds(const Int3 &place) const {
      bool inside = true;
      for (int d = 0; d < 3; ++d) inside = inside && place[d] >= range[d].begin && place[d] < range[d].end;
      return inside;
    }
  };
  struct Cell {
    std::ptrdiff_t at;  ///< offset from the origin
    bool forced;        ///< owned, or a ghost next to that: what faces feel
  };
  Window around(const Phase &phase, int ghosts) const;
  template <int Dim>
  void find_curvature(const Phase &phase, Field &fields);
  template <int Dim>
  void find_force(const Phase &phase, Field &fields);

  PetscErrorCode smooth_force(const Phase &phase, Field &fields);

  PhasePlace place_;
  std::vector<Cell> cells_;  ///< where there is a curvature
};

}  // namespace eulastic
