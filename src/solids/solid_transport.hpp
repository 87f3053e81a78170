// Transport of B of one phase, (5), by Heun's method, with extrapolation and corrections at the surface:
// docs/method.md, section 7. The phase may be on the grid of all ranks or in a box that is complete on this rank.
#pragma once

#include "base/petsc.hpp"
#include "field/phase.hpp"
#include "solids/exterior.hpp"
#include "solids/surface_correction.hpp"
#include "solids/transport.hpp"

#include <cstdint>

namespace eulastic {

/// Enforces B_ab^2 <= B_aa B_bb on evolving edges, with the means of the diagonals over the four centres around;
/// transport_tensor() keeps the diagonals themselves >= 0. Reads B at centres in one ghost layer, where an edge beside
/// them evolves, and one ghost of phi.
PetscErrorCode limit_shear(const Box &box, const Phase &phase, Field &tensor);

class SolidTransport {
public:
  /// `extends`: B is extrapolated outside bodies; else it is I there.
  explicit SolidTransport(bool extends = false) : extends_(extends) {}

  /// Finds the layers to which B is extrapolated. phi needs five valid ghost layers; find_solid() must have run.
  PetscErrorCode find_layers(const Box &box, const Phase &phase);
  /// Extrapolates B of the phase, or its first stage, outside the body. Ghosts are invalid afterwards.
  PetscErrorCode extend(const PhaseDomain &place, const Phase &phase, Field &tensor, const OccupiedRows *rows);

  struct Step {
    double dt;
    std::int64_t number;  ///< B is corrected at the surface in every second step
    const Fluid &fluid;
    const Field &velocity;         ///< at the middle of the step, three ghost layers
    const ActiveSegments &before;  ///< where B differed from I before find_solid()
  };
  /// Advances B of the phase over dt. `stage`: work space with as many components. Requires find_layers(); ghosts of B
  /// are invalid afterwards.
  PetscErrorCode advance(const PhaseDomain &place, const Step &step, const OccupiedRows *rows, Phase &phase,
                         Field &stage);

private:
  bool extends_;
  ExteriorLayers layers_;
  SurfaceCorrection surface_;
};

}  // namespace eulastic
