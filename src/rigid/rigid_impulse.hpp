// The momentum that a step exchanges with rigid bodies, from which their loads follow; docs/method.md, section 19,
// (28c) to (28e).
#pragma once

#include "base/petsc.hpp"
#include "grid/domain.hpp"
#include "rigid/rigid_surfaces.hpp"

#include <array>
#include <vector>

namespace eulastic {

class ExactSums;

class RigidImpulse {
public:
  /// `faces` must outlive this; if bodies travel they change in every step.
  RigidImpulse(const Domain &domain, const RigidFaces &faces, const Fluid &fluid);

  /// Begins a step of dt (0: no step, loads are those of a state). `velocity` is that of `time`, body forces are those
  /// of `force_time`, and the faces are those of the end of the step.
  void begin(double time, double dt, double force_time, const Field &velocity);
  /// The averages that viscous stages accumulate.
  RigidMeans *means() { return &means_; }
  /// Adds the rate that cut faces miss because of their share. Call after the stages.
  void add_prediction(const Field &velocity, const Field &velocity_star);
  /// Sets the pressure at the start of the projection, to which increments are added. Reads owned cells.
  void set_pressure(const Field &pressure);
  /// Adds an increment that corrects the velocity; reads one ghost layer. `partly`: cut faces are corrected only as far
  /// as they are open.
  void add_increment(const Field &increment, bool partly);
  /// Computes the mean loads over the step, or those of a state after begin() and set_pressure() alone. Sums are exact,
  /// so that the bits do not depend on the ranks. Collective.
  PetscErrorCode measure(std::vector<RigidLoad> *loads) const;
  std::size_t bytes() const;

private:
  /// A body on a face of a cell normal to direction d. `weight`: 1 for the high face, -1 for the low one. Cells with
  /// the body on both have none.
  struct Contact {
    int d, i, j, k, body;
    double weight;
  };
  void find_contacts();
  const RigidMotion &motion_of(int image) const { return faces_.motions[faces_.bodies[image].motion]; }
  double velocity_before(int a, int image, const Int3 &face) const;
  double curved_advection(int a, const RigidFaces::Cut &cut, int j, int k, const Field &velocity) const;
  template <class Visit>
  void for_moving_faces(const Visit &visit) const;
  void add_cut(int a, const RigidFaces::Cut &cut, int j, int k, ExactSums *sums) const;
  void add(int body, int a, const Real3 &place, double push, ExactSums *sums) const;
  PetscErrorCode sum(std::vector<double> *total) const;
  double middle() const { return time_ + 0.5 * dt_; }
  std::size_t index(int a, const RigidFaces::Cut &cut) const { return &cut - faces_.cuts(a).data(); }

  const Domain &domain_;
  const RigidFaces &faces_;
  Fluid fluid_;
  double time_ = 0, dt_ = 0;
  Real3 force_{};  // body force per mass
  RigidMeans means_;
  std::array<std::vector<double>, 3> missing_rate_;  // dv/dt that cut faces did not get, by index among the cuts
  // Rate V_b - v of (28e) for each face inside a travelling body: excess of the body's velocity over that of the face,
  // over dt.
  std::vector<double> covered_rate_;
  std::vector<Contact> contacts_;
  std::vector<double> pressure_;  // at every contact
};

}  // namespace eulastic
