// Velocity faces at rigid bodies: faces inside a body, whose velocity is prescribed, and cut faces, which are fluid
// faces with a neighbour inside and use the surface instead of it (docs/method.md, section 19). Free of PETSc.
#pragma once

#include "grid/box.hpp"

#include <array>
#include <cmath>
#include <vector>

namespace eulastic {

/// The factor cos(frequency t + phase).
struct Oscillation {
  double frequency = 0;  ///< angular, 1 / time
  double phase = 0;      ///< rad
  double at(double time) const { return frequency == 0 && phase == 0 ? 1.0 : std::cos(frequency * time + phase); }
  double integral(double time) const {  ///< from time 0
    if (frequency == 0) return std::cos(phase) * time;
    return (std::sin(frequency * time + phase) - std::sin(phase)) / frequency;
  }
  double rate(double time) const { return -frequency * std::sin(frequency * time + phase); }
};

/// Motion of a body's surface: velocity V cos(..) + angular velocity W cos(..) x (x - centre). In `travelling`
/// directions the body moves with V, in others it slides along itself. If `turning`, the body rotates with W; otherwise
/// its shape is unchanged by rotation, as for spheres, and cylinders and tubes about their axis.
struct RigidMotion {
  Real3 velocity{};          ///< length / time
  Real3 angular_velocity{};  ///< rad / time
  Oscillation of_velocity, of_rotation;
  std::array<bool, 3> travelling{};
  bool turning = false;
  bool moves() const { return velocity != Real3{} || angular_velocity != Real3{}; }
  /// Whether the body moves through the grid.
  bool travels() const { return turning || travelling != std::array<bool, 3>{}; }
  /// Returns the displacement of the body since time 0.
  Real3 shift(double time) const {
    Real3 displacement{};
    for (int d = 0; d < 3; ++d) displacement[d] = travelling[d] ? velocity[d] * of_velocity.integral(time) : 0;
    return displacement;
  }
  /// Returns the rotation since time 0 as a vector: its direction is the axis, its length the angle in rad.
  Real3 angle(double time) const { return rotation_vector(of_rotation.integral(time)); }
  /// Returns the velocity of a body that moves through the grid at r from its centre.
  Real3 frame_velocity(const Real3 &r, double time) const;
  /// Returns the acceleration at r from its centre.
  Real3 acceleration(const Real3 &r, double time) const;
  /// Whether fluid beside its surface needs the rate of (28b): it travels, or its velocity changes.
  bool changes_frame() const {
    return travels() || (velocity != Real3{} && of_velocity.frequency != 0) ||
           (angular_velocity != Real3{} && of_rotation.frequency != 0);
  }
  /// Returns the rate of change of the velocity of its surface at r from its centre, in the frame in which its shape is
  /// at rest. In contrast to acceleration() it includes motion along its own surface.
  Real3 surface_acceleration(const Real3 &r, double time) const;
  /// Returns the angular velocity times a factor for a body that rotates through the grid, 0 for others.
  Real3 rotation_vector(double factor) const {
    Real3 w{};
    for (int d = 0; d < 3; ++d) w[d] = turning ? angular_velocity[d] * factor : 0;
    return w;
  }
};

/// Moments of a moving body about its centre at the density 1; in 2-D per unit depth. First and second moments are set
/// only for bodies that rotate.
struct RigidMass {
  double volume = 0;
  Real3 first{};                   ///< integral of r
  std::array<double, 6> second{};  ///< integral of r r^T: xx, yy, zz, yz, xz, xy
  /// Returns the moments of the body rotated by the matrix R, in the same axes.
  RigidMass turned(const std::array<Real3, 3> &R) const;
  /// Returns an estimate of the dissipation at the viscosity 1 and the largest velocities of its motion: that of a
  /// sphere of its volume in Stokes flow, in 2-D of a cylinder.
  double dissipation(const RigidMotion &motion, int dimension) const;
  /// Returns the force for the acceleration of the body at a density.
  Real3 force(const RigidMotion &motion, double time, double density) const;
  /// Returns the torque for the acceleration of the body at a density.
  Real3 torque(const RigidMotion &motion, double time, double density) const;
};

/// Difference between the volume of a body at rest and that of the faces inside it, each with the volume of a cell, for
/// every velocity component, and its first moment about the body's centre.
struct RigidGap {
  Real3 volume{};
  std::array<Real3, 3> first{};
};

/// The same difference on a boundary of the box, for an owned cell beside it, in parts of the cell's face.
struct RigidFootprint {
  Int3 cell{};
  int direction = 0;
  bool high = false;
  int body = 0;     ///< index in RigidFaces::bodies
  double more = 0;  ///< the difference
};

/// A body, or one of its images across periodic boundaries.
struct RigidBody {
  int index = 0;   ///< number among all rigid bodies
  int motion = 0;  ///< index in RigidFaces::motions
  Real3 centre{};  ///< from the middle of the box, in cells
};

/// All rigid bodies of the scene, and the faces at them on this rank.
class RigidFaces {
public:
  /// A fluid face with neighbours inside a body. Links are ordered low x, high x, low y, ...
  struct Cut {
    int i = 0;
    int body = 0;        ///< index in `bodies` of a body that cuts its links: one that travels, if there is any
    unsigned walls = 0;  ///< bits of the links that end at the surface
    /// factor s of the rate, which keeps the stages of the viscous step stable (docs/method.md, section 19)
    double share = 1;
    double open = 1;   ///< factor w of the gradient of the pressure increment, max(s, .03)
    double link[6]{};  ///< 1 / (length of the link times the spacing)
    double turn[6]{};  ///< component of W x (x - centre) where a link meets the surface
    int of_link[6]{};  ///< index in `bodies` of the body whose surface that is
    double laplacian(const double *u, const std::array<std::ptrdiff_t, 3> &stride, int dimension,
                     const double *wall) const;
  };
  /// Faces begin <= i < end are inside a body.
  struct Run {
    int begin, end, body;
  };
  struct Row {
    Slice<Cut> cuts;
    Slice<Run> runs;
    bool all = false;  ///< all faces of the row are inside, including its ghosts
    bool empty() const { return cuts.empty() && runs.empty(); }
  };

