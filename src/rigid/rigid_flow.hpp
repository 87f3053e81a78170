// Rigid bodies in a flow: their positions, their part in prediction and projection, and the loads of the fluid on them;
// docs/method.md, section 19.
#pragma once

#include "parts/flow.hpp"
#include "parts/flow_part.hpp"
#include "pressure/obstacles.hpp"
#include "rigid/rigid_bodies.hpp"
#include "rigid/rigid_impulse.hpp"

#include <memory>

namespace eulastic {

class RigidFlow final : public FlowPart {
public:
  RigidFlow(Flow *flow, std::unique_ptr<RigidBodies> bodies);
  /// Places the bodies at the present time. Pressure solvers that compute an increment must know the closed faces: then
  /// an ObstacleSolver replaces `solver`, which becomes its preconditioner. Collective.
  PetscErrorCode create(std::unique_ptr<PressureSolver> *solver);
  const RigidFaces &faces() const { return bodies_->faces(); }

  std::size_t bytes() const override { return bodies_->bytes() + (impulse_ ? impulse_->bytes() : 0); }
  PetscErrorCode carry(CarriedState *state) override;
  PetscErrorCode start() override;
  PetscErrorCode begin_resume() override;
  PetscErrorCode resume() override;
  PetscErrorCode prescribe_velocity(double time, Field &velocity) override;
  double shortest_period() const override { return faces().shortest_period(); }
  PetscErrorCode prepare(double dt) override;
  PetscErrorCode begin_rate(const MomentumStep &step) override;
  PetscErrorCode add_rate(const MomentumRate &rate) override;
  PetscErrorCode close_rate(const MomentumRate &rate) override;
  PetscErrorCode constrain(double dt) override;
  PetscErrorCode begin_correction(Field &divergence) override;
  PetscErrorCode observe_increment(const Field &increment) override;
  PetscErrorCode correct(double time, double dt, const Field &increment, Field &velocity) override;
  PetscErrorCode end_projection(double dt, const Field &divergence, Field &increment) override;
  PetscErrorCode position_phases(double time, std::vector<Phase> *phases) override;
  PetscErrorCode end_step() override;

  /// Loads of the fluid on every body in the last step, in the order of their indices; before the first step those of
  /// the state. With travelling bodies it costs as much as a rate of momentum. Collective.
  PetscErrorCode loads(std::vector<RigidLoad> *loads);
  /// Adds the correction at surfaces of bodies to a viscous dissipation from compact differences between faces.
  /// Collective.
  PetscErrorCode add_dissipation(double *dissipation) const;

private:
  PetscErrorCode move_bodies(double time, double dt);
  PetscErrorCode start_loads();

  Flow &flow_;
  std::unique_ptr<RigidBodies> bodies_;
  ObstacleSolver *obstacles_ = nullptr;  ///< the pressure solver, if it is one for rigid bodies
  std::unique_ptr<RigidImpulse> impulse_;
  std::vector<RigidLoad> loads_;  ///< of step loads_step_
  std::int64_t loads_step_ = -1;
};

}  // namespace eulastic
