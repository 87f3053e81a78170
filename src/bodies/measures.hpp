// What is known of every body: volume, unwrapped centroid, velocity, lengths, deformation, inclination, strain.
//
// From the sums of phi, phi x, phi x x, phi u and phi W over the cells of a label, x in whole cells from a reference
// cell that follows the body. Sums are integers: the same bits on any ranks. Every rank knows the bodies that it owns.
// sum phi x x holds h^2/12 per volume too much, on average over the positions of a curved surface in its cells (phi is
// averaged over a cell): it is subtracted.
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
  double volume = 0;              ///< sum of phi; area in 2-D; 0 if the body is gone, then only the centroid is set
  bool leaves = false;            ///< through an open side: its volume is not that of the start any more
  Real3 centroid{};               ///< not wrapped into the box: continuous in time
  Real3 velocity{};               ///< phi-weighted mean
  Real3 semi_axes{};              ///< of the ellipsoid (2-D: ellipse) with the same second moments, longest first
  double taylor_deformation = 0;  ///< (a - c)/(a + c), longest and shortest of them
  double inclination = 0;         ///< of the long axis in the xy plane (of the xy moments) from x; (-90, 90] degrees
  double elastic_energy = 0;      ///< sum of phi W over the label's cells
  /// As taylor_deformation, of the shape that is left when the mean of B over full cells (all at rest: I) is undone.
  /// Where shape and B agree and the strain is uniform it is that of the body at rest, whatever it went through. 0 if B
  /// is not positive definite.
  double rest_deformation = 0;
  double trace_max = 0;  ///< largest tr B (with B_zz = 1 in 2-D) at centres with phi >= 1/2, and at least 3
};

/// phi W of the cells of a row, into out[0 .. cells); defined where the law is.
using RowEnergy = std::function<void(const Box &, const Phase &, const Segment &, double *out)>;

class BodyTracker {
public:
  /// Adds the bodies of the next phase, placed as the labels run: body b of all has label b + 1.
  void add_phase(const Domain &domain, const Places &places);
  /// Another body, like the one with this label, as many cells away. Collective.
  PetscErrorCode add_like(const Domain &domain, int label, const Int3 &shift);
  /// Labels of placed bodies that others were made like; those others come last, in this order.
  const std::vector<int> &like() const { return like_; }
  /// All of them again, to be followed by set_known().
  void set_like(const std::vector<long> &like);
  int bodies() const { return first_.back() + static_cast<int>(like_.size()); }
  /// Index of the phase of a body, by its label.
  int species(int label) const;
  /// Calls visit(label) for all bodies of a phase with labels before `end`, ascending.
  template <class Visit>
  void for_labels(int species, int end, const Visit &visit) const {
    for (int b = first_[species]; b < std::min(first_[species + 1], end - 1); ++b) visit(b + 1);
    for (std::size_t n = 0; n < like_.size(); ++n)
      if (const int label = first_.back() + static_cast<int>(n) + 1; label < end && this->species(label) == species)
        visit(label);
  }

  /// Who owns the bodies of which a rank has labelled cells, or that it names in `more`; `references`: of these, within
  /// the box. Collective.
  PetscErrorCode connect(const Domain &domain, const std::vector<Phase> &phases, const std::vector<int> &more,
                         BodyOwners *owners, std::vector<Int3> *references);

  /// Moves the reference cells to the centroids. Call after carry_labels(), on its schedule and nowhere else: then
  /// the unwrapping never depends on how often bodies are measured. Collective.
  PetscErrorCode follow(const Domain &domain, const std::vector<Phase> &phases);
  /// The last reference cells of bodies that follow() does not see, by their labels, on any rank. Collective.
  PetscErrorCode set_last_references(const Domain &domain, const std::vector<std::pair<int, Int3>> &last);
  /// Measures all bodies, changing nothing; every rank gets those that it owns. `velocity`: u, v (, w) on faces with
  /// one valid ghost layer, as phi and B. `boxed`: those of this rank that lie in boxes, with the velocity. Collective.
  PetscErrorCode measure(const Domain &domain, const std::vector<Phase> &phases, const Field &velocity,
                         const RowEnergy &energy, std::vector<BodyMeasure> *bodies,
                         const std::vector<BodyInBox> &boxed = {});

  /// Moves reference cells into the box, where it is new.
  void wrap(const Box &box);
  /// Volumes at t = 0 of the bodies that this rank owns; empty before set_first_volumes(), which comes after measure().
  const std::vector<double> &first_volumes() const { return first_volumes_; }
  void set_first_volumes(std::vector<double> owned) { first_volumes_ = std::move(owned); }
  /// Unwrapped reference cells of the bodies that this rank owns. Collective.
  PetscErrorCode owned_references(const Domain &domain, std::vector<Int3> *references);
  /// Unwrapped reference cells and volumes at t = 0 of all bodies, on rank 0: with the fields, all a restart needs.
  /// Collective.
  PetscErrorCode known(const Domain &domain, std::vector<Int3> *references, std::vector<double> *first_volumes);
  /// The same, of the bodies that this rank owns.
  void set_known(std::vector<Int3> owned_references, std::vector<double> owned_first_volumes);

private:
  struct Known {
    int body;
    Int3 reference;
    double first_volume;
  };
  PetscErrorCode give_to_owners(const Domain &domain, std::vector<Known> known);
  PetscErrorCode settle(const Domain &domain);

  std::vector<Known> placed_;     ///< until they are given to their owners
  std::vector<Int3> references_;  ///< of the bodies that this rank owns
  std::vector<double> first_volumes_;
  bool settled_ = false;
  std::vector<int> first_{0}, like_;  ///< first body of every phase, and one more
};

}  // namespace eulastic
