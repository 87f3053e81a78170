// The domain of a run on all ranks: the DMDA, the box of cells of this rank, and the owners of all other cells.
// Routines that compute take a Box, routines that communicate take a Domain.
#pragma once

#include "base/petsc.hpp"
#include "grid/split.hpp"

#include <string>
#include <vector>

namespace eulastic {

/// Size, boundaries and decomposition of the grid as set by options.
struct GridSpec : DomainShape {
  Int3 processors{0, 0, 0};  ///< ranks per direction; 0: chosen by the program
  /// First cell of each rank along every direction, followed by N; empty: an even split
  std::array<std::vector<int>, 3> starts;
  int ghosts = 5;  ///< ghost layers: WENO5 reads three, the extrapolation of B outside bodies reads five
};

/// The grid of a run, distributed over the ranks of a communicator.
class Domain : public Box {
public:
  /// Splits the cells among the ranks of `comm` and creates the DMDA. x is split only if `spec` requires it, if y and z
  /// cannot take all ranks, or if whole rows would cause many more ghosts. Fails if refusal_reason() returns an error.
  /// Collective.
  PetscErrorCode create(MPI_Comm comm, const GridSpec &spec);
  /// Returns the domain of the first of `ranks` ranks without DMDA and communicator, for estimates with any number of
  /// ranks and cells. refusal_reason() must return no error.
  static Domain planned(const GridSpec &spec, int ranks);
  /// Returns an error message of one line if `spec` cannot be split among `ranks` ranks, otherwise an empty string.
  static std::string refusal_reason(const GridSpec &spec, int ranks);
  /// Returns the ranks per direction that create() would use; {0,0,0} if there is no valid decomposition.
  static Int3 decompose(const GridSpec &spec, int ranks);
  /// Returns the largest number of cells of a rank along each direction.
  static Int3 largest_box(const GridSpec &spec, const Int3 &ranks);

  /// The DMDA of all fields, with one value per point. Its box stencil is as wide as the ghost layers, but not wider
  /// than the narrowest rank. A direction with boundaries is DM_BOUNDARY_GHOSTED and has N + 1 points, so that the face
  /// on the high boundary is a point like any other. Null for a planned() domain.
  DM dm() const { return dm_.get(); }
  /// Creates a DMDA with one value per cell and the same split for matrices, which have a column for every stencil
  /// point.
  PetscErrorCode create_cell_dm(DMDAStencilType stencil, int width, DM *dm) const;

  MPI_Comm comm() const { return comm_; }
  const GridSpec &spec() const { return spec_; }
  int rank() const { return rank_; }
  int ranks() const { return ranks_; }
  /// Ranks along direction d.
  int processors(int d) const { return split_.parts(d); }

  /// The cells of all ranks, from the ownership ranges of the DMDA.
  const Split &split() const { return split_; }
  /// Returns the rank that owns global cell (i,j,k).
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
