// -NAME_stretch_force for labelled bodies on the grid: it pulls both ends of a body apart along x, as optical tweezers
// do; docs/method.md, (27a).
#pragma once

#include "base/petsc.hpp"
#include "bodies/body_owners.hpp"
#include "parts/flow.hpp"
#include "parts/flow_part.hpp"

namespace eulastic {

class StretchForces final : public FlowPart {
public:
  explicit StretchForces(Flow *flow) : flow_(*flow) {}
  static constexpr int fields = 1;  ///< components of the work space that each call uses
  PetscErrorCode begin_slope(double dt, Field &slope) override;
  PetscErrorCode add_rate(const MomentumRate &rate) override;
  PetscErrorCode add_power(const FlowLook &bodies, double *power) override;
  /// Whether bodies of any phase on the grid are stretched.
  static bool exist(const std::vector<Phase> &phases);

private:
  /// Finds the ends of the bodies with cells on this rank, from exact sums per body and column of cells across x.
  /// Collective.
  PetscErrorCode find(const std::vector<Phase> &phases);
  /// Adds the force per volume at owned faces, times its factor, to each target; uses the phases of the state.
  PetscErrorCode add(const std::vector<WeightedTarget> &targets);
  template <class Visit>
  void for_cells(const std::vector<Phase> &phases, const Visit &visit) const;

  Flow &flow_;
  std::unique_ptr<BodyOwners> owners_;     ///< of the phases in the last find()
  std::vector<Int3> near_;                 ///< reference cells of bodies with cells on this rank
  std::vector<std::vector<double>> pull_;  ///< force per volume of these bodies, by column of cells across x
};

}  // namespace eulastic
