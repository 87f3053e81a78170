// Wall motion, and the ghosts behind walls.
//
// A wall face has normal velocity 0 and the wall's tangential velocity. Pressure, solid fraction and everything
// centred reflect evenly; the tangential velocity reflects oddly about the wall's; tensor components that live on
// the wall itself (edges) are evolved there and reflect evenly about it.
#pragma once

#include "field/field_block.hpp"
#include "grid/occupied_rows.hpp"

namespace eulastic {

/// Velocity U cos(frequency t + phase) of one wall; its normal component must be 0.
struct WallMotion {
  Real3 velocity{};      ///< length / time
  double frequency = 0;  ///< angular, 1 / time
  double phase = 0;      ///< rad
  Real3 at(double time) const;
  double speed() const;  ///< largest |U|
};

struct Walls {
  std::array<std::array<WallMotion, 2>, 3> motion;  ///< [direction][low, high]
};

/// In which directions a field sits on the low side of its cell.
using Staggering = std::array<bool, 3>;
inline constexpr Staggering at_centre{false, false, false};
inline constexpr std::array<Staggering, 3> at_face{{{true, false, false}, {false, true, false}, {false, false, true}}};

/// Components of the left Cauchy-Green tensor in the order of their block: xx, yy, xy in 2-D (zz stays 1) and
/// xx, yy, zz, yz, xz, xy in 3-D.
struct TensorComponent {
  int a, b;
  Staggering staggering() const {
    Staggering s{};
    if (a != b) s[a] = s[b] = true;
    return s;
  }
};
const std::vector<TensorComponent> &tensor_components(int dimension);
/// I everywhere.
FieldBlock tensor_at_rest(const Grid &grid);

/// No flow through the walls of direction d: 0 on their faces, of the velocity component d or a part of it; also on the
/// face of a neighbour whose three cells are this rank's ghosts.
void close_wall_faces(const Grid &grid, View component, int d);
/// Fills `width` layers behind every wall this rank touches; ghosts from the exchange must be there already.
/// Velocity: `velocity` holds u, v (, w); wall faces are set to 0.
void fill_wall_ghosts_velocity(const Grid &grid, const Walls &walls, double time, FieldBlock &velocity, int width);
/// Even reflection of one field of the given staggering, also behind a neighbour's wall where ghosts reach beyond it;
/// not where `rows`, if it is given, is idle before the wall.
void fill_wall_ghosts_even(const Grid &grid, const Staggering &staggering, View field, int width,
                           const OccupiedRows *rows = nullptr);
/// All components of a left Cauchy-Green block.
void fill_wall_ghosts_tensor(const Grid &grid, FieldBlock &tensor, int width, const OccupiedRows *rows = nullptr);

}  // namespace eulastic
