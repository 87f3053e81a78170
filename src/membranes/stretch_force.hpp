// -NAME_stretch_force on the labelled bodies of a grid: both ends of a body are pulled apart along x, as optical
// tweezers do; docs/method.md, (27a).
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
  /// Finds the ends of the body. What is given must outlive this.
  StretchedBody(const Box &box, const Phase &phase);
  /// force += the force per volume along x on the faces of the box.
  void add_force(View force) const;
  /// Adds to sum `which` what it does on a flow with this velocity along x, over the volume of a cell.
  void add_power(ConstView velocity, int which, ExactSums *sum) const;

private:
  const Box *box_;
  const Phase *phase_;
  std::vector<double> per_volume_;  ///< of the columns of the box
};

class StretchForces final : public FlowPart {
public:
  explicit StretchForces(Flow *flow) : flow_(*flow) {}
  static constexpr int fields = 1;  ///< of the work space, during each call
  PetscErrorCode begin_slope(double dt, Field &slope) override;
  PetscErrorCode add_rate(const MomentumRate &rate) override;
  PetscErrorCode add_power(const FlowLook &look, double *power) override;
  /// Whether bodies of any phase on the grid are pulled.
  static bool exist(const std::vector<Phase> &phases);

private:
  /// Finds the ends of the bodies that are here. Exact sums, one per cell along x and body. Collective.
  PetscErrorCode find(const std::vector<Phase> &phases);
  /// Adds the force per volume at owned faces, to each target as many times as it says; of the phases of the state.
  PetscErrorCode add(const std::vector<WeightedTarget> &targets);
  template <class Visit>
  void for_cells(const std::vector<Phase> &phases, const Visit &visit) const;

  Flow &flow_;
  std::unique_ptr<BodyOwners> owners_;     ///< of the phases that find() has seen
  std::vector<Int3> near_;                 ///< references of bodies that are here
  std::vector<std::vector<double>> pull_;  ///< of these, by column of cells across x: force per volume
};

}  // namespace eulastic
