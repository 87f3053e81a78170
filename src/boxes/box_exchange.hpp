// Exchanges values between the grid and boxes anywhere in the domain, each of which is complete on one rank: velocities
// go to the boxes of bodies, their forces to the grid.
#pragma once

#include "base/petsc.hpp"
#include "field/field.hpp"
#include "field/net_force.hpp"
#include "grid/active_segments.hpp"
#include "grid/domain.hpp"

#include <functional>
#include <map>
#include <vector>

namespace eulastic {

/// The values of a field in segments only.
class SegmentValues {
public:
  void take(const Field &field, const ActiveSegments &segments);
  /// The values of a component in segment `which` of ActiveSegments::all().
  const double *of(int component, std::ptrdiff_t which) const {
    return values_.data() + component * size_ + starts_[which];
  }
  std::size_t bytes() const { return values_.size() * sizeof(double) + starts_.size() * sizeof(std::ptrdiff_t); }

private:
  std::vector<double> values_;          ///< component after component
  std::vector<std::ptrdiff_t> starts_;  ///< of every segment in a component
  std::ptrdiff_t size_ = 0;             ///< of a component
};

class BoxExchange {
public:
  /// A box, and its number, which no other box of any rank has.
  struct NumberedBox {
    const Box *box;
    int number;
  };
  /// Values that a box adds to the grid; none if these are null.
  struct Contribution {
    const SegmentValues *values = nullptr;
    const ActiveSegments *segments = nullptr;
  };

  /// For fields of `components` components.
  BoxExchange(const Domain &domain, int components) : domain_(&domain), components_(components) {}

  /// Sets the boxes of this rank. A box may cross periodic boundaries, and even be longer than the domain; it ends at
  /// boundaries of any other kind. `fetches_only`: the boxes send nothing to the grid. Collective.
  PetscErrorCode connect(const std::vector<NumberedBox> &boxes, bool fetches_only = false);

  /// Fetches the values of other ranks that the boxes of this rank need. Collective.
  PetscErrorCode fetch(const Field &grid);
  /// Copies the grid's values to all points of box b, ghosts excluded, after fetch(grid).
  void copy_to_box(std::size_t b, const Field &grid, Field &to) const;
  /// Adds values of every box to the owned values of fields of the grid. Where boxes overlap their values are added in
  /// the order of the numbers, so that the sum does not depend on the owners of the boxes. Collective.
  PetscErrorCode add(const std::vector<Contribution> &contributions, const std::vector<WeightedTarget> &targets);
  /// Calls visit(number, offset, count, values) for all points of this rank's grid that lie in boxes, `count` points
  /// that follow each other along x at a time, box after box in the order of the numbers: `offset` of the first one in
  /// a component of the grid's fields, `values[f]`: those of component f of the box's field there. field_of(b): the
  /// field of box b of this rank, used until the next call, which is asked for twice if parts of the box lie on other
  /// ranks. Collective.
  using FieldOf = std::function<const Field &(std::size_t box)>;
  using Visit = std::function<void(int number, std::ptrdiff_t offset, int count, const double *const *values)>;
  PetscErrorCode collect(const FieldOf &field_of, const Visit &visit);
  /// Sets `rows`, one value for each row of this rank's cells, where any box of any rank lies.
  void mark_rows(std::vector<char> *rows) const;
  std::size_t bytes() const;

private:
  /// Points of a row of a box whose values have one owner.
  struct Run {
    int i, j, k;  ///< the first one, in the box
    int count;
    std::ptrdiff_t elsewhere;  ///< its offset in a component of the grid's field, or in a component of the buffer
  };
  struct Place {
    int number;
    std::vector<Run> own, remote;  ///< of this rank's grid, of the others'
  };
  /// Values from boxes of other ranks with one number: where they are in `received_`, and offsets in the grid's field,
  /// ascending.
  struct Parcel {
    std::vector<PetscInt> slots, offsets;
  };
  template <class Work>
  static void for_pieces(const Run &run, const Contribution &contribution, int component, const Work &work);
  PetscErrorCode list_runs(const Box &box, Place *place, std::vector<PetscSFNode> *roots);
  PetscErrorCode sort_received();
  PetscErrorCode gather();
  /// visit_own(b) and visit_received(number, parcel) for all boxes that lie on this rank's grid, in the order of the
  /// numbers.
  template <class VisitOwn, class VisitReceived>
  void in_order(const VisitOwn &visit_own, const VisitReceived &visit_received) const;

  const Domain *domain_;
  int components_;
  std::vector<Place> places_;
  SfHandle sf_;                     ///< roots: the grid's fields; leaves: the buffer
  std::ptrdiff_t buffer_size_ = 0;  ///< values of one component
  std::vector<double> buffer_, received_;
  std::map<int, Parcel> parcels_;  ///< by the number of the box
};

}  // namespace eulastic
