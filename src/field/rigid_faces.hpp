// Where rigid bodies are among the faces of the velocity: faces inside, whose velocity is given, and cut ones, fluid
// faces with a neighbour inside, which see the surface instead of it (docs/method.md, section 19). PETSc-free.
#pragma once

#include "grid/box.hpp"

#include <array>
#include <cmath>
#include <vector>

namespace eulastic {

/// cos(frequency t + phase).
struct Oscillation {
  double frequency = 0;  ///< angular, 1 / time
  double phase = 0;      ///< rad
  double at(double time) const { return frequency == 0 && phase == 0 ? 1.0 : std::cos(frequency * time + phase); }
  double integral(double time) const {  ///< from 0
    if (frequency == 0) return std::cos(phase) * time;
    return (std::sin(frequency * time + phase) - std::sin(phase)) / frequency;
  }
  double rate(double time) const { return -frequency * std::sin(frequency * time + phase); }
};

/// How the surface of a body moves: velocity V cos(..) + angular velocity W cos(..) x (x - centre). Along `travelling`
/// directions the body goes with V, along others it slides along itself; `turning`: it turns with W, else its shape
/// turns into itself, as spheres do, and cylinders and tubes about their axis.
struct RigidMotion {
  Real3 velocity{};          ///< length / time
  Real3 angular_velocity{};  ///< rad / time
  Oscillation of_velocity, of_rotation;
  std::array<bool, 3> travelling{};
  bool turning = false;
  bool moves() const { return velocity != Real3{} || angular_velocity != Real3{}; }
  /// Whether the body covers other places as time goes on.
  bool travels() const { return turning || travelling != std::array<bool, 3>{}; }
  /// How far the body is from where it was at time 0.
  Real3 shift(double time) const {
    Real3 way{};
    for (int d = 0; d < 3; ++d) way[d] = travelling[d] ? velocity[d] * of_velocity.integral(time) : 0;
    return way;
  }
  /// How far it has turned since time 0: about this direction, by its length in rad.
  Real3 angle(double time) const { return turned_by(of_rotation.integral(time)); }
  /// Velocity and acceleration of what travels, at r from the centre.
  Real3 frame_velocity(const Real3 &r, double time) const;
  Real3 acceleration(const Real3 &r, double time) const;
  /// The angular velocity, or its rate of change, of a body that turns: 0 of others.
  Real3 turned_by(double factor) const {
    Real3 w{};
    for (int d = 0; d < 3; ++d) w[d] = turning ? angular_velocity[d] * factor : 0;
    return w;
  }
};

/// Of a body that moves, at the density 1, about its centre; in 2-D per depth. Moments only of what turns.
struct RigidMass {
  double volume = 0;
  Real3 first{};                   ///< integral of r
  std::array<double, 6> second{};  ///< of r r^T: xx, yy, zz, yz, xz, xy
  /// What viscosity 1 takes of it, in orders of magnitude, at the largest velocities of its motion: as a sphere of its
  /// volume in Stokes flow, in 2-D a cylinder.
  double dissipation(const RigidMotion &motion, int dimension) const;
  /// What its own acceleration takes, at a density.
  Real3 force(const RigidMotion &motion, double time, double density) const;
  Real3 torque(const RigidMotion &motion, double time, double density) const;
};

/// What a body that rests has more volume than the faces inside it, each with a cell's worth: of every component, and
/// the same times the arm from its centre.
struct RigidGap {
  Real3 volume{};
  std::array<Real3, 3> first{};
};

/// Likewise on a side of the box, of a body in an owned cell beside it: in parts of the cell's face.
struct RigidFootprint {
  Int3 cell{};
  int direction = 0;
  bool high = false;
  int body = 0;  ///< index in RigidFaces::bodies
  double more = 0;
};

/// A body, or one of its images across periodic sides.
struct RigidBody {
  int index = 0;   ///< among all rigid bodies
  int motion = 0;  ///< index in RigidFaces::motions
  Real3 centre{};  ///< from the middle of the box, in cells
};

class RigidFaces {
public:
  /// A fluid face with neighbours inside. Links are low, high along x, then y, z.
  struct Cut {
    int i = 0;
    int body = 0;        ///< whose surface it sees, index in bodies
    unsigned walls = 0;  ///< bits of the links that end at the surface
    double share = 1;    ///< of the rate, which keeps the stages of the viscous step stable: method.md
    double open = 1;     ///< of the pressure increment's gradient: share, but not too little
    double link[6]{};    ///< 1 / (length of the link times the spacing)
    double turn[6]{};    ///< (W x (x - centre)) of the component, where a link meets the surface
    double laplacian(const double *u, const std::array<std::ptrdiff_t, 3> &stride, int dimension,
                     const double *wall) const;
  };
  /// Faces begin <= i < end are inside a body.
  struct Run {
    int begin, end, body;
  };
  struct Row {
    const Cut *cuts = nullptr, *cuts_end = nullptr;
    const Run *runs = nullptr, *runs_end = nullptr;
    bool all = false;  ///< inside, the ghosts of the row too
    bool empty() const { return cuts == cuts_end && runs == runs_end; }
  };

