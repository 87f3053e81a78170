// B at the surface of a moving body: docs/method.md, section 7.
//
// In a cell that the surface cuts the velocity gradient is that of the mixture. What the solid's differs from it
// follows from the continuity of traction (K), and what is left of the error is forgotten with strain (F).
#pragma once

#include "base/petsc.hpp"
#include "grid/box.hpp"
#include "grid/threads.hpp"
#include "solids/exterior.hpp"

namespace eulastic {

/// The step that is corrected.
struct SurfaceStep {
  double dt;
  Fluid fluid;
  const BoxSides &sides;
};

class SurfaceCorrection {
public:
  /// Corrects B of the phase at owned points that evolve and are not full. Reads no point that does not evolve, nor
  /// behind walls; behind a plane of symmetry lies the mirror image. Four ghosts of B, five of phi, two of the
  /// velocity, those behind walls too; `work` is a block like B, of any values.
  PetscErrorCode apply(const Box &box, const SurfaceStep &step, const Field &velocity, Phase &phase, Field &work);

  /// How far full points are heard, in steps from face to face, and the layers that are read.
  static constexpr int reach = 3, ghosts = 4;

  /// What a point is.
  enum Kind : unsigned char { full, surface, outside };

private:
  struct Location : TensorComponent {
    std::vector<unsigned char> kind;  ///< of every point
    std::vector<PetscInt> points;     ///< of the surface, owned: offsets from the field's first double
    std::vector<double> next;         ///< their components, corrected, one after the other
  };
  void find_points(const Box &box, const BoxSides &sides, const Phase &phase, Location *location) const;
  /// At the centres of the band: the gradient of phi, up to a factor, and the strain rate, behind each other.
  void measure_centres(const Box &box, const Field &velocity, ConstView phi, Field &measured) const;
  template <int Dim>
  void correct(const Box &box, const SurfaceStep &step, const Phase &phase, const Field &measured, Piece piece,
               Location *location) const;

  ActiveSegments band_;              ///< cells that are neither full nor empty with all their neighbours
  std::vector<Location> locations_;  ///< centres first, then one per off-diagonal component
};

}  // namespace eulastic
