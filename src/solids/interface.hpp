// Sharp, conservative transport of the solid fraction (4): PLIC with a plane in each interface cell, split by direction
// (kernels/interface_flux.hpp).
//
// The dilation of each direction is multiplied by the same [phi^n > 1/2] (Weymouth & Yue, JCP 229, 2010). A discretely
// solenoidal velocity then conserves the volume to round-off, and 0 <= phi <= 1 holds for sum |u_d| dt/h_d < 1/2.
#pragma once

#include "base/petsc.hpp"
#include "field/field.hpp"
#include "grid/active_segments.hpp"
#include "grid/box.hpp"

namespace eulastic {

class InterfaceTransport {
public:
  /// Ghost layers of the solid fraction that `advance` reads; of the velocity it reads three.
  static constexpr int ghosts = 4;

  static constexpr int work_fields = 2;

  /// Moves `fraction`, whose occupied rows are `rows`, over dt with face velocities. The order of directions follows
  /// from `step`. There is no communication: ghosts are moved along and are invalid afterwards; those behind boundaries
  /// need not be set. `work`: a field of work_fields components, whose values are overwritten.
  PetscErrorCode advance(const Box &box, double dt, const Field &velocity, long step, const OccupiedRows &rows,
                         Field &fraction, Field &work);
  /// Number of cells of the interface band in the last `advance`, ghosts included.
  double band_cells() const { return cells_.points(); }
  /// Number of planes constructed in the last `advance`, over all directions.
  double planes() const { return planes_; }

private:
  ActiveSegments cells_, faces_;
  double planes_ = 0;
};

}  // namespace eulastic
