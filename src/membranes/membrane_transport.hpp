// Membranes of all phases on the grid (membranes/membrane.hpp).
#pragma once

#include "base/petsc.hpp"
#include "membranes/membrane.hpp"
#include "parts/flow.hpp"
#include "parts/flow_part.hpp"
#include "solids/elastic_force.hpp"

namespace eulastic {

class MembraneTransport final : public FlowPart {
public:
  static constexpr int fields = MembraneMechanics::work_fields;  ///< components of the work space that each call uses

  explicit MembraneTransport(Flow *flow)
      : flow_(*flow),
        membrane_(flow->phase_domain()),
        markers_(flow->domain),
        force_(flow->domain, flow->domain.dimension()) {}
  PetscErrorCode start() override;
  PetscErrorCode resume() override;
  PetscErrorCode rebuild_derived_fields(Phase *phase) override;
  PetscErrorCode begin_slope(double dt, Field &slope) override;
  /// Moves B_s, after phi has moved, and fills its layers and ghosts. For the state it also moves the markers and
  /// computes the force of add_force().
  PetscErrorCode move(double dt, std::vector<Phase> *phases) override;
  PetscErrorCode add_rate(const MomentumRate &rate) override;
  PetscErrorCode update_after_labels() override;
  PetscErrorCode observe_new_body(const Phase &phase, int number, int label) override {
    return place_markers(phase, number, label);
  }
  PetscErrorCode observe_removed_bodies() override { return update_after_labels(); }
  PetscErrorCode add_surface_energy(const SynchronisedBodies &bodies, SurfaceEnergy *measured,
                                    std::vector<SurfaceSample> *samples) override;
  /// Whether any phase on the grid is a membrane.
  static bool exists(const std::vector<Phase> &phases);
  std::size_t bytes() const override { return force_.bytes(); }

  /// Sets the walls of the film: solid boundaries of the box and the `rigid` bodies, which do not travel. Call before
  /// any force.
  PetscErrorCode find_walls(const std::vector<const Phase *> &rigid);
  /// Replaces the markers of the state by new ones for all bodies, which keep the present strain. Collective.
  PetscErrorCode place_markers();
  /// Sets markers read from a file, each on any rank. Collective.
  PetscErrorCode set_markers(const std::vector<SurfaceMarker> &markers);
  /// Adds scale (div(delta tau) and the force of bending) to `force` at owned faces and, with its factor, to `slope`.
  /// The force is that of the last move(); it is computed again if a phase has been set since. `balanced`: subtracts
  /// the mean of the bending force, as SurfaceTension does; the divergence of a stress has no mean.
  PetscErrorCode add_force(const std::vector<Phase> &phases, double scale, bool balanced, Field &force,
                           const WeightedTarget &slope = {});

private:
  /// Whether any membrane on the grid has markers.
  bool has_any_markers() const;
  /// Places markers for the body `label` of phase `number` (0: for all bodies), which keep the present strain.
  PetscErrorCode place_markers(const Phase &phase, int number, int label);
  /// Finds the surface of a phase; `work` holds the memory of membrane_.
  PetscErrorCode find(const Phase &phase, WorkSpace::Lease *work);
  void clear_force();
  PetscErrorCode add_phase_force(const Phase &phase, NetForce *net);
  PetscErrorCode finish_force(NetForce *net);
  bool accelerates_all(const std::vector<Phase> &phases) const;

  Flow &flow_;
  MembraneMechanics membrane_;  ///< of the phase being processed
  SurfaceMarkers markers_;
  WallFilm film_;
  Field force_;        ///< at faces, valid if force_known_
  Real3 net_force_{};  ///< mean of the bending force, where it would accelerate all of the fluid
  bool force_known_ = false;
};

}  // namespace eulastic
