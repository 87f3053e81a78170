// Membranes in phases of the grid (membranes/membrane.hpp), all of them together.
#pragma once

#include "base/petsc.hpp"
#include "membranes/membrane.hpp"
#include "parts/flow.hpp"
#include "parts/flow_part.hpp"
#include "solids/elastic_force.hpp"

namespace eulastic {

class MembraneTransport final : public FlowPart {
public:
  static constexpr int fields = MembraneMechanics::work_fields;  ///< of the work space, during each call

  explicit MembraneTransport(Flow *flow)
      : flow_(*flow),
        membrane_(flow->place_of_phases()),
        markers_(flow->domain),
        force_(flow->domain, flow->domain.dimension()) {}
  PetscErrorCode start() override;
  PetscErrorCode resume() override;
  PetscErrorCode settle(Phase *phase) override;
  PetscErrorCode begin_slope(double dt, Field &slope) override;
  /// B_s; phi has moved. Leaves layers and ghosts filled. Of the state also the markers and the force of add_force().
  PetscErrorCode move(double dt, std::vector<Phase> *phases) override;
  PetscErrorCode add_rate(const MomentumRate &rate) override;
  PetscErrorCode follow() override;
  PetscErrorCode see_new_body(const Phase &phase, int number, int label) override {
    return place_markers(phase, number, label);
  }
  PetscErrorCode see_bodies_leave() override { return follow(); }
  PetscErrorCode add_surface_energy(const FlowLook &look, SurfaceEnergy *measured,
                                    std::vector<SurfaceSample> *samples) override;
  /// Whether the grid has any.
  static bool exists(const std::vector<Phase> &phases);
  std::size_t bytes() const override { return force_.bytes(); }

  /// Where walls are: solid sides of the box, and `rigid` bodies, which do not travel; before any force.
  PetscErrorCode find_walls(const std::vector<const Phase *> &rigid);
  /// Markers for all bodies, which keep the strain that they have, in place of those of the state. Collective.
  PetscErrorCode place_markers();
  /// Those of a state that was read, each on any rank. Collective.
  PetscErrorCode set_markers(const std::vector<SurfaceMarker> &markers);
  /// force += scale (div(delta tau) and the force of bending) at owned faces; with a factor also to `slope`. Of
  /// move(), or found anew if a phase has been set since. `balanced`: as of SurfaceTension, for bending; the
  /// divergence of a stress adds up to nothing.
  PetscErrorCode add_force(const std::vector<Phase> &phases, double scale, bool balanced, Field &force,
                           const WeightedTarget &slope = {});

private:
  /// Whether any membrane on the grid has markers.
  bool marks() const;
  /// Markers for the body `label` of a phase, 0: for all, which keep the strain that it has; `number`: of the phase.
  PetscErrorCode place_markers(const Phase &phase, int number, int label);
  /// `work`: the memory that membrane_ uses.
  PetscErrorCode find(const Phase &phase, WorkSpace::Lease *work);
  void begin_force();
  PetscErrorCode gather_force(const Phase &phase, NetForce *net);
  PetscErrorCode end_force(NetForce *net);
  bool drives_all(const std::vector<Phase> &phases) const;

  Flow &flow_;
  MembraneMechanics membrane_;  ///< of the phase that is worked on
  SurfaceMarkers markers_;
  WallFilm film_;
  Field force_;        ///< at faces, if it is known
  Real3 net_force_{};  ///< its mean, where that would drive all of the fluid
  bool force_known_ = false;
};

}  // namespace eulastic
