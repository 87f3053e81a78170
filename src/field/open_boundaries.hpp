// Boundaries that fluid crosses: the velocity on inflow boundaries and the pressure on open ones (docs/method.md,
// section 20), except for the velocity ghosts, which sides.hpp fills.
#pragma once

#include "field/boundaries.hpp"

namespace eulastic {

/// Sets velocity component d on the inflow boundaries of direction d at `time`, including ghosts of the other
/// directions.
void set_inflow_faces(const Box &box, const BoundaryConditions &sides, double time, View component, int d);
/// Sets the points of one row that lie on one boundary to `given` times the profile, directed into the box.
void set_inflow_row(const Box &box, const BoundaryCondition &side, int d, bool high, double given, Segment row,
                    View component);

/// Returns the profile of a boundary at a local cell of its plane, which may be a ghost.
double inflow_shape(const Box &box, const BoundaryCondition &side, int d, const Int3 &local);

/// Fills `width` ghost layers of a pressure increment, which is 0 on open boundaries: odd reflection there, even
/// reflection behind other boundaries.
void fill_ghosts_of_increment(const Box &box, View field, int width);
/// Fills one ghost layer of the pressure behind open boundaries, so that its mean with the pressure in the cell before
/// the boundary is the given pressure at `time`. `velocity` must be valid on the boundaries; it determines the pressure
/// of backflow through outflow boundaries.
void fill_ghosts_of_given_pressure(const Box &box, const BoundaryConditions &sides, double time, double density,
                                   const Field &velocity, View pressure);
/// Sets `width` ghost layers behind open boundaries to 0.
void clear_open_ghosts(const Box &box, View field, int width);

/// Whether fluid crosses any boundary.
bool fluid_crosses(const BoundaryConditions &sides);
/// Whether the pressure is given on any boundary.
bool has_open_boundary(const BoundaryConditions &sides);
/// Whether any boundary has an inlet generator (openings/inlet_generators.hpp).
bool has_inlet_generators(const BoundaryConditions &sides);

/// Returns the largest difference of given pressures along each direction, divided by length and density: the force per
/// mass on a fluid at rest.
Real3 pressure_drive(const BoundaryConditions &sides, const Real3 &length, double density);
/// Returns the largest velocity given on any inflow boundary along each direction.
Real3 inflow_speed(const BoundaryConditions &sides);

}  // namespace eulastic
