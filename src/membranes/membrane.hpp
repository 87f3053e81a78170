// Elastic membranes of one phase, on the grid or in a box of its own: their deformation B_s in a few cells around the
// surface of a body, and their force on the flow; docs/method.md, section 18.
#pragma once

#include "base/exact_sum.hpp"
#include "base/petsc.hpp"
#include "drops/capillary_force.hpp"
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
  /// Ghost layers of the velocity that move() reads.
  static constexpr int velocity_ghosts = SurfaceMarkers::velocity_ghosts;
  /// Number of fields in `work`.
  static constexpr int work_fields = SurfaceCells::work_fields + 6;
  /// Distance in cells from phi of a phase within which its forces act and their input is stored.
  static constexpr int reach = around_membranes.reach;

  /// The objects in `place` must outlive this.
  explicit MembraneMechanics(const PhaseDomain &place)
      : place_(place), surface_(place), bending_(place), capillary_(*place.box, place.exchange) {}

  /// Finds the surface of a phase from phi with five ghosts. All later calls refer to this phase and use `work`,
  /// work_fields components, until the next find(). Collective on the grid, like all functions below.
  PetscErrorCode find(const Phase &phase, Field &work);
  const SurfaceCells &surface() const { return surface_; }
  /// The fields as SurfaceCells::find() left them; after for_force_rows(), which uses the others, only smoothed phi.
  const Field &surface_fields() const { return surface_fields_; }
  /// Sets B_s from B = F F^T of the bodies, which is given in cells with phi > 0 (I: undeformed), and stretches its
  /// area by initial_area_stretch.
  PetscErrorCode start(Phase *phase);
  /// Fills layers and ghosts from the cells where B_s evolves.
  PetscErrorCode extend(Phase *phase) { return surface_.extend(*phase, phase->tensor.field); }
  /// Advances B_s over dt with the flow, after phi has moved, and fills layers and ghosts. `strains`: strains from
  /// markers. Adds to `unresolved` the number of cells of this rank where the area would have fallen below half of that
  /// at the start; strain is lost there.
  PetscErrorCode move(double dt, const Field &velocity, const std::vector<SurfaceMarkers::Strain> &strains,
                      Phase *phase, long *unresolved);
  /// Receives the number of the row part, component, j, k, and the force per volume on the owned faces of the row,
  /// which it may overwrite.
  using ForceRow = std::function<void(int, int, int, int, double *)>;
  /// Calls `use` for the forces of stress and bending. `bending_energy`: energy per area at each cell of surface().
  PetscErrorCode for_force_rows(const Phase &phase, const ForceRow &use, std::vector<double> *bending_energy = nullptr);
  enum Sum { power, stored, sums };
  /// Returns samples of all owned surface cells, without labels and velocities. `bending_energy`: from
  /// for_force_rows().
  std::vector<SurfaceSample> sample(const Phase &phase, const std::vector<double> &bending_energy) const;
  /// Adds the power that the flow supplies to the phase and the stored energy, both divided by the cell volume, to the
  /// sums of each row part. Adds samples of all owned surface cells to `samples`, unless it is null, if bodies have
  /// labels.
  PetscErrorCode measure(const Phase &phase, const Field &velocity, const WallFilm &film, std::vector<ExactSums> *sum,
                         std::vector<SurfaceSample> *samples);
  static void set_velocities(const Field &velocity, std::vector<SurfaceSample> *samples);
  /// Adds the energy of these samples, divided by the volume of a cell, to the sum `stored`.
  static void add_stored_energy(const std::vector<SurfaceSample> &samples, double volume, ExactSums *sum);

private:
  template <int Dim>
  PetscErrorCode find_uniform_tension(const Phase &phase);
  /// Computes delta tau, without the uniform tension, at centres, from the cells of surface_.
  PetscErrorCode find_stress(const Phase &phase, Field &stress);
  /// Does not fill the layers of the second stage.
  template <int Dim>
  PetscErrorCode heun(double dt, const Field &velocity, Phase *phase, Field &next, long *unresolved);
  void relax_to_markers(const std::vector<SurfaceMarkers::Strain> &strains, const Field &velocity, double dt,
                        Phase *phase, long *unresolved);
  static double least_area_squared(const Phase &phase);
  ConstView smooth() const { return surface_fields_[SurfaceCells::smoothed]; }

  PhaseDomain place_;
  SurfaceCells surface_;
  MembraneBending bending_;
  /// The tension that all of the surface has, which acts like a surface tension; force per length.
  double uniform_tension_ = 0;
  CapillaryForce capillary_;
  Field surface_fields_, scratch_fields_;  ///< parts of the fields in `work`
};

}  // namespace eulastic
