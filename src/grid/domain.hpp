// The domain of a run on all its ranks: the DMDA, the box of cells of this rank, and who owns all others. Routines that
// compute take the Box; those that communicate take the Domain.
#pragma once

#include "base/petsc.hpp"
#include "grid/split.hpp"

#include <string>
#include <vector>

namespace eulastic {

/// The grid that the options ask for.
struct GridSpec : DomainShape {
  Int3 processors{0, 0, 0};  ///< ranks per direction; 0: chosen by the program
  /// First cell of each rank along every direction, and N at the end; empty: an even split
  std::array<std::vector<int>, 3> starts;
  int ghosts = 5;  ///< layers in memory: WENO5 reads three, the extrapolation of B outside bodies takes five
};

class Domain : public Box {
public:
  /// Splits the cells over `comm` and makes the DMDA. x is split only when y and z cannot take all ranks, where a whole
  /// x means many more ghosts, or if `spec` says so. Call `why_not` first: it says in one line why a spec cannot be
  /// split.
  PetscErrorCode create(MPI_Comm comm, const GridSpec &spec);
  /// What `create` would make on the first of `ranks` ranks, without a DMDA or a communicator: for estimates, at any
  /// number of ranks and cells. `why_not` must be empty.
  static Domain planned(const GridSpec &spec, int ranks);
  /// Empty if `spec` fits on `ranks` ranks, else one sentence with the numbers.
  static std::string why_not(const GridSpec &spec, int ranks);
  /// Ranks per direction that `create` would use; {0,0,0} when impossible.
  static Int3 decompose(const GridSpec &spec, int ranks);
  /// The largest number of cells of a rank along each direction.
  static Int3 largest_box(const GridSpec &spec, const Int3 &ranks);

  /// The DMDA of all fields: one value per point. Its stencil is a box as wide as there are ghosts, or as the narrowest
  /// rank has cells. A direction with boundaries has N + 1 points, so that the high face is a point like any other, and
  /// DM_BOUNDARY_GHOSTED. Null for a planned() domain.
  DM dm() const { return dm_.get(); }
  /// A DMDA with one value per cell, of the same split, for matrices: these have a column for each point of the
  /// stencil.
  PetscErrorCode create_cell_dm(DMDAStencilType stencil, int width, DM *dm) const;

  MPI_Comm comm() const { return comm_; }
  const GridSpec &spec() const { return spec_; }
  int rank() const { return rank_; }
  int ranks() const { return ranks_; }
  /// Ranks along direction d.
  int processors(int d) const { return split_.parts(d); }

  /// The cells of all ranks, as the DMDA's ownership ranges say.
  const Split &split() const { return split_; }
  /// The rank that owns global cell (i,j,k).
  int owner(int i, int j, int k) const {
    return split_.rank_at({split_.position_along(0, i), split_.position_along(1, j), split_.position_along(2, k)});
  }

private:
  void divide(const GridSpec &spec, int ranks);
  PetscErrorCode create_dm(bool high_faces, DMDAStencilType stencil, int width, DM *dm) const;
  PetscErrorCode read_dm();

  MPI_Comm comm_ = MPI_COMM_NULL;
  int rank_ = 0, ranks_ = 1;
  DmHandle dm_;
  GridSpec spec_;
  Split split_;
};

}  // namespace eulastic
