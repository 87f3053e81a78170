// Boundary conditions at the six faces of the box, and the ghosts behind them.
//
// Solid fraction and all fields at centres are reflected evenly. The normal velocity is 0 on a wall or a plane of
// symmetry and reflected oddly; on an inflow boundary it is given and reflected oddly about that value; on open
// boundaries (pressure and outflow) it is an unknown, and the whole velocity is reflected evenly (for the pressure see
// open_sides.hpp). Behind a wall the tangential velocity is reflected oddly about the velocity of the wall; tensor
// components on the wall itself (edges) are evolved there and reflected evenly. A plane of symmetry has the mirror
// image behind it: the tangential velocity is reflected evenly, tensor components on the plane are 0 and reflected
// oddly.
#pragma once

#include "field/field.hpp"
#include "field/time_course.hpp"
#include "grid/occupied_rows.hpp"

#include <memory>

namespace eulastic {

/// Velocity U cos(frequency t + phase) of one wall. Its normal component must be 0.
struct WallMotion {
  Real3 velocity{};      ///< length / time
  double frequency = 0;  ///< angular, 1 / time
  double phase = 0;      ///< rad
  Real3 at(double time) const;
  double speed() const;  ///< |U|
};

/// The kind of a boundary condition.
enum class BoundaryKind : unsigned char { wall, symmetry, inflow, pressure, outflow };
/// Whether the pressure is given, so that fluid may cross the boundary in either direction.
constexpr bool is_open(BoundaryKind kind) { return kind == BoundaryKind::pressure || kind == BoundaryKind::outflow; }
/// Whether bodies end at the boundary: phi behind it is 0, and bodies do not leave through it.
constexpr bool is_solid(BoundaryKind kind) { return kind == BoundaryKind::wall || kind == BoundaryKind::inflow; }
constexpr bool fluid_crosses(BoundaryKind kind) { return is_open(kind) || kind == BoundaryKind::inflow; }

/// Shape of the velocity on an inflow boundary, for all its cells, x before y before z; empty: 1 everywhere.
using InflowProfile = std::vector<double>;

class InletVelocity;

/// A load behind a pressure boundary: p = given + resistance Q + p_c, capacity dp_c/dt = Q - p_c/drain, with the flow
/// rate Q out of the box.
struct OutletLoad {
  double resistance = 0, capacity = 0, drain = 0;
  double charge = 0;  ///< p_c at t = 0
  bool exists() const { return resistance > 0 || capacity > 0; }
};

/// The boundary condition on one face of the box.
struct BoundaryCondition {
  BoundaryKind kind = BoundaryKind::wall;
  WallMotion motion;                             ///< velocity of a wall
  TimeCourse given;                              ///< inflow: factor of the profile; pressure: the pressure
  std::shared_ptr<const InflowProfile> profile;  ///< profile of an inflow boundary
  int generator_cells = 0;  ///< length in cells of the inlet generator beside an inflow boundary; 0: none
  std::shared_ptr<const InletVelocity>
      fed;          ///< last velocity of the inlet generator, which replaces given times profile
  OutletLoad load;  ///< load behind a pressure boundary
};

/// [direction][low, high]; not used in periodic directions.
using BoundaryConditions = std::array<std::array<BoundaryCondition, 2>, 3>;
/// Returns the largest speed of any wall.
double wall_speed(const BoundaryConditions &sides);

/// Sets velocity component d, or a part of it, to 0 on the boundaries of direction d that are not open, including faces
/// on the boundary of a neighbour that are ghosts of this rank.
void close_wall_faces(const Box &box, View component, int d);
/// Fills `width` layers of velocity ghosts behind every boundary that this rank touches, and sets the faces on closed
/// boundaries to 0 or to the inflow. Ghosts from other ranks must be valid. `velocity` holds u, v (, w).
void fill_wall_ghosts_velocity(const Box &box, const BoundaryConditions &sides, double time, Field &velocity,
                               int width);
/// Fills `width` ghost layers of a field of the given staggering by even reflection, also behind boundaries of a
/// neighbour where ghosts reach beyond them. Rows that `rows` marks as idle before the boundary are skipped.
void fill_wall_ghosts_even(const Box &box, const Staggering &staggering, View field, int width,
                           const OccupiedRows *rows = nullptr);
/// Sets ghosts at centres behind solid boundaries to 0, for fractions of bodies that end there. Ghosts behind other
/// boundaries do not change.
void clear_solid_ghosts(const Box &box, const BoundaryConditions &sides, View field, int width,
                        const OccupiedRows *rows = nullptr);
/// Fills ghosts of all components of a left Cauchy-Green tensor.
void fill_wall_ghosts_tensor(const Box &box, const BoundaryConditions &sides, Field &tensor, int width,
                             const OccupiedRows *rows = nullptr);
/// Fills ghosts of a tensor with all components at centres by the mirror image.
void fill_wall_ghosts_centred_tensor(const Box &box, Field &tensor, int width, const OccupiedRows *rows);
/// Sets components of a left Cauchy-Green tensor on planes of symmetry to 0, including ghosts of the other directions.
void clear_symmetry_planes(const Box &box, const BoundaryConditions &sides, Field &tensor);

}  // namespace eulastic
