// The one grid of a run: cells and their ranks, spacing and walls, and the memory layout of ghosted fields.
//
// Staggering: value i of a field staggered in x lies on the low side of cell i, at x = i h_x; of a field that is
// not, at the centre, x = (i + 1/2) h_x. Index N of a staggered field is the high wall; it lives in a ghost layer.
#pragma once

#include "base/petsc.hpp"
#include "grid/segment.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace eulastic {

enum class Boundary : unsigned char { periodic, wall };

using Int3 = std::array<int, 3>;
using Real3 = std::array<double, 3>;
/// In which directions a field sits on the low side of its cell.
using Staggering = std::array<bool, 3>;
inline constexpr Staggering at_centre{false, false, false};
inline constexpr std::array<Staggering, 3> at_face{{{true, false, false}, {false, true, false}, {false, false, true}}};
/// Between four centres of the plane ab.
constexpr Staggering at_edge(int a, int b) { return {a == 0 || b == 0, a == 1 || b == 1, a == 2 || b == 2}; }

struct GridSpec {
  Int3 cells{64, 64, 64};              ///< N_x, N_y, N_z; N_z = 1 is 2-D
  Real3 length{1, 1, 1};               ///< box, any length unit
  std::array<Boundary, 3> boundary{};  ///< both sides of a direction alike; ignored in z when 2-D
  /// [direction][low, high]: volume crosses a side on which the pressure is given, and the faces on it move
  std::array<std::array<bool, 2>, 3> open{};
  Int3 processors{0, 0, 0};  ///< ranks per direction, 0 = chosen here
  /// First cell of each rank along every direction, and N at the end, in place of the even split; empty: that
  std::array<std::vector<int>, 3> starts;
  int ghosts = 5;  ///< layers in memory: WENO5 reads three, B outside bodies takes five

  double longest_spacing() const {
    double longest = 0;
    for (int d = 0; d < (cells[2] == 1 ? 2 : 3); ++d) longest = std::max(longest, length[d] / cells[d]);
    return longest;
  }
};

/// Ghosted memory of one field on one rank. Rows start on a 64-byte line: their low ghosts sit at the end of the
/// row before. In wall directions there is room for one high layer more: fields on the wall (index N) have three
/// ghosts behind it as well. Computed by anybody for any rank, without communication.
struct Layout {
  Int3 begin{};   ///< global index of the first owned cell
  Int3 cells{};   ///< owned cells
  Int3 ghosts{};  ///< layers on each side (0 in z when 2-D)
  std::ptrdiff_t sy = 0, sz = 0;
  std::ptrdiff_t origin = 0;  ///< offset of local cell (0,0,0)
  std::ptrdiff_t size = 0;    ///< doubles per field; like sz a multiple of sy

  std::ptrdiff_t offset(int i, int j, int k) const noexcept { return origin + i + j * sy + k * sz; }
};

class Grid {
public:
  static constexpr int stencil_width = 3;  ///< layers that WENO5 reads; also the fewest cells of a rank

  /// Decomposes the cells over `comm` (x is split only when y and z cannot take all ranks, where a whole x means many
  /// more ghosts, or by order) and makes
  /// the DMDA. Call `why_not` first: it explains in one line why a spec cannot be decomposed.
  PetscErrorCode create(MPI_Comm comm, const GridSpec &spec);
  /// The first of so many ranks, as `create` would make it, without a DMDA or a communicator: for what depends on sizes
  /// alone, at any number of ranks and cells. `why_not` must be empty.
  static Grid planned(const GridSpec &spec, int ranks);
  /// Empty if `spec` fits on `ranks` ranks, else one sentence with the numbers.
  static std::string why_not(const GridSpec &spec, int ranks);
  /// Ranks per direction that `create` would use; {0,0,0} when impossible.
  static Int3 decompose(const GridSpec &spec, int ranks);
  /// The most cells along each direction that one of so many ranks has.
  static Int3 largest_box(const GridSpec &spec, const Int3 &ranks);

  /// The DMDA, one value per cell, that says which rank owns what. Its stencil is a box as wide as there are ghosts, or
  /// as the narrowest rank has cells. None of a coarse() grid.
  DM dm() const { return dm_.get(); }
  /// Another one of the same split: matrices of PETSc's solvers have a column for each point of the stencil.
  PetscErrorCode create_dm(DMDAStencilType stencil, int width, DM *dm) const;

  /// The same box in fewer cells, for multigrid, without a DM. Where a direction has fewer cells, ranks begin at half
  /// of their first cell, rounded up; a rank may end up with none. With `everywhere` every rank holds all of it.
  Grid coarse(const Int3 &cells, bool everywhere) const;
  /// The same cells on fewer ranks, without a DM: in the directions named, of which several must have cells, every
  /// second one that has some takes those of the next one too, the last one of two where one is left over.
  Grid joined(const std::array<bool, 3> &along) const;

