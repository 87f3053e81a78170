// Membranes in phases of the grid (membranes/membrane.hpp), all of them together.
#pragma once

#include "base/petsc.hpp"
#include "field/net_force.hpp"
#include "field/work_space.hpp"
#include "grid/domain.hpp"
#include "membranes/membrane.hpp"
#include "solids/elastic_force.hpp"

namespace eulastic {

class MembraneTransport {
public:
  /// Ghosts of the velocity that `advance` reads.
  static constexpr int velocity_ghosts = MembraneMechanics::velocity_ghosts;
  /// Of the work space, during each call.
  static constexpr int work_fields = MembraneMechanics::work_fields;

  /// `sides`: of the box, which must outlive this; `drifts`: as of SurfaceTension, for bending.
  MembraneTransport(const Domain &domain, GhostExchange &exchange, WorkSpace &work, const BoxSides &sides, bool drifts)
      : domain_(&domain),
        work_(&work),
        exchange_(&exchange),
        sides_(&sides),
        membrane_({&domain, &sides, &exchange}),
        markers_(domain),
        drifts_(drifts),
        force_(domain, domain.dimension()) {}
  /// Whether the grid has any.
  static bool exists(const std::vector<Phase> &phases);
  static bool marks(const std::vector<Phase> &phases);  ///< whether any of those has markers
  std::size_t bytes() const { return force_.bytes(); }

  /// Where walls are: solid sides of the box, and `rigid` bodies, which do not travel; before any force.
  PetscErrorCode find_walls(const std::vector<const Phase *> &rigid);
  /// MembraneMechanics::start().
  PetscErrorCode start(Phase *phase);
  /// Markers for the body `label` of a phase, 0: for all, which keep the strain that it has; `number`: of the phase.
  /// Collective.
  PetscErrorCode place_markers(const Phase &phase, int number, int label, std::vector<SurfaceMarker> *markers);
  /// Each to the phase that its body is in now; those of bodies that are gone away.
  PetscErrorCode follow(std::vector<Phase> *phases, std::vector<SurfaceMarker> *markers);
  /// MembraneMechanics::extend().
  PetscErrorCode extend(Phase *phase);
  /// What a state has beside its phases, and what advance() finds of it.
  struct Memory {
    std::vector<SurfaceMarker> *markers;
    long unresolved = 0;  ///< MembraneMechanics::move(), of all ranks
  };
  /// B_s of all membranes over dt with the flow; their phi has moved. Leaves layers and ghosts filled. `memory`: that
  /// of the state whose force add_force() adds; null: copies of its phases, without markers. Collective.
  PetscErrorCode advance(double dt, const Field &velocity, Memory *memory, std::vector<Phase> *phases);
  /// force += scale (div(delta tau) and the force of bending) at owned faces; with a factor also to `slope`. Of
  /// advance(), or found anew if a phase has been set since. `balanced`: as of SurfaceTension, for bending; the
  /// divergence of a stress adds up to nothing.
  PetscErrorCode add_force(const std::vector<Phase> &phases, double scale, bool balanced, Field &force,
                           const WeightedTarget &slope = {});
  /// Adds energies and power; `samples`: of all owned cells at surfaces, where bodies have labels.
  PetscErrorCode measure(const std::vector<Phase> &phases, const Field &velocity, SurfaceEnergy *measured,
                         std::vector<SurfaceSample> *samples = nullptr);

private:
  /// `work`: the memory that membrane_ uses.
  PetscErrorCode find(const Phase &phase, WorkSpace::Lease *work);
  void begin_force();
  PetscErrorCode gather_force(const Phase &phase, NetForce *net);
  PetscErrorCode end_force(NetForce *net);
  bool drives_all(const std::vector<Phase> &phases) const;

  const Domain *domain_;
  WorkSpace *work_;
  GhostExchange *exchange_;
  const BoxSides *sides_;
  MembraneMechanics membrane_;  ///< of the phase that is worked on
  SurfaceMarkers markers_;
  WallFilm film_;
  bool drifts_;
  Field force_;        ///< at faces, if it is known
  Real3 net_force_{};  ///< its mean, where that would drive all of the fluid
  bool force_known_ = false;
};

}  // namespace eulastic
