// Measures of every body: volume, unwrapped centroid, velocity, lengths, deformation, inclination, strain.
//
// They follow from the sums of phi, phi x, phi x x, phi u and phi W over the cells of a label, with x in whole cells
// from a reference cell that follows the body. Sums are integers, so that the bits do not depend on the ranks. Every
// rank knows the measures of the bodies that it owns. As phi is a cell average, sum phi x x is too large by h^2/12 per
// volume, on average over the positions of a curved surface; this is subtracted.
#pragma once

#include "base/petsc.hpp"
#include "bodies/body_owners.hpp"
#include "bodies/placement.hpp"
#include "field/phase.hpp"
#include "grid/domain.hpp"

#include <algorithm>
#include <functional>
#include <utility>

namespace eulastic {

struct BodyMeasure {
  int label = 0;                  ///< 1 + index of the body
  int species = 0;                ///< index of its phase
  double volume = 0;              ///< sum of phi; area in 2-D; 0 if the body has left, with only the centroid set
  bool leaves = false;            ///< it crosses an open boundary, so that its volume decreases
  Real3 centroid{};               ///< not wrapped into the domain: continuous in time
  Real3 velocity{};               ///< phi-weighted mean
  Real3 semi_axes{};              ///< of the ellipsoid (2-D: ellipse) with the same second moments, longest first
  double taylor_deformation = 0;  ///< (a - c)/(a + c), longest and shortest of them
  double inclination = 0;         ///< of the long axis in the xy plane (of the xy moments) from x; (-90, 90] degrees
  double elastic_energy = 0;      ///< sum of phi W over the label's cells
  /// Taylor deformation of the shape after the stretch given by the mean of B over full cells is undone. If B is
  /// consistent with the shape and the strain uniform, it is that of the body at rest. 0 if B is not positive definite.
  double rest_deformation = 0;
  double trace_max = 0;  ///< largest tr B (with B_zz = 1 in 2-D) at centres with phi >= 1/2, and at least 3
};

/// Computes phi W of the cells of a row into out[0 .. cells).
using RowEnergy = std::function<void(const Box &, const Phase &, const Segment &, double *out)>;

class BodyTracker {
public:
  /// Adds the bodies of the next phase in the order of their labels: body b of all phases has label b + 1.
  void add_phase(const Domain &domain, const Places &places);
  /// Adds a copy of the body with this label, shifted by a number of cells. Collective.
  PetscErrorCode add_like(const Domain &domain, int label, const Int3 &shift);
  /// Labels of the placed bodies of which the later bodies are copies, in the order of the copies.
  const std::vector<int> &like() const { return like_; }
  /// Sets like() at a restart; call set_known() next.
  void set_like(const std::vector<long> &like);
  int bodies() const { return first_.back() + static_cast<int>(like_.size()); }
  /// Returns the index of the phase of the body with this label.
  int species(int label) const;
  /// Calls visit(label) for all bodies of a phase with labels below `end`, ascending.
  template <class Visit>
  void for_labels(int species, int end, const Visit &visit) const {
    for (int b = first_[species]; b < std::min(first_[species + 1], end - 1); ++b) visit(b + 1);
    for (std::size_t n = 0; n < like_.size(); ++n)
      if (const int label = first_.back() + static_cast<int>(n) + 1; label < end && this->species(label) == species)
        visit(label);
  }

  /// Finds the owners of the bodies of which this rank has labelled cells, or whose labels are in `more`, and their
  /// reference cells, wrapped into the domain. Collective.
  PetscErrorCode connect(const Domain &domain, const std::vector<Phase> &phases, const std::vector<int> &more,
                         BodyOwners *owners, std::vector<Int3> *references);

  /// Moves the reference cells to the centroids. Call it after carry_labels() only, on the same schedule, so that
  /// the unwrapping does not depend on how often bodies are measured. Collective.
  PetscErrorCode follow(const Domain &domain, const std::vector<Phase> &phases);
  /// Sets the reference cells of bodies that follow() does not see, by their labels, on any rank. Collective.
  PetscErrorCode set_last_references(const Domain &domain, const std::vector<std::pair<int, Int3>> &last);
  /// Measures all bodies; every rank gets those that it owns. `velocity`: on faces; it, phi and B have one valid ghost
  /// layer. `boxed`: the bodies of this rank that lie in boxes of their own, with the velocity. Collective.
  PetscErrorCode measure(const Domain &domain, const std::vector<Phase> &phases, const Field &velocity,
                         const RowEnergy &energy, std::vector<BodyMeasure> *bodies,
                         const std::vector<BodyInBox> &boxed = {});

  /// Wraps the reference cells into the domain, after it has changed.
  void wrap(const Box &box);
  /// Volumes at t = 0 of the bodies that this rank owns; empty before set_first_volumes().
  const std::vector<double> &first_volumes() const { return first_volumes_; }
  void set_first_volumes(std::vector<double> owned) { first_volumes_ = std::move(owned); }
  /// Unwrapped reference cells of the bodies that this rank owns. Collective.
  PetscErrorCode owned_references(const Domain &domain, std::vector<Int3> *references);
  /// Gathers the unwrapped reference cells and volumes at t = 0 of all bodies on rank 0, for a checkpoint. Collective.
  PetscErrorCode known(const Domain &domain, std::vector<Int3> *references, std::vector<double> *first_volumes);
  /// Sets the same for the bodies that this rank owns, at a restart.
  void set_known(std::vector<Int3> owned_references, std::vector<double> owned_first_volumes);

private:
  struct Known {
    int body;
    Int3 reference;
    double first_volume;
  };
  PetscErrorCode give_to_owners(const Domain &domain, std::vector<Known> known);
  PetscErrorCode send_placed_to_owners(const Domain &domain);
  // The label of a placed body, or of the placed body of which this body is a copy.
  int placed(int label) const { return label > first_.back() ? like_[label - first_.back() - 1] : label; }

  std::vector<Known> placed_;     ///< bodies that have not been sent to their owners yet
  std::vector<Int3> references_;  ///< reference cells of the bodies that this rank owns
  std::vector<double> first_volumes_;
  bool sent_to_owners_ = false;
  std::vector<int> first_{0}, like_;  ///< first_: first body of every phase, and the total
};

}  // namespace eulastic