  MPI_Comm comm() const { return comm_; }
  const GridSpec &spec() const { return spec_; }
  int rank() const { return rank_; }
  int ranks() const { return ranks_; }
  /// A coarse() grid with one cell between open sides in z is still of three.
  int dimension() const { return spec_.cells[2] == 1 && !spec_.open[2][0] && !spec_.open[2][1] ? 2 : 3; }
  const Int3 &cells() const { return spec_.cells; }
  double cell_count() const { return double(spec_.cells[0]) * spec_.cells[1] * spec_.cells[2]; }
  double owned_count() const { return double(layout_.cells[0]) * layout_.cells[1] * layout_.cells[2]; }
  const Real3 &spacing() const { return spacing_; }
  InverseSquares inverse_squares() const;
  double cell_volume() const;  ///< area in 2-D
  Boundary boundary(int d) const { return spec_.boundary[d]; }
  /// Whether the box has sides there, of whatever kind (field/sides.hpp): not periodic.
  bool is_wall(int d) const { return d < dimension() && spec_.boundary[d] == Boundary::wall; }
  bool is_open(int d, bool high) const { return is_wall(d) && spec_.open[d][high]; }
  /// Whether the pressure is given anywhere; elsewhere its mean is free.
  bool any_open() const;
  bool touches_low(int d) const { return is_wall(d) && layout_.begin[d] == 0; }
  bool touches_high(int d) const { return is_wall(d) && layout_.begin[d] + layout_.cells[d] == spec_.cells[d]; }
  bool touches(int d, bool high) const { return high ? touches_high(d) : touches_low(d); }
  struct SideOfBox {
    int d;
    bool high;
  };
  /// All sides of the box, low before high.
  std::vector<SideOfBox> sides() const;
  /// A global index along d, back in the box where that is periodic.
  int image(int d, int i) const;
  /// Ranks along direction d.
  int processors(int d) const { return static_cast<int>(starts_[d].size()) - 1; }

  /// Whether x is periodic and not split: its ghosts are the other end of the same row.
  bool wraps_x() const { return spec_.boundary[0] == Boundary::periodic && processors(0) == 1; }

  /// Where a rank is among those along every direction, which count through x first.
  Int3 place_of(int rank) const;
  int rank_at(const Int3 &place) const { return place[0] + processors(0) * (place[1] + processors(1) * place[2]); }
  /// The place along d of whoever owns the cells with index i; index N of a wall direction belongs to the owner of N
  /// - 1.
  int owner_along(int d, int i) const;
  /// The first cell of those at a place along d, and N at place processors(d).
  int first_cell(int d, int place) const { return starts_[d][place]; }

  const Layout &layout() const { return layout_; }
  const Int3 &owned() const { return layout_.cells; }
  Layout layout_of(int rank) const;
  /// The rank that owns global cell (i,j,k).
  int owner(int i, int j, int k) const { return rank_at({owner_along(0, i), owner_along(1, j), owner_along(2, k)}); }

  /// One past the last entry of the points a field really has on this rank: one more than the cells where the
  /// field is staggered and the rank touches the high wall.
  int points_end(int d, bool staggered) const { return layout_.cells[d] + (staggered && touches_high(d) ? 1 : 0); }
  struct Range {
    int begin, end;
  };
  /// Local indices along d of the points a field really has here, with `layers` of ghosts, or as many as there are:
  /// none behind walls, those of a neighbour too.
  Range points_near(int d, bool staggered, int layers) const;
  /// The faces on a side, if this rank touches it. No verb that goes through owned rows comes to those on a high one,
  /// index N.
  std::vector<Segment> faces_on(int d, bool high) const;
  /// Those on the high side of direction d if it is open, else none.
  std::vector<Segment> open_high_faces(int d) const {
    return is_open(d, true) ? faces_on(d, true) : std::vector<Segment>();
  }
  /// The owned cells within so many layers of a side, if this rank touches it.
  std::vector<Segment> cells_at(int d, bool high, int layers) const;
  /// All owned rows, whole.
  std::vector<Segment> rows() const;
  /// One past the last owned face of component a along d: with the face on the high side.
  int faces_end(int a, int d) const { return layout_.cells[d] + (a == d && touches_high(d)); }

private:
  void divide(const GridSpec &spec, int ranks);
  PetscErrorCode ask_dm(Int3 *place);
  Layout make_layout(const Int3 &position) const;

  MPI_Comm comm_ = MPI_COMM_NULL;
  int rank_ = 0, ranks_ = 1;
  DmHandle dm_;
  GridSpec spec_;
  Real3 spacing_{};
  std::array<std::vector<int>, 3> starts_;  ///< first cell of every rank along a direction, and N at the end
  Layout layout_;
};

/// visit(i, j, k) for all points of these rows.
template <class Visit>
void for_points(const std::vector<Segment> &rows, Visit visit) {
  for (const Segment &row : rows)
    for (int i = row.i_begin; i < row.i_end; ++i) visit(i, row.j, row.k);
}

}  // namespace eulastic
