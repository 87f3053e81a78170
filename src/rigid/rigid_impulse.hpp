// What a step exchanges with rigid bodies: their loads are the momentum that the fluid lacks after it (docs/method.md,
// section 19).
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
  /// `faces` must outlive it; where bodies travel every step begins with other ones.
  RigidImpulse(const Domain &domain, const RigidFaces &faces, const Fluid &fluid);

  /// Begins a step of dt (0: there is none, loads are those of a state): the velocity is that of `time`, body forces
  /// are those of `force_time`, the faces are those of the end of the step.
  void begin(double time, double dt, double force_time, const Field &velocity);
  /// Where viscous stages add what they change.
  RigidMeans *means() { return &means_; }
  /// After the stages: what cut faces lack because only a share of their rate moves them.
  void add_prediction(const Field &velocity, const Field &velocity_star);
  /// The pressure that acts in the step, less what increments add to it; owned cells are read.
  void set_pressure(const Field &pressure);
  /// An increment that corrects the velocity; one ghost layer. `partly`: cut faces as far as they are open.
  void add_increment(const Field &increment, bool partly);
  /// Mean loads over the step, or, where begin() and set_pressure() were all, those of a state. Exact sums: the same
  /// bits on any ranks. Collective.
  PetscErrorCode measure(std::vector<RigidLoad> *loads) const;
  std::size_t bytes() const;

private:
  /// A body on a face of a cell across direction d; weight: 1 of the high face, -1 of the low one; none
  /// if it is on both.
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
  Real3 force_{};  // per mass
  RigidMeans means_;
  std::array<std::vector<double>, 3> lacks_;  // by the place among cuts: dv/dt that cut faces did not get
  std::vector<double> covered_;  // of every face inside what travels: what it had less velocity than the body, over dt
  std::vector<Contact> contacts_;
  std::vector<double> pressure_;  // of every contact
};

}  // namespace eulastic
