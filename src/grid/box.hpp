// A block of cells with ghosts: its position in the domain and the memory layout of its fields. Free of PETSc and MPI.
//
// Staggering: value i of a field staggered in x is located on the low face of cell i, at x = i h_x; value i of any
// other field at the centre, x = (i + 1/2) h_x. A staggered field has N + 1 points along a direction with boundaries.
#pragma once

#include "grid/segment.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace eulastic {

/// Whether a direction is periodic or has boundaries, of any kind (field/boundaries.hpp).
enum class Boundary : unsigned char { periodic, wall };

using Int3 = std::array<int, 3>;
using Real3 = std::array<double, 3>;
/// The directions in which a field is located on the low side of its cell.
using Staggering = std::array<bool, 3>;
inline constexpr Staggering at_centre{false, false, false};
inline constexpr std::array<Staggering, 3> at_face{{{true, false, false}, {false, true, false}, {false, false, true}}};
/// Staggering of a field on the edges between four centres of the plane ab.
constexpr Staggering at_edge(int a, int b) { return {a == 0 || b == 0, a == 1 || b == 1, a == 2 || b == 2}; }

/// A block of cells or points, begin to end in every direction.
struct Extent {
  Int3 begin, end;
  Int3 middle() const {
    return {begin[0] + (end[0] - begin[0]) / 2, begin[1] + (end[1] - begin[1]) / 2, begin[2] + (end[2] - begin[2]) / 2};
  }
};

/// "xmin", "xmax", "ymin", ...
inline std::string side_name(int d, bool high) { return std::string{"xyz"[d]} + (high ? "max" : "min"); }

/// The whole domain of a run.
struct DomainShape {
  Int3 cells{64, 64, 64};              ///< N_x, N_y, N_z; N_z = 1 is 2-D
  Real3 length{1, 1, 1};               ///< edges of the domain, in the unit of length of the scene
  std::array<Boundary, 3> boundary{};  ///< the same at both ends of a direction; ignored in z in 2-D
  /// [direction][low, high]: whether the boundary is open; its pressure is given and the velocity on its faces is
  /// unknown
  std::array<std::array<bool, 2>, 3> open{};

  /// 2 or 3. A coarse level of the V-cycle with a single cell between open boundaries in z is three-dimensional.
  int dimension() const { return cells[2] == 1 && !open[2][0] && !open[2][1] ? 2 : 3; }
  /// Whether direction d has boundaries, of any kind (field/boundaries.hpp), rather than being periodic.
  bool is_wall(int d) const { return d < dimension() && boundary[d] == Boundary::wall; }
  double spacing(int d) const { return length[d] / cells[d]; }
  double longest_spacing() const {
    double longest = 0;
    for (int d = 0; d < dimension(); ++d) longest = std::max(longest, spacing(d));
    return longest;
  }
  double shortest_spacing() const {
    double shortest = spacing(0);
    for (int d = 1; d < dimension(); ++d) shortest = std::min(shortest, spacing(d));
    return shortest;
  }
  double volume() const {  ///< an area in 2-D
    double product = 1;
    for (int d = 0; d < dimension(); ++d) product *= length[d];
    return product;
  }
  /// The area of a boundary of direction d; in 2-D its length.
  double side_area(int d) const {
    double product = 1;
    for (int e = 0; e < dimension(); ++e)
      if (e != d) product *= length[e];
    return product;
  }
};

/// Memory layout of one field with ghosts. Rows start at a 64-byte cache line; the low ghosts of a row are stored at
/// the end of the previous row. Directions with boundaries have one more high layer, so that a field with points on the
/// boundary (index N) has as many ghosts behind it as a field at centres.
struct Layout {
  Int3 begin{};   ///< global index of the first cell
  Int3 cells{};   ///< without ghosts
  Int3 ghosts{};  ///< layers at each end; 0 in z in 2-D
  std::ptrdiff_t sy = 0, sz = 0;
  std::ptrdiff_t origin = 0;  ///< offset of local cell (0,0,0)
  std::ptrdiff_t size = 0;    ///< doubles per field; sz and size are multiples of sy

  std::ptrdiff_t offset(int i, int j, int k) const noexcept { return origin + i + j * sy + k * sz; }
};

/// The geometry of one block of cells with ghosts.
class Box {
public:
  static constexpr int stencil_width = 3;  ///< ghost layers that WENO5 reads

