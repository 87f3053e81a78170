// The elastic membranes of one phase, on the grid or in a box of their own: their deformation B_s, which lives in a few
// cells around the surface of a body, and their force on the flow; docs/method.md, section 18.
#pragma once

#include "base/exact_sum.hpp"
#include "base/petsc.hpp"
#include "field/phase.hpp"
#include "field/surface_marker.hpp"
#include "membranes/bending.hpp"
#include "membranes/surface_cells.hpp"
#include "membranes/surface_markers.hpp"
#include "membranes/wall_film.hpp"

#include <functional>

namespace eulastic {

class MembraneMechanics {
public:
  /// Ghosts of the velocity that move() reads.
  static constexpr int velocity_ghosts = SurfaceMarkers::velocity_ghosts;
  /// Scratch fields.
  static constexpr int work_fields = SurfaceCells::work_fields + 6;
  /// How many cells away from its phi a phase exerts forces, and what these are found from lies.
  static constexpr int reach = around_membranes.reach;

  /// What `place` points to must outlive this.
  explicit MembraneMechanics(const PhasePlace &place) : place_(place), surface_(place), bending_(place) {}

  /// Finds the surface of a phase, five ghosts of phi. All that follows is of that phase and uses `work`, work_fields
  /// fields, until the next find(). Collective on the grid, as all of these.
  PetscErrorCode find(const Phase &phase, Field &work);
  const SurfaceCells &surface() const { return surface_; }
  /// As SurfaceCells leaves them.
  const Field &surface_fields() const { return surface_fields_; }
  /// B_s from B = F F^T of the bodies, given in cells with phi > 0 (1: undeformed), times initial_area_stretch.
  PetscErrorCode start(Phase *phase);
  /// Fills layers and ghosts from the cells where B_s evolves.
  PetscErrorCode extend(Phase *phase) { return surface_.extend(*phase, phase->tensor.field); }
  /// B_s over dt with the flow; phi has moved. Leaves layers and ghosts filled. Adds to `unresolved` the cells of this
  /// rank in which the area would have fallen below half of that at the start: strain is lost there. `strains`: what
  /// markers tell.
  PetscErrorCode move(double dt, const Field &velocity, const std::vector<SurfaceMarkers::Strain> &strains,
                      Phase *phase, long *unresolved);
  /// Called with the part of the rows, whether it is the force of bending, component, j, k and the force per volume on
  /// the owned faces of the row, which it may spoil.
  using ForceRow = std::function<void(int, bool, int, int, int, double *)>;
  /// Forces of the stress and of bending. `bending_energy`: per area at each cell of surface().
  PetscErrorCode for_force_rows(const Phase &phase, const ForceRow &use, std::vector<double> *bending_energy = nullptr);
  enum Sum { power, stored, sums };
  /// Adds the power that the flow gives to the phase and the energy stored in it, both over the volume of a cell, to
  /// sums of every part of the rows; `samples`: of all owned cells at surfaces, if it is not null and bodies have
  /// labels or `label` is that of the only one.
  PetscErrorCode measure(const Phase &phase, const Field &velocity, const WallFilm &film, int label,
                         std::vector<ExactSums> *sum, std::vector<SurfaceSample> *samples);

private:
  /// delta tau at centres, of the cells in surface_.
  PetscErrorCode find_stress(const Phase &phase, Field &stress);
  /// Leaves the layers to the caller.
  template <int Dim>
  PetscErrorCode heun(double dt, const Field &velocity, Phase *phase, Field &next, long *unresolved);
  void recall(const std::vector<SurfaceMarkers::Strain> &strains, const Field &velocity, double dt, Phase *phase,
              long *unresolved);
  static double least_area_squared(const Phase &phase);
  ConstView smooth() const { return surface_fields_[SurfaceCells::smoothed]; }

  PhasePlace place_;
  SurfaceCells surface_;
  MembraneBending bending_;
  Field surface_fields_, others_;  ///< parts of the work fields
};

}  // namespace eulastic
