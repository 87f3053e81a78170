// Correction of B at the surface of moving bodies: docs/method.md, section 7.
//
// In a cell that the surface cuts, the velocity gradient is that of the mixture. Its difference from that of the solid
// follows from the continuity of traction, (22); the remaining error is relaxed towards B of the interior, (23).
#pragma once

#include "base/petsc.hpp"
#include "grid/box.hpp"
#include "grid/threads.hpp"
#include "solids/exterior.hpp"

namespace eulastic {

/// The step over which B is corrected.
struct SurfaceStep {
  double dt;
  Fluid fluid;
  const BoundaryConditions &sides;
};

class SurfaceCorrection {
public:
  /// Corrects B of the phase at owned points that evolve and are not full. Reads evolving points only, none behind
  /// walls, and mirror images behind planes of symmetry. Reads four ghosts of B, five of phi and two of the velocity,
  /// those behind boundaries included. `work`: work space with as many components as B.
  PetscErrorCode apply(const Box &box, const SurfaceStep &step, const Field &velocity, Phase &phase, Field &work);

  /// Largest distance of the full points used, in steps from face to face, and number of ghost layers read.
  static constexpr int reach = 3, ghosts = 4;

  /// Kind of a point.
  enum Kind : unsigned char { full, surface, outside };

private:
  struct Location : TensorComponent {
    std::vector<unsigned char> kind;  ///< of every point, ghosts included
    std::vector<PetscInt> points;     ///< owned points at the surface, as offsets from the first double of the field
    std::vector<double> next;         ///< corrected components of `points`, one point after the other
  };
  void find_points(const Box &box, const BoundaryConditions &sides, const Phase &phase, Location *location) const;
  /// Computes at the centres of the band the gradient of phi, up to a factor, and the strain rate, as consecutive
  /// components of `measured`.
  void measure_centres(const Box &box, const Field &velocity, ConstView phi, Field &measured) const;
  template <int Dim>
  void correct(const Box &box, const SurfaceStep &step, const Phase &phase, const Field &measured, Piece piece,
               Location *location) const;

  ActiveSegments band_;              ///< cells that are not, with all their neighbours, full or empty
  std::vector<Location> locations_;  ///< centres first, then one for each off-diagonal component
};

}  // namespace eulastic
