// Bodies on the grid of all ranks: phi of all their species, and B of the elastic ones. All phases are moved together,
// so that their ghosts are exchanged together.
#pragma once

#include "grid/active_segments.hpp"
#include "parts/flow.hpp"
#include "parts/flow_part.hpp"
#include "solids/interface.hpp"
#include "solids/solid_transport.hpp"

namespace eulastic {

/// The rule by which B of a material evolves and is extrapolated.
EvolveRule evolve_rule(const Flow &flow, const Material &material);

class GridBodies final : public FlowPart {
public:
  explicit GridBodies(Flow *flow) : flow_(*flow), solids_(flow->spec.exterior == SolidExterior::extrapolate) {}
  /// Number of work-space fields that the transport needs.
  static int work_fields(const Method &method, int dimension);
  /// Memory beside the work space and the phases, in fields of the grid: targets of transports that cannot work in
  /// place. `elastic`: some species carries B.
  static double fields(const Method &method, int dimension, bool elastic);
  std::size_t bytes() const override;
  PetscErrorCode carry(CarriedState *state) override;
  PetscErrorCode start() override;
  PetscErrorCode resume() override;
  PetscErrorCode rebuild_derived_fields(Phase *phase) override;
  PetscErrorCode move(double dt, std::vector<Phase> *phases) override;
  PetscErrorCode reset_unresolved(const std::vector<double> &trace) override;

private:
  PetscErrorCode transport_left_cauchy_green(Phase &phase, const ActiveSegments &before, double dt,
                                             const OccupiedRows *rows);

  Flow &flow_;
  SolidTransport solids_;
  InterfaceTransport interface_;
  OccupiedRows next_rows_;  ///< of the phase that last gave its fields to Flow::next_fraction and next_tensor
  ActiveSegments stale_;    ///< plain Euler: where Flow::next_tensor may differ from I
};

}  // namespace eulastic
