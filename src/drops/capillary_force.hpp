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
  /// Cells beyond phi != 0 that have a curvature, and faces beyond it that feel the force: a box needs so many cells
  /// around the body, except at sides of the domain.
  static constexpr int reach = 1;
  /// Cells beyond phi != 0 that the spans of Phase::rows must hold: those whose scratch values are read.
  static constexpr int span_reach = 2;
  /// Cells beyond phi != 0 whose phi is read. phi needs so many valid layers of ghosts, and so has the grid or box.
  static constexpr int phi_ghosts = 5;

  /// `exchange`: of the grid; null for a box that is whole on this rank. Both must outlive this.
  CapillaryForce(const Box &box, GhostExchange *exchange) : box_(&box), exchange_(exchange) {}

  /// Finds the curvature of the surface of a phase. All that follows is of this phase, and uses it and `work`,
  /// work_fields fields of any values, until the next find(). Collective on the grid.
  PetscErrorCode find(const Phase &phase, Field &work);
  /// All faces that feel the force, and some more; a layer of ghosts is included.
  const ActiveSegments &faces() const { return band_; }
  /// force += scale sigma kappa grad(phi) at owned faces; with a factor also to `slope`. Adds to `net` what is added to
  /// `force`.
  void add_force(double scale, Field &force, const WeightedTarget &slope, NetForce *net);
  /// The power that the flow gives to the surface over the volume of a cell, and the area of the planes that transport
  /// cuts cells with (2-D: the length), of which sigma times is the energy.
  enum Sum { power, area, sums };
  /// Adds them to sum number `first_sum` and the next of every part of the rows.
  void measure(const Field &velocity, int first_sum, std::vector<ExactSums> *sum);

private:
  static constexpr int work_ghosts = 2;  ///< layers of the scratch fields that are read
  void clear_work();

  const Box *box_;
  GhostExchange *exchange_;
  const Phase *phase_ = nullptr;
  Field work_;           ///< borrowed
  ActiveSegments band_;  ///< with a layer of ghosts
};

}  // namespace eulastic
