// Elastic membranes: their deformation B_s, which lives in a few cells around the surface of a body, and their force on
// the flow; docs/method.md, section 18.
#pragma once

#include "base/petsc.hpp"
#include "field/surface_sample.hpp"
#include "field/work_space.hpp"
#include "grid/domain.hpp"
#include "physics/bending.hpp"
#include "physics/elastic_force.hpp"
#include "physics/net_force.hpp"
#include "physics/surface_cells.hpp"
#include "physics/surface_markers.hpp"
#include "physics/surface_tension.hpp"
#include "physics/transport.hpp"
#include "physics/wall_film.hpp"

#include <functional>

namespace eulastic {

/// Nothing inside evolves; faces feel forces four cells around the body (bending), and one more.
inline constexpr EvolveRule around_membranes{1e300, 1e300, 1e-30, 0, 5};

class MembraneTransport {
public:
  /// Ghosts of the velocity that `advance` reads.
  static constexpr int velocity_ghosts = SurfaceMarkers::velocity_ghosts;
  /// Of the work space, during each call.
  static constexpr int work_fields = SurfaceCells::work_fields + 6;

  /// `sides`: of the box, which must outlive this; `drifts`: as of SurfaceTension, for bending.
  MembraneTransport(const Domain &domain, GhostExchange &exchange, WorkSpace &work, const BoxSides &sides, bool drifts)
      : domain_(&domain),
        work_(&work),
        exchange_(&exchange),
        sides_(&sides),
        surface_(domain, exchange, sides),
        bending_(domain, exchange),
        markers_(domain),
        film_(domain),
        drifts_(drifts),
        force_(domain, domain.dimension()) {}
  static bool exists(const std::vector<Phase> &phases);
  static bool marks(const std::vector<Phase> &phases);  ///< whether any has markers
  std::size_t bytes() const { return force_.bytes(); }

  /// Where walls are: solid sides of the box, and `rigid` bodies, which do not travel; before any force.
  PetscErrorCode find_walls(const std::vector<const Phase *> &rigid);
  /// B_s from B = F F^T of the bodies, given in cells with phi > 0 (1: undeformed), times initial_area_stretch. Five
  /// ghosts of phi, here and below.
  PetscErrorCode start(Phase *phase);
  /// Markers for the body `label` of a phase, 0: for all, which keep the strain that it has; `number`: of the phase.
  /// Collective.
  PetscErrorCode place_markers(const Phase &phase, int number, int label, std::vector<SurfaceMarker> *markers);
  /// Each to the phase that its body is in now; those of bodies that are gone away.
  PetscErrorCode follow(std::vector<Phase> *phases, std::vector<SurfaceMarker> *markers);
  /// Fills layers and ghosts from the cells where B_s evolves.
  PetscErrorCode extend(Phase *phase);
  /// What a state has beside its phases, and what advance() finds of it.
  struct Memory {
    std::vector<SurfaceMarker> *markers;
    /// Cells of all ranks in which the area would have fallen below half of that at the start: strain is lost there.
    long unresolved = 0;
  };
  /// B_s of all membranes over dt with the flow; their phi has moved. Leaves layers and ghosts filled. `memory`: that
  /// of the state whose force add_force() adds; null: copies of its phases, without markers. Collective.
  PetscErrorCode advance(double dt, const Field &velocity, Memory *memory, std::vector<Phase> *phases);
  /// force += scale (div(delta tau) and the force of bending) at owned faces; with a factor also to `slope`. Of
  /// advance(), or found anew if a phase has been set since. `balanced`: as of SurfaceTension, for bending; the
  /// divergence of a stress adds up to nothing.
  PetscErrorCode add_force(const std::vector<Phase> &phases, double scale, bool balanced, Field &force,
                           const ForceSlope &slope = {});
  /// Adds energies and power; `samples`: of all owned cells at surfaces, where bodies have labels.
  PetscErrorCode measure(const std::vector<Phase> &phases, const Field &velocity, SurfaceEnergy *measured,
                         std::vector<SurfaceSample> *samples = nullptr);

private:
  /// delta tau at centres, of the cells in surface_.
  PetscErrorCode find_stress(const Phase &phase, Field &stress);
  /// Called with the part, whether it is of bending, component, j, k and the force on the owned faces of the row, which
  /// it may spoil.
  using ForceRow = std::function<void(int, bool, int, int, int, double *)>;
  /// Of the cells in surface_. `bending_energy`: per area at each of them.
  PetscErrorCode for_force_rows(const Phase &phase, ConstView smooth, const ForceRow &use,
                                std::vector<double> *bending_energy = nullptr);
  void begin_force();
  PetscErrorCode gather_force(const Phase &phase, ConstView smooth, NetForce *net);
  PetscErrorCode end_force(NetForce *net);
  bool drives_all(const std::vector<Phase> &phases) const;
  PetscErrorCode measure_phase(const Phase &phase, const Field &velocity, SurfaceEnergy *measured,
                               std::vector<SurfaceSample> *samples);
  /// Leaves the layers to the caller.
  template <int Dim>
  PetscErrorCode heun(double dt, const Field &velocity, Phase *phase, Field &next);
  void recall(double dt, const Field &velocity, const std::vector<SurfaceMarkers::Strain> &strains, Phase *phase);
  static double least_area_squared(const Phase &phase);

  const Domain *domain_;
  WorkSpace *work_;
  GhostExchange *exchange_;
  const BoxSides *sides_;
  SurfaceCells surface_;     ///< of the phase that is worked on
  MembraneBending bending_;  ///< the same
  SurfaceMarkers markers_;
  WallFilm film_;
  bool drifts_;
  long unresolved_ = 0;
  Field force_;        ///< at faces, if it is known
  Real3 net_force_{};  ///< its mean, where that would drive all of the fluid
  bool force_known_ = false;
};

}  // namespace eulastic
