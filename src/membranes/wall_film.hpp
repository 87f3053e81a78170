// A film of fluid between membranes and walls: a short-range pressure acts on the part of a body that enters the cells
// beside a wall; docs/method.md, section 18, "Walls", (27b).
#pragma once

#include "base/exact_sum.hpp"
#include "field/boundaries.hpp"
#include "field/phase.hpp"

namespace eulastic {

class WallFilm {
public:
  static constexpr int work_fields = 2;  ///< components of `scratch` in find()

  /// Finds the cells and faces of a block beside walls: solid boundaries of the domain and rigid bodies that do not
  /// travel, whose solid fractions are `rigid`, with three ghosts. `scratch`: work_fields components.
  void find(const Box &box, const BoundaryConditions &sides, const std::vector<ConstView> &rigid, Field &scratch);
  /// Adds the force of the walls on the bodies of a membrane's phase. Reads one ghost of phi.
  void add_force(const Phase &phase, Field &force) const;
  /// Adds minus the power of the force, divided by the cell volume, to sum `which`.
  void add_power(const Phase &phase, const Field &velocity, int which, ExactSums *sums) const;
  /// Adds the energy stored in the film, divided by the cell volume, to sum `which`.
  void add_energy(const Phase &phase, int which, ExactSums *sums) const;

private:
  struct Face {
    int component;
    std::ptrdiff_t at, near, far;  ///< offsets of the face, of the cell nearer to the wall, and of the other cell
    double towards;                ///< difference of chi along the component, 1/length
  };
  struct Cell {
    std::ptrdiff_t at;
    double nearness;
  };
  static double force_on(const Face &face, double pressure, const double *phi);
  double pressure_of(const Phase &phase) const;

  double longest_spacing_ = 0;
  std::vector<Face> faces_;  ///< owned
  std::vector<Cell> cells_;  ///< owned
};

}  // namespace eulastic
