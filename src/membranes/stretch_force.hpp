// -NAME_stretch_force for labelled bodies on the grid: it pulls both ends of a body apart along x, as optical tweezers
// do; docs/method.md, (27a).
#pragma once

#include "base/exact_sum.hpp"
#include "base/petsc.hpp"
#include "bodies/body_owners.hpp"
#include "field/phase.hpp"
#include "parts/flow.hpp"
#include "parts/flow_part.hpp"

namespace eulastic {

inline bool is_stretched(const Material &material) { return material.stretch_force.force > 0; }

class StretchedBody {
public:
  /// Finds the ends of the body. `box` and `phase` must outlive this.
  StretchedBody(const Box &box, const Phase &phase);
  /// Adds the force per volume along x on the faces of the box.
  void add_force(View force) const;
  /// Adds the power of the force on a flow with this velocity along x, divided by the cell volume, to sum `which`.
  void add_power(ConstView velocity, int which, ExactSums *sum) const;

private:
  const Box *box_;
  const Phase *phase_;
  std::vector<double> per_volume_;  ///< force per volume, by column of the box
};

class StretchForces final : public FlowPart {
public:
  explicit StretchForces(Flow *flow) : flow_(*flow) {}
  static constexpr int fields = 1;  ///< components of the work space that each call uses
  PetscErrorCode begin_slope(double dt, Field &slope) override;
  PetscErrorCode add_rate(const MomentumRate &rate) override;
  PetscErrorCode add_power(const SynchronisedBodies &bodies, double *power) override;
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
