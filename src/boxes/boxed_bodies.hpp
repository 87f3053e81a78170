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
  /// Adds a body that FreeBodies::packed() has made to this rank.
  PetscErrorCode add_packed(const std::vector<double> &packed);
  /// Adds copies of bodies of this rank to it, as far away as given: label, that of the copy. follow() comes next.
  PetscErrorCode add_copies(const std::vector<std::pair<int, int>> &copies, const std::map<int, Int3> &shifts);
  /// Removes bodies of this rank, by their positions in list(), ascending; follow() must come next.
  void remove(const std::vector<std::size_t> &which) { bodies_.remove(which); }
  /// Removes the bodies of all ranks; others are added afterwards.
  void clear() { bodies_.clear(); }
  /// Updates the boxes after bodies have been added or removed on some ranks. Collective.
  PetscErrorCode refit();
  const FreeBodies &bodies() const { return bodies_; }
  /// Of the body at a place in bodies().
  std::vector<Receptor> &receptors(std::size_t body) { return bodies_.receptors(body); }
  /// The bodies of this rank at their own time, without velocity.
  std::vector<BodyInBox> list() const { return bodies_.list(); }
  /// Solid fraction of all bodies of every species in boxes, on the grid. Collective.
  PetscErrorCode show_all_fractions(std::map<int, Phase> *phases);

  std::size_t bytes() const override { return bodies_.bytes(); }
  PetscErrorCode start() override;
  PetscErrorCode resume() override;
  PetscErrorCode begin_step() override;
  PetscErrorCode begin_slope(double dt, Field &slope) override;
  PetscErrorCode move(double dt, std::vector<Phase> *phases) override;
  PetscErrorCode add_rate(const MomentumRate &rate) override;
  PetscErrorCode add_power(const SynchronisedBodies &look, double *power) override;
  PetscErrorCode add_surface_energy(const SynchronisedBodies &look, SurfaceEnergy *measured,
                                    std::vector<SurfaceSample> *samples) override;
  PetscErrorCode place_markers() { return bodies_.place_markers(); }
  void keep_surfaces(bool keep) { bodies_.keep_surfaces(keep); }
  void mark_forced_rows(std::vector<char> *rows) const override { bodies_.mark_rows(rows); }
  PetscErrorCode reset_unresolved(const std::vector<double> &trace) override;

  /// Bodies of this rank with the velocity, at its time: copies that have been moved over `behind`, or the bodies
  /// themselves if that is 0. Valid until forget_looks(). Collective.
  PetscErrorCode look(double behind, std::vector<BodyInBox> *seen);
  /// Calls look() while the phases of species in boxes have what look() has seen on the grid: phi is the sum, B and the
  /// label are of the body that fills most. Collective.
  PetscErrorCode show_on_grid(const std::vector<BodyInBox> &seen, std::vector<Phase> *phases,
                              const std::function<PetscErrorCode()> &look);
  void forget_looks();
  /// Of the membranes that add_surface_energy() has seen, to the ranks that own the bodies: `first` is the first of
  /// those. Collective.
  PetscErrorCode give_surface_measures(const std::vector<BodyInBox> &seen, int first,
                                       std::vector<SurfaceMeasure> *owned) const;

private:
  PetscErrorCode start_surfaces();
  PetscErrorCode share();
  PetscErrorCode show_fractions(const std::vector<BodyInBox> &seen, std::vector<Phase> *phases);
  PetscErrorCode show(const std::vector<BodyInBox> &seen);

  Flow &flow_;
  FreeBodies bodies_;
  std::vector<BodyInBox> seen_;  ///< by look()
  bool is_seen_ = false;
  std::map<int, Phase> shown_;                       ///< for show_on_grid(), by species; empty: not made yet
  std::vector<std::vector<SurfaceSample>> samples_;  ///< of the membranes in seen_
};

}  // namespace eulastic
