// The bodies of a flow in boxes of their own (boxes/free_bodies.hpp): their ranks, their forces on the flow, and their
// fields on the grid.
#pragma once

#include "boxes/free_bodies.hpp"
#include "membranes/surface_measures.hpp"
#include "parts/flow.hpp"
#include "parts/flow_part.hpp"

#include <functional>
#include <map>

namespace eulastic {

class BoxedBodies final : public FlowPart {
public:
  explicit BoxedBodies(Flow *flow)
      : flow_(*flow),
        bodies_(flow->domain, flow->fluid, flow->spec.sides, flow->spec.exterior == SolidExterior::extrapolate) {}

  /// Whether any species has its bodies in boxes of their own.
  bool exist() const;
  /// Adds a body of a species, whose phase is `boxed` and empty, to this rank: `phase` has material, phi and B on
  /// `box`.
  PetscErrorCode add(int number, int species, const Box &box, Phase &&phase);
  /// Takes the labelled bodies of a species, whose phase is `boxed`, off the grid. Collective, before start().
  PetscErrorCode take_from_grid(int species);
  /// Adds a body in the form of FreeBodies::packed() to this rank.
  PetscErrorCode add_packed(const std::vector<double> &packed);
  /// Adds copies of bodies of this rank to this rank. `copies`: labels of a body and of its copy; `shifts`: by the
  /// label of the body, in cells. Call refit() afterwards.
  PetscErrorCode add_copies(const std::vector<std::pair<int, int>> &copies, const std::map<int, Int3> &shifts);
  /// Updates the boxes after bodies have been added or removed on some ranks. Collective.
  PetscErrorCode refit();
  /// The bodies of this rank. Call refit() after they have been added or removed.
  FreeBodies &bodies() { return bodies_; }
  const FreeBodies &bodies() const { return bodies_; }
  /// Computes phi on the grid of every species in boxes. Collective.
  PetscErrorCode find_all_fractions(std::map<int, Phase> *phases);

  std::size_t bytes() const override { return bodies_.bytes(); }
  PetscErrorCode start() override;
  PetscErrorCode resume() override;
  PetscErrorCode begin_step() override;
  PetscErrorCode begin_slope(double dt, Field &slope) override;
  PetscErrorCode move(double dt, std::vector<Phase> *phases) override;
  PetscErrorCode add_rate(const MomentumRate &rate) override;
  PetscErrorCode add_power(const SynchronisedBodies &bodies, double *power) override;
  PetscErrorCode add_surface_energy(const SynchronisedBodies &bodies, SurfaceEnergy *measured,
                                    std::vector<SurfaceSample> *samples) override;
  void mark_forced_rows(std::vector<char> *rows) const override { bodies_.mark_rows(rows); }
  PetscErrorCode reset_unresolved(const std::vector<double> &trace) override;

  /// Bodies of this rank with the velocity, at its time: copies that have been moved over `behind`, or the bodies
  /// themselves if that is 0. Valid until discard_copies(). Collective.
  PetscErrorCode synchronise(double behind, std::vector<BodyInBox> *bodies);
  /// Calls observe() while the phases of species in boxes contain `bodies` (of synchronise()) on the grid: phi is the
  /// sum; B and the label are those of the body with the largest phi. Collective.
  PetscErrorCode with_bodies_on_grid(const std::vector<BodyInBox> &bodies, std::vector<Phase> *phases,
                                     const std::function<PetscErrorCode()> &observe);
  /// Discards the results of synchronise() and with_bodies_on_grid().
  void discard_copies();
  /// Sends measures of the membranes in `bodies`, after add_surface_energy(), to the ranks that own the bodies.
  /// `owned`: those of the bodies from index `first` on. Collective.
  PetscErrorCode give_surface_measures(const std::vector<BodyInBox> &bodies, int first,
                                       std::vector<SurfaceMeasure> *owned) const;

private:
  PetscErrorCode start_surfaces();
  PetscErrorCode share();
  PetscErrorCode put_fractions_on_grid(const std::vector<BodyInBox> &bodies, std::vector<Phase> *phases);
  PetscErrorCode put_on_grid(const std::vector<BodyInBox> &bodies);

  Flow &flow_;
  FreeBodies bodies_;
  std::vector<BodyInBox> synchronised_;  ///< result of synchronise()
  bool are_synchronised_ = false;
  std::map<int, Phase> on_grid_;                     ///< for with_bodies_on_grid(), by species; empty: not made yet
  std::vector<std::vector<SurfaceSample>> samples_;  ///< of the membranes in synchronised_
};

}  // namespace eulastic
