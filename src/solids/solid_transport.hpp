// B of one phase from one time to another, (5), by Heun's method, with what its surface needs: docs/method.md, section
// 7. The phase may lie on the grid of all ranks or in a box that is whole on this one.
#pragma once

#include "base/petsc.hpp"
#include "field/phase.hpp"
#include "solids/exterior.hpp"
#include "solids/surface_correction.hpp"
#include "solids/transport.hpp"

#include <cstdint>

namespace eulastic {

/// B_ab^2 <= B_aa B_bb on the edges that evolve, with the means of the diagonal over the four centres around them. The
/// diagonal itself is kept above 0 by transport_tensor(). Needs B at the centres in one ghost layer, where an edge
/// beside them evolves; phi in one.
PetscErrorCode limit_shear(const Box &box, const Phase &phase, Field &tensor);

class SolidTransport {
public:
  /// `extends`: B is extended outside bodies; else it is I there.
  explicit SolidTransport(bool extends = false) : extends_(extends) {}

  /// Finds where B is extended to. phi has five valid layers of ghosts; find_solid() has run.
  PetscErrorCode find_layers(const Box &box, const Phase &phase);
  /// Extends B of the phase outside the body, or its first stage. Ghosts are stale afterwards.
  PetscErrorCode extend(const PhasePlace &place, const Phase &phase, Field &tensor, const OccupiedRows *rows);

  struct Step {
    double dt;
    std::int64_t number;  ///< every second step corrects B at the surface
    const Fluid &fluid;
    const Field &velocity;         ///< of the middle of the step, three layers of ghosts
    const ActiveSegments &before;  ///< where B differed from I before find_solid()
  };
  /// Moves B of the phase over dt. `stage`: as many components, of any values. After find_layers(); ghosts of B are
  /// stale afterwards.
  PetscErrorCode advance(const PhasePlace &place, const Step &step, const OccupiedRows *rows, Phase &phase,
                         Field &stage);

private:
  bool extends_;
  ExteriorLayers layers_;
  SurfaceCorrection surface_;
};

}  // namespace eulastic
