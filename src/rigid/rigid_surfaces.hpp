// Rigid bodies in the momentum equation: faces inside have the velocity of the body, cut faces see its surface where it
// crosses their links, in every viscous stage (docs/method.md, section 19).
#pragma once

#include "base/petsc.hpp"
#include "field/material.hpp"
#include "field/phase.hpp"
#include "field/rigid_faces.hpp"
#include "grid/domain.hpp"

namespace eulastic {

namespace kernels {
struct RklStage;
}

/// Advection of cut faces whose neighbour upwind is inside: by the difference between the surface there and the face
/// ahead, in place of WENO5. To `advection`, -v.grad v of now (may be null), and `scale` times to `rate`, which have
/// that of WENO5 (`epsilon`); before all below.
void advect_from_surfaces(const Box &box, const RigidFaces &faces, double time, double epsilon, double scale,
                          const Field &velocity, Field *advection, Field &rate);
/// rate: of faces in the fluid's momentum equation with `included` of the viscosity in it. Afterwards cut faces have
/// the rate that sees the surface, scaled by their share, as is `slope` (may be null): beside bodies that travel in
/// their frame, within a step of dt; faces inside 0.
void see_rigid_surfaces(const Box &box, const RigidFaces &faces, double viscosity, double included, double time,
                        double dt, const Field &velocity, Field &rate, Field *slope);
/// The same of v* = v + dt rate, (7).
void see_rigid_surfaces_at_once(const Box &box, const RigidFaces &faces, double viscosity, double included, double time,
                                double dt, const Field &velocity, Field &velocity_star);
/// Values of all owned cut faces, and back: what is added to the field in between does not reach them.
std::vector<double> cut_face_values(const Box &box, const RigidFaces &faces, const Field &field);
void set_cut_face_values(const Box &box, const RigidFaces &faces, const std::vector<double> &values, Field &field);
/// Owned faces inside bodies get the velocity of these at `time`.
void impose_rigid_motion(const Box &box, const RigidFaces &faces, double time, Field &velocity);

/// Cut faces, which correct_velocity() has given all of dt/rho grad(increment), get their part of it; one ghost of the
/// increment.
void correct_cut_faces(const Box &box, const RigidFaces &faces, double dt_over_density, const Field &increment,
                       Field &velocity);
/// Scales owned cut faces by how far they are open to the increment; faces inside get 0.
void open_faces(const Box &box, const RigidFaces &faces, Field &field);
/// Owned faces inside bodies get 0.
void clear_rigid_faces(const Box &box, const RigidFaces &faces, Field &field);
/// What cut faces see within a step on average: their own velocity, and how fast the surfaces of every motion are.
struct RigidMeans {
  std::array<std::vector<double>, 3> velocity;  ///< of every component, by the place among RigidFaces::cuts()
  std::vector<std::array<double, 2>> factors;   ///< of every motion: of its velocity, of its rotation
};

/// The cut faces of a row in one stage of RKL2. The regular stage writes over what their own reads: hold() computes
/// them before it, release() puts them where they belong after it.
class RigidStage {
public:
  /// Increments of the factors of all motions from `time` to `reached`, when W_j-1 holds. c.viscous times `viscosity`.
  /// `means` (may be null) get `weight` times what has changed since `time`.
  RigidStage(const RigidFaces &faces, double viscosity, double time, double reached, double weight, RigidMeans *means);
  void hold(const RigidFaces::Row &row, int dimension, int a, int begin, int end, const kernels::RklStage &c,
            const double *now, const std::array<std::ptrdiff_t, 3> &stride, const double *rate, const double *slope,
            const double *before, std::vector<double> *held) const;
  static void release(const RigidFaces::Row &row, int begin, int end, const std::vector<double> &held, double *out);

private:
  const RigidFaces &faces_;
  double viscosity_, weight_;
  RigidMeans *means_;
  std::vector<std::array<double, 2>> moved_;  ///< of every motion
};

/// What the fluid exerts on a body: on its surface inside the box, the pressure of a uniform body force not included.
struct RigidLoad {
  Real3 force{};     ///< per depth in 2-D
  Real3 torque{};    ///< about the centre of the body
  double power = 0;  ///< of the body on the fluid
};

/// What viscosity dissipates at cut faces, where (28) takes the place of the Laplacian, beyond what the compact
/// differences between faces say: the sum of (u - V).(L - L_c) u, V the velocity of the body; less the friction of
/// faces inside on sides of the box. Collective.
PetscErrorCode measure_rigid_dissipation(const Domain &domain, const RigidFaces &faces, const Fluid &fluid, double time,
                                         const Field &velocity, double *dissipation);

}  // namespace eulastic
