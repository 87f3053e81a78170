// Elastic membranes: their deformation B_s, which lives in a few cells around the surface of a body, and their force on
// the flow; docs/method.md, section 18.
#pragma once

#include "field/work_space.hpp"
#include "physics/elastic_force.hpp"
#include "physics/surface_cells.hpp"
#include "physics/surface_tension.hpp"
#include "physics/transport.hpp"

namespace eulastic {

/// Nothing inside evolves; faces feel stress as far around the body as phi is smoothed, and one more.
inline constexpr EvolveRule around_membranes{1e300, 1e300, 1e-30, 0, 4};

class MembraneTransport {
public:
  /// Ghosts of the velocity that `advance` reads.
  static constexpr int velocity_ghosts = 4;
  /// Of the work space, during each call.
  static constexpr int work_fields(int dimension) { return 1 + (dimension == 2 ? 3 : 6); }

  MembraneTransport(const Grid &grid, GhostExchange &exchange, WorkSpace &work)
      : grid_(&grid), work_(&work), surface_(grid, exchange) {}
  static bool exists(const std::vector<Phase> &phases);

  /// B_s of an undeformed membrane, or one stretched alike in all directions. Five ghosts of phi, here and below.
  PetscErrorCode start(Phase *phase);
  /// Fills layers and ghosts from the cells where B_s evolves.
  PetscErrorCode extend(Phase *phase);
  /// B_s over dt with the flow; phi has moved. Leaves layers and ghosts filled.
  PetscErrorCode advance(double dt, const FieldBlock &velocity, Phase *phase);
  /// force += scale div(delta tau) at owned faces; with a factor also to `slope`.
  PetscErrorCode add_force(const std::vector<Phase> &phases, double scale, FieldBlock &force,
                           const ForceSlope &slope = {});
  /// Adds energy and power.
  PetscErrorCode measure(const std::vector<Phase> &phases, const FieldBlock &velocity, SurfaceEnergy *measured);

private:
  /// delta tau at centres into `stress`, psi into `smooth`.
  PetscErrorCode find_stress(const Phase &phase, WorkSpace::Lease *smooth, WorkSpace::Lease *stress);
  template <int Dim>
  void stage(double dt, const FieldBlock &velocity, bool second, FieldBlock &tensor, FieldBlock &next) const;

  const Grid *grid_;
  WorkSpace *work_;
  SurfaceCells surface_;  ///< of the phase that is worked on
};

}  // namespace eulastic
