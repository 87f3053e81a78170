// Layout of the fields of a variable viscosity, and access to the viscosity on edges.
#pragma once

#include "field/field.hpp"
#include "grid/box.hpp"

namespace eulastic {

/// Component indices of kinematic viscosities in a field: at centres, then on edges normal to two directions (2-D: xy;
/// 3-D: yz, xz, xy), then at centres the excess for strain along a surface, (29a), and the unit normal of the surface.
inline constexpr int viscosity_of_edge(int dimension, int a, int b) { return dimension == 2 ? 1 : 4 - a - b; }
inline constexpr int viscosity_along_surface(int dimension) { return dimension == 2 ? 2 : 4; }
inline constexpr int viscosity_fields(int dimension) { return viscosity_along_surface(dimension) + 1 + dimension; }

/// Dynamic viscosity on edges: uniform, or variable where bodies have viscosities of their own.
struct EdgeViscosity {
  const Box &box;
  double uniform;  ///< dynamic
  double density;
  const Field *local;  ///< kinematic, from compute_viscosity(); null: uniform

  /// Returns the dynamic viscosity on the low edge of a cell that is normal to the plane ab.
  double at(int a, int b, const Int3 &cell) const {
    if (!local) return uniform;
    return density * (*local)[viscosity_of_edge(box.dimension(), a, b)](cell[0], cell[1], cell[2]);
  }
  double at_centre(const Int3 &cell) const {
    return local ? density * (*local)[0](cell[0], cell[1], cell[2]) : uniform;
  }
};

}  // namespace eulastic
