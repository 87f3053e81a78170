// Sides that volume crosses: what comes in through an inflow side, and the pressure on open ones (docs/method.md,
// section 20). All that other rooms need of them beyond the ghosts of sides.hpp.
#pragma once

#include "field/sides.hpp"

namespace eulastic {

/// Velocity component d on an inflow side of direction d at `time`, ghosts of the other directions included.
void set_inflow_faces(const Box &box, const BoxSides &sides, double time, View component, int d);
/// The same on the points of one row that lie on one side: `given` times the profile, into the box.
void set_inflow_row(const Box &box, const Side &side, int d, bool high, double given, Segment row, View component);

/// The profile of a side at a local cell of its plane, ghosts too.
double inflow_shape(const Box &box, const Side &side, int d, const Int3 &local);

/// One ghost layer, or `width`, of what is proportional to a pressure that is 0 on open sides: odd there, even behind
/// others.
void fill_ghosts_of_increment(const Box &box, View field, int width);
/// One ghost layer of the pressure behind open sides, so that its mean with the one before the side is what is given at
/// `time`. `velocity`: on the sides, for what flows back in through an outflow side.
void fill_ghosts_of_given_pressure(const Box &box, const BoxSides &sides, double time, double density,
                                   const Field &velocity, View pressure);
/// 0 in `width` ghost layers behind open sides.
void clear_open_ghosts(const Box &box, View field, int width);

/// Whether volume crosses any side, and whether the pressure is given on any.
bool volume_crosses(const BoxSides &sides);
bool opens(const BoxSides &sides);
/// Whether a stretch of the domain feeds any side with its flow and its bodies (openings/feeders.hpp).
bool has_feeders(const BoxSides &sides);

/// The largest difference of given pressures along each direction per length and density: what it does to a fluid at
/// rest, a force per mass.
Real3 pressure_drive(const BoxSides &sides, const Real3 &length, double density);
/// The largest velocity given on any inflow side along each direction.
Real3 inflow_speed(const BoxSides &sides);

}  // namespace eulastic