  Box() = default;
  /// A block of `cells` cells whose first cell is global cell `begin`. `whole_rows`: this block and all blocks with
  /// which it exchanges ghosts contain all cells along x, so that in a periodic x the ghosts of a row are filled from
  /// its other end.
  Box(const DomainShape &domain, const Int3 &begin, const Int3 &cells, int ghosts, bool whole_rows = false);

  const DomainShape &domain_shape() const { return domain_; }
  const Int3 &domain_cells() const { return domain_.cells; }
  double domain_cell_count() const { return double(domain_.cells[0]) * domain_.cells[1] * domain_.cells[2]; }
  int dimension() const { return domain_.dimension(); }
  Boundary boundary(int d) const { return domain_.boundary[d]; }
  /// Whether direction d has boundaries, of any kind (field/boundaries.hpp), rather than being periodic.
  bool is_wall(int d) const { return domain_.is_wall(d); }
  bool is_open(int d, bool high) const { return is_wall(d) && domain_.open[d][high]; }
  /// Whether the pressure is given on any boundary; otherwise it is determined up to a constant.
  bool any_open() const;
  /// One of the six faces of the domain.
  struct BoundaryFace {
    int d;
    bool high;
  };
  /// Returns all boundaries of the domain, low before high.
  std::vector<BoundaryFace> sides() const;
  /// Maps global index i along d into the domain if d is periodic; otherwise returns i.
  int image(int d, int i) const;

  const Real3 &spacing() const { return spacing_; }
  InverseSquares inverse_squares() const;
  double cell_volume() const;  ///< an area in 2-D

  const Layout &layout() const { return layout_; }
  /// Number of cells without ghosts.
  const Int3 &cells() const { return layout_.cells; }
  double cell_count() const { return double(layout_.cells[0]) * layout_.cells[1] * layout_.cells[2]; }
  /// Whether the block contains all cells of the domain along d.
  bool spans(int d) const { return layout_.cells[d] == domain_.cells[d]; }
  bool whole_rows() const { return whole_rows_; }
  /// Whether the ghosts of a row are copies of its other end.
  bool wraps_x() const { return domain_.boundary[0] == Boundary::periodic && whole_rows_; }
  bool touches_low(int d) const { return is_wall(d) && layout_.begin[d] == 0; }
  bool touches_high(int d) const { return is_wall(d) && layout_.begin[d] + layout_.cells[d] == domain_.cells[d]; }
  bool touches(int d, bool high) const { return high ? touches_high(d) : touches_low(d); }

  /// Returns the end of the local indices of a field along d: the number of cells, plus one where the field is
  /// staggered and the block touches the high boundary.
  int points_end(int d, bool staggered) const { return layout_.cells[d] + (staggered && touches_high(d) ? 1 : 0); }
  /// All points of a field in the block.
  Extent points(const Staggering &at) const {
    return {{0, 0, 0}, {points_end(0, at[0]), points_end(1, at[1]), points_end(2, at[2])}};
  }
  struct Range {
    int begin, end;
  };
  /// Returns the local indices along d of the points of a field in the block and in `layers` of its ghosts (at most
  /// all), without ghosts behind boundaries.
  Range points_with_ghosts(int d, bool staggered, int layers) const;
  /// Returns the faces on a boundary of the domain, none if the block does not touch it. The faces of a high boundary,
  /// index N, are not part of rows().
  std::vector<Segment> boundary_faces(int d, bool high) const;
  /// Returns the faces on the high boundary of direction d if it is open, otherwise none.
  std::vector<Segment> open_high_faces(int d) const {
    return is_open(d, true) ? boundary_faces(d, true) : std::vector<Segment>();
  }
  /// Returns the cells within `layers` of a boundary of the domain, none if the block does not touch it.
  std::vector<Segment> boundary_cells(int d, bool high, int layers) const;
  /// Returns all rows of cells, without ghosts.
  std::vector<Segment> rows() const;

private:
  DomainShape domain_;
  Real3 spacing_{};
  bool whole_rows_ = false;
  Layout layout_;
};

/// Calls visit(i, j, k) for all points of a block, x fastest.
template <class Visit>
void for_points(const Extent &block, Visit visit) {
  for (int k = block.begin[2]; k < block.end[2]; ++k)
    for (int j = block.begin[1]; j < block.end[1]; ++j)
      for (int i = block.begin[0]; i < block.end[0]; ++i) visit(i, j, k);
}
/// Calls visit(i, j, k) for all points of these rows.
template <class Visit>
void for_points(const std::vector<Segment> &rows, Visit visit) {
  for (const Segment &row : rows)
    for (int i = row.i_begin; i < row.i_end; ++i) visit(i, row.j, row.k);
}

}  // namespace eulastic
