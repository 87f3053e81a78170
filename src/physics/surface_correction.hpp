// B at the surface of a moving body: docs/method.md, section 7.
//
// In a cell that the surface cuts the velocity gradient is that of the mixture. What the solid's differs from it
// follows from the continuity of traction (K), and what is left of the error is forgotten with strain (F).
#pragma once

#include "grid/threads.hpp"
#include "physics/exterior.hpp"

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
  /// velocity; `work` is a block like B, of any values.
  PetscErrorCode apply(const Grid &grid, const SurfaceStep &step, const FieldBlock &velocity, Phase &phase,
                       FieldBlock &work);

  /// How far full points are heard, in steps from face to face, and the layers that are read.
  static constexpr int reach = 3, ghosts = 4;

private:
  struct Location {
    int a = 0, b = 0;  ///< of the component on these edges; the same: centres
    Staggering at{};
    std::vector<unsigned char> mask;  ///< of every point: full, surface or outside
    std::vector<PetscInt> points;     ///< of the surface, owned: offsets from the field's first double
  };
  void find_points(const Grid &grid, const BoxSides &sides, const Phase &phase, Location *location) const;
  template <int Dim, class Law>
  void correct(const Grid &grid, const SurfaceStep &step, const Law &law, const FieldBlock &velocity,
               const Phase &phase, const Location &location, Piece piece, FieldBlock &next) const;

  std::vector<Location> locations_;  ///< centres first, then one per off-diagonal component
};

}  // namespace eulastic