  std::vector<RigidMotion> motions;
  std::vector<RigidBody> bodies;
  std::vector<RigidMass> masses;           ///< by the index of the body
  std::vector<RigidGap> gaps;              ///< likewise; 0 of those that travel
  std::vector<RigidFootprint> footprints;  ///< where `more` is not 0
  std::vector<Real3> ahead;  ///< of every motion: from the time of the surfaces to that of the faces, in cells
  int count = 0;             ///< of bodies, images not counted
  bool moves = false, travels = false;
  Real3 speed{};  ///< largest of any surface, along every direction

  const RigidMotion &motion_of(int index) const { return motions[bodies[bodies.size() / count * index].motion]; }
  /// Rows of component a; j and k within `layers` of ghosts.
  Row row(int a, int j, int k) const {
    const Component &c = components_[a];
    const std::size_t at = (j + layers_[1]) + std::size_t(rows_) * (k + layers_[2]);
    return {c.cuts.data() + c.first_cut[at], c.cuts.data() + c.first_cut[at + 1], c.runs.data() + c.first_run[at],
            c.runs.data() + c.first_run[at + 1], c.all[at] != 0};
  }
  /// Of the first cells of row (j, k), as many as `found` has: the body on their low or high face across d, or -1.
  void find_beside(int d, bool high, int j, int k, std::vector<int> *found) const;
  /// All cut faces of component a, those of ghost rows too.
  const std::vector<Cut> &cuts(int a) const { return components_[a].cuts; }
  /// Component a of the velocity of a body at a face, at the times of the factors of its motion.
  double velocity(int a, const RigidBody &body, const Real3 &place, const Real3 &spacing, double of_velocity,
                  double of_rotation) const;
  /// From the centre of a body to a place.
  static Real3 arm(const RigidBody &body, const Real3 &place, const Real3 &spacing);

  double shortest_period() const;  ///< of what moves; infinite if nothing oscillates

  struct Component {
    std::vector<Cut> cuts;
    std::vector<Run> runs;
    std::vector<std::size_t> first_cut, first_run;  ///< of every row, and the end
    std::vector<char> all;
  };
  void set(const Int3 &layers, int rows, std::array<Component, 3> components);
  std::size_t bytes() const;

private:
  Int3 layers_{};
  int rows_ = 0;
  std::array<Component, 3> components_;
};

/// Of face i of component a in row (j, k): its place in cells from the middle of the box.
inline Real3 place_of_face(const Box &box, int a, int i, int j, int k) {
  const Int3 &begin = box.layout().begin, local{i, j, k};
  Real3 place{};
  for (int d = 0; d < box.dimension(); ++d)
    place[d] = begin[d] + local[d] + (d == a ? 0 : 0.5) - 0.5 * box.domain_cells()[d];
  return place;
}

}  // namespace eulastic
