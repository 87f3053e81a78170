// Values between the grid and boxes that lie anywhere in the domain, each of them whole on one rank: velocities come to
// the boxes of bodies, their forces go back to the grid.
#pragma once

#include "base/petsc.hpp"
#include "field/field.hpp"
#include "grid/active_segments.hpp"
#include "grid/domain.hpp"

#include <map>
#include <vector>

namespace eulastic {

class BoxExchange {
public:
  /// A box, and its number, which no other box of any rank has.
  struct NumberedBox {
    const Box *box;
    int number;
  };
  /// What a box adds to the grid: the values of a field in these segments.
  struct Contribution {
    const Field *field;
    const ActiveSegments *segments;
  };

  /// For fields of `components` components.
  BoxExchange(const Domain &domain, int components) : domain_(&domain), components_(components) {}

  /// Sets the boxes of this rank. A box may cross periodic sides, but is no longer than the domain; it ends at sides of
  /// any other kind. Collective.
  PetscErrorCode connect(const std::vector<NumberedBox> &boxes);

  /// Fetches what the boxes of this rank need of the values that other ranks own. Collective.
  PetscErrorCode fetch(const Field &grid);
  /// Copies the grid's values to all points of box b, ghosts excluded, after fetch(grid).
  void copy_to_box(std::size_t b, const Field &grid, Field &to) const;
  /// Adds one field of every box to the owned values of the grid. Where boxes overlap their values are added in the
  /// order of the numbers, so that the sum does not depend on who owns the boxes. Collective.
  PetscErrorCode add(const std::vector<Contribution> &contributions, Field &grid);

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
  /// Values from boxes of other ranks with one number: where they are in `received_`, and offsets in the grid's field.
  struct Parcel {
    std::vector<PetscInt> slots, offsets;
  };
  template <class Work>
  static void for_pieces(const Run &run, const ActiveSegments &segments, const Work &work);
  PetscErrorCode list_runs(const Box &box, Place *place, std::vector<PetscSFNode> *roots);
  PetscErrorCode sort_received();

  const Domain *domain_;
  int components_;
  std::vector<Place> places_;
  SfHandle sf_;                     ///< roots: the grid's fields; leaves: the buffer
  std::ptrdiff_t buffer_size_ = 0;  ///< values of one component
  std::vector<double> buffer_, received_;
  std::map<int, Parcel> parcels_;  ///< by the number of the box
};

}  // namespace eulastic
