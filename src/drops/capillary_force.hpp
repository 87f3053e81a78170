// The force of surface tension of one phase, on a rank's part of the grid or in a box of its own: sigma kappa grad(phi)
// on faces, which a pressure balances exactly where the curvature is uniform; docs/method.md, section 17.
#pragma once

#include "base/exact_sum.hpp"
#include "base/petsc.hpp"
#include "field/ghost_exchange.hpp"
#include "field/net_force.hpp"
#include "field/phase.hpp"
#include "grid/active_segments.hpp"
#include "solids/elastic_force.hpp"

namespace eulastic {

class CapillaryForce {
public:
  static constexpr int work_fields = 2;
  /// Distance in cells from phi != 0 of cells with a curvature, and of faces with a force. A box needs as many cells
  /// around the body, except at boundaries of the domain.
  static constexpr int reach = 1;
  /// Distance in cells from phi != 0 that the spans of Phase::rows must cover, because scratch values are read there.
  static constexpr int span_reach = 2;
  /// Distance in cells from phi != 0 in which phi is read: number of valid ghost layers that phi, and grid or box,
  /// need.
  static constexpr int phi_ghosts = 5;

  /// `exchange`: that of the grid, or null for a box that is complete on this rank. `box` and `exchange` must outlive
  /// this.
  CapillaryForce(const Box &box, GhostExchange *exchange) : box_(&box), exchange_(exchange) {}

  /// Computes the curvature of the surface of a phase. All later calls refer to this phase and to `work`, work_fields
  /// components, until the next find(). Collective on the grid.
  PetscErrorCode find(const Phase &phase, Field &work) { return find(phase, phase.fraction[0], work); }
  /// The same for a copy of the phi of the phase that differs behind boundaries.
  PetscErrorCode find(const Phase &phase, ConstView phi, Field &work);
  /// A superset of the faces with a force, one ghost layer included.
  const ActiveSegments &faces() const { return band_; }
  /// force += scale sigma kappa grad(phi) at owned faces; the force, times its factor, is also added to `slope`. Adds
  /// what is added to `force` to `net`.
  void add_force(double scale, Field &force, const WeightedTarget &slope, NetForce *net);
  /// Adds tension kappa grad(phi) to the owned faces of component d in a row.
  void add_to_row(double tension, int d, int j, int k, double *force);
  /// The power that the flow supplies to the surface, divided by the cell volume, and the area of the planes by which
  /// transport cuts cells (2-D: length); sigma times the area is the energy.
  enum Sum { power, area, sums };
  /// Adds power and area to the sums `first_sum` and first_sum + 1 of each row part.
  void measure(const Field &velocity, int first_sum, std::vector<ExactSums> *sum);

private:
  static constexpr int work_ghosts = 2;  ///< ghost layers of the scratch fields that are read
  void clear_work();

  const Box *box_;
  GhostExchange *exchange_;
  const Phase *phase_ = nullptr;
  ConstView phi_{};
  Field work_;           ///< view of `work` of find()
  ActiveSegments band_;  ///< includes one ghost layer
};

}  // namespace eulastic