  std::vector<RigidMotion> motions;
  std::vector<RigidBody> bodies;
  std::vector<RigidMass> masses;           ///< by the index of the body
  std::vector<RigidGap> gaps;              ///< by the index of the body; 0 for bodies that move through the grid
  std::vector<RigidFootprint> footprints;  ///< only those with a difference other than 0
  /// for every motion: displacement from the time of the surfaces to that of the faces, in cells
  std::vector<Real3> ahead;
  int count = 0;  ///< number of bodies without images
  bool moves = false, travels = false;
  Real3 speed{};  ///< largest velocity of any surface along every direction

  const RigidMotion &motion_of(int index) const { return motions[bodies[bodies.size() / count * index].motion]; }
  /// Returns the cut faces and the runs of faces inside of component a in row (j, k), which may lie in a ghost layer.
  Row row(int a, int j, int k) const {
    const Component &c = components_[a];
    const std::size_t at = (j + layers_[1]) + std::size_t(rows_) * (k + layers_[2]);
    return {{c.cuts.data() + c.first_cut[at], c.cuts.data() + c.first_cut[at + 1]},
            {c.runs.data() + c.first_run[at], c.runs.data() + c.first_run[at + 1]},
            c.all[at] != 0};
  }
  /// Sets found[i] to the body on the low or high face across d of cell i of row (j, k), or to -1. The size of `found`
  /// is the number of cells.
  void find_bodies_beside(int d, bool high, int j, int k, std::vector<int> *found) const;
  /// Returns all cut faces of component a, including ghost rows.
  const std::vector<Cut> &cuts(int a) const { return components_[a].cuts; }
  /// Returns component a of the velocity of a body at a face, for given factors of its motion.
  double velocity(int a, const RigidBody &body, const Real3 &place, const Real3 &spacing, double of_velocity,
                  double of_rotation) const;
  /// Returns the vector from the centre of a body to a position.
  static Real3 arm(const RigidBody &body, const Real3 &place, const Real3 &spacing);

  double shortest_period() const;  ///< of all oscillations; infinite if there is none

  struct Component {
    std::vector<Cut> cuts;
    std::vector<Run> runs;
    std::vector<std::size_t> first_cut, first_run;  ///< for every row, and the end
    std::vector<char> all;
  };
  void set(const Int3 &layers, int rows, std::array<Component, 3> components);
  std::size_t bytes() const;

private:
  Int3 layers_{};
  int rows_ = 0;
  std::array<Component, 3> components_;
};

/// Returns the position of face i of component a in row (j, k), in cells from the middle of the box.
inline Real3 face_position(const Box &box, int a, int i, int j, int k) {
  const Int3 &begin = box.layout().begin, local{i, j, k};
  Real3 place{};
  for (int d = 0; d < box.dimension(); ++d)
    place[d] = begin[d] + local[d] + (d == a ? 0 : 0.5) - 0.5 * box.domain_cells()[d];
  return place;
}

}  // namespace eulastic
