// Sharp, conservative transport of the solid fraction (4): a plane in each cell of the interface (PLIC), split by
// direction (kernels/interface_flux.hpp).
//
// The dilation of each direction is taken with the same [phi^n > 1/2] (Weymouth & Yue, JCP 229, 2010): a discretely
// solenoidal velocity keeps the volume to round-off, and 0 <= phi <= 1 as long as sum |u_d| dt/h_d < 1/2.
#pragma once

#include "base/petsc.hpp"
#include "field/field.hpp"
#include "grid/active_segments.hpp"
#include "grid/box.hpp"

namespace eulastic {

class InterfaceTransport {
public:
  /// Layers of ghosts that `advance` reads of the solid fraction; of the velocity it reads three.
  static constexpr int ghosts = 4;

  static constexpr int work_fields = 2;

  /// Moves `fraction`, of which `rows` are occupied, over dt with face velocities. The order of directions follows from
  /// `step`: all of them in turn, each after its mirror image. Nothing is communicated: ghosts are moved along and are
  /// stale afterwards; those behind walls need not be set. `work`: a field of work_fields components, of any values.
  PetscErrorCode advance(const Box &box, double dt, const Field &velocity, long step, const OccupiedRows &rows,
                         Field &fraction, Field &work);
  /// Cells of the interface band in the last `advance`, ghosts included.
  double band_cells() const { return cells_.points(); }
  /// Planes that the last `advance` made, in all its directions.
  double planes() const { return planes_; }

private:
  ActiveSegments cells_, faces_;
  double planes_ = 0;
};

}  // namespace eulastic
