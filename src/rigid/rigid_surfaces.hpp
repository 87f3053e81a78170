// Rigid bodies in the momentum equation: faces inside have the velocity of the body; the links of cut faces end at its
// surface, in every viscous stage (docs/method.md, section 19).
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

/// Replaces WENO5 by (28a) in the advection of cut faces whose upwind neighbour is inside. Changes `advection` (-v.grad
/// v; may be null) and, times `scale`, `rate`, which both contain WENO5 with `epsilon`. Call before the functions
/// below.
void advect_from_surfaces(const Box &box, const RigidFaces &faces, double time, double epsilon, double scale,
                          const Field &velocity, Field *advection, Field &rate);
/// Completes `rate`, which contains `included` of the viscosity: cut faces get (28), scaled by their share, and beside
/// bodies that travel or change their velocity (28b) over a step of dt; faces inside get 0. `slope` (may be null) is
/// scaled by the share, too.
void apply_rigid_surfaces(const Box &box, const RigidFaces &faces, double viscosity, double included, double time,
                          double dt, const Field &velocity, Field &rate, Field *slope);
/// Does the same for v* = v + dt rate, (7), without travelling bodies.
void apply_rigid_surfaces_euler(const Box &box, const RigidFaces &faces, double viscosity, double included, double time,
                                double dt, const Field &velocity, Field &velocity_star);
/// Values of all owned cut faces, and their restoration after the field has been changed.
std::vector<double> cut_face_values(const Box &box, const RigidFaces &faces, const Field &field);
void set_cut_face_values(const Box &box, const RigidFaces &faces, const std::vector<double> &values, Field &field);
/// Sets owned faces inside bodies to the velocity of these bodies at `time`.
void impose_rigid_motion(const Box &box, const RigidFaces &faces, double time, Field &velocity);

/// Reduces the correction by dt/rho grad(increment), which correct_velocity() applied in full, to the open part of cut
/// faces. Reads one ghost of the increment.
void correct_cut_faces(const Box &box, const RigidFaces &faces, double dt_over_density, const Field &increment,
                       Field &velocity);
/// Multiplies owned cut faces by the factor with which increments act on them, and sets faces inside to 0.
void scale_open_faces(const Box &box, const RigidFaces &faces, Field &field);
/// Sets owned faces inside bodies to 0.
void clear_rigid_faces(const Box &box, const RigidFaces &faces, Field &field);
/// Averages over a step, (28c): the velocity of cut faces, and the factors of every motion.
struct RigidMeans {
  std::array<std::vector<double>, 3> velocity;  ///< of every component, by index in RigidFaces::cuts()
  std::vector<std::array<double, 2>> factors;   ///< of every motion: factors of its velocity and of its rotation
};

/// The cut faces of a row in one stage of RKL2. The regular stage overwrites its own input, so that hold() computes the
/// cut faces before it, and release() writes them after it.
class RigidStage {
public:
  /// Surfaces have moved from `time` to `reached`, the time of W_{j-1}. The viscous coefficient c.viscous is multiplied
  /// by `viscosity`. `means` (may be null) accumulates `weight` times the change since `time`.
  RigidStage(const RigidFaces &faces, double viscosity, double time, double reached, double weight, RigidMeans *means);
  /// Stores the new values of cut faces begin <= i < end in `held`.
  void hold(const RigidFaces::Row &row, int dimension, int a, int begin, int end, const kernels::RklStage &c,
            const double *now, const std::array<std::ptrdiff_t, 3> &stride, const double *rate, const double *slope,
            const double *before, std::vector<double> *held) const;
  /// Writes `held` to the cut faces of the row.
  static void release(const RigidFaces::Row &row, int begin, int end, const std::vector<double> &held, double *out);

private:
  const RigidFaces &faces_;
  double viscosity_, weight_;
  RigidMeans *means_;
  std::vector<std::array<double, 2>> moved_;  ///< change of the factors of every motion
};

/// The load of the fluid on the surface of a body inside the box, without the pressure of a uniform body force.
struct RigidLoad {
  Real3 force{};     ///< per depth in 2-D
  Real3 torque{};    ///< about the centre of the body
  double power = 0;  ///< supplied by the body to the fluid
};

/// Viscous dissipation at cut faces beyond that of compact differences between faces, because (28) replaces the
/// Laplacian: the sum of (u - V).(L - L_c) u, with V the velocity of the body, less the friction of faces inside on
/// boundaries of the box. Collective.
PetscErrorCode measure_rigid_dissipation(const Domain &domain, const RigidFaces &faces, const Fluid &fluid, double time,
                                         const Field &velocity, double *dissipation);

}  // namespace eulastic
