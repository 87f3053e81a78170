// What happens at the faces of the box, and the ghosts behind them.
//
// Solid fraction and everything centred reflect evenly. Normal velocity is 0 on a wall or a plane of symmetry and
// reflects oddly; it is given on an inflow side and reflects oddly about that; on open sides (pressure and outflow) it
// is an unknown, and all of the velocity reflects evenly. The pressure is open_sides.hpp's there. Wall: the tangential
// velocity reflects oddly about the wall's; tensor components that live on the wall itself (edges) are evolved there
// and reflect evenly about it. Symmetry: what is behind is the mirror image, so the tangential velocity reflects
// evenly, and tensor components on the plane are 0 and reflect oddly.
#pragma once

#include "field/field.hpp"
#include "field/time_course.hpp"
#include "grid/occupied_rows.hpp"

#include <memory>

namespace eulastic {

/// Velocity U cos(frequency t + phase) of one wall; its normal component must be 0.
struct WallMotion {
  Real3 velocity{};      ///< length / time
  double frequency = 0;  ///< angular, 1 / time
  double phase = 0;      ///< rad
  Real3 at(double time) const;
  double speed() const;  ///< largest |U|
};

enum class SideKind : unsigned char { wall, symmetry, inflow, pressure, outflow };
/// Whether the pressure is given there, so that volume may cross it either way.
constexpr bool is_open(SideKind kind) { return kind == SideKind::pressure || kind == SideKind::outflow; }
/// Whether it ends the fluid for bodies: nothing of them is behind it, and they do not come out.
constexpr bool is_solid(SideKind kind) { return kind == SideKind::wall || kind == SideKind::inflow; }
constexpr bool volume_crosses(SideKind kind) { return is_open(kind) || kind == SideKind::inflow; }

/// Shape of the velocity on an inflow side, over all its cells, x before y before z; empty: 1 everywhere.
using SideProfile = std::vector<double>;

class FedVelocity;

/// What is behind a pressure side: p = given + resistance Q + p_c, capacity dp_c/dt = Q - p_c/drain, Q what leaves.
struct OutletLoad {
  double resistance = 0, capacity = 0, drain = 0;
  double charge = 0;  ///< pressure of the capacity at t = 0
  bool exists() const { return resistance > 0 || capacity > 0; }
};

struct Side {
  SideKind kind = SideKind::wall;
  WallMotion motion;                           ///< of a wall
  TimeCourse given;                            ///< inflow: what the profile is multiplied by; pressure: the pressure
  std::shared_ptr<const SideProfile> profile;  ///< of an inflow side
  int feeder = 0;                              ///< cells of the stretch beside an inflow side that feeds it; 0: none
  std::shared_ptr<const FedVelocity> fed;      ///< what it gave last, in place of given times profile
  OutletLoad load;                             ///< of a pressure side
};

/// [direction][low, high]; without meaning in periodic directions.
using BoxSides = std::array<std::array<Side, 2>, 3>;
/// The largest speed of any wall.
double wall_speed(const BoxSides &sides);

/// No flow through the sides of direction d: 0 on their faces, of the velocity component d or a part of it; also on the
/// face of a neighbour whose three cells are this rank's ghosts.
void close_wall_faces(const Box &box, View component, int d);
/// Fills `width` layers behind every side this rank touches; ghosts from the exchange must be there already.
/// Velocity: `velocity` holds u, v (, w); faces on sides are set to 0.
void fill_wall_ghosts_velocity(const Box &box, const BoxSides &sides, double time, Field &velocity, int width);
/// Even reflection of one field of the given staggering, also behind a neighbour's side where ghosts reach beyond it;
/// not where `rows`, if it is given, is idle before the side.
void fill_wall_ghosts_even(const Box &box, const Staggering &staggering, View field, int width,
                           const OccupiedRows *rows = nullptr);
/// Behind solid sides 0, at centres: for fractions of bodies that end there. Other sides are left as they are.
void clear_solid_ghosts(const Box &box, const BoxSides &sides, View field, int width,
                        const OccupiedRows *rows = nullptr);
/// All components of a left Cauchy-Green field.
void fill_wall_ghosts_tensor(const Box &box, const BoxSides &sides, Field &tensor, int width,
                             const OccupiedRows *rows = nullptr);
/// The same where all components live at centres: the mirror image.
void fill_wall_ghosts_centred_tensor(const Box &box, Field &tensor, int width, const OccupiedRows *rows);
/// Components of a left Cauchy-Green field on planes of symmetry: 0, ghosts of the other directions included.
void clear_symmetry_planes(const Box &box, const BoxSides &sides, Field &tensor);

}  // namespace eulastic
