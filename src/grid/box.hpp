// A block of cells with ghosts: where it lies in the domain and how its fields lie in memory. Free of PETSc and MPI.
//
// Staggering: value i of a field staggered in x lies on the low face of cell i, at x = i h_x; value i of any other
// field lies at the centre, x = (i + 1/2) h_x. A staggered field of a domain with boundaries has N + 1 points.
#pragma once

#include "grid/segment.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace eulastic {

enum class Boundary : unsigned char { periodic, wall };

using Int3 = std::array<int, 3>;
using Real3 = std::array<double, 3>;
/// The directions in which a field lies on the low face of its cell.
using Staggering = std::array<bool, 3>;
inline constexpr Staggering at_centre{false, false, false};
inline constexpr std::array<Staggering, 3> at_face{{{true, false, false}, {false, true, false}, {false, false, true}}};
/// Between four centres of the plane ab.
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
  Real3 length{1, 1, 1};               ///< of the edges, in the unit of the scene
  std::array<Boundary, 3> boundary{};  ///< both sides of a direction alike; ignored in z when 2-D
  /// [direction][low, high]: the pressure is given on this side, so volume crosses it and its faces have a velocity
  std::array<std::array<bool, 2>, 3> open{};

  /// A coarse level of the V-cycle with one cell between open sides in z is still 3-D.
  int dimension() const { return cells[2] == 1 && !open[2][0] && !open[2][1] ? 2 : 3; }
  /// Whether the domain ends in direction d, at a side of any kind (field/sides.hpp).
  bool is_wall(int d) const { return d < dimension() && boundary[d] == Boundary::wall; }
  double longest_spacing() const {
    double longest = 0;
    for (int d = 0; d < (cells[2] == 1 ? 2 : 3); ++d) longest = std::max(longest, length[d] / cells[d]);
    return longest;
  }
};

/// Memory of one field with ghosts. Rows start on a 64-byte line; the low ghosts of a row lie at the end of the row
/// before. Directions with boundaries have one more high layer, so that a field on the boundary (index N) has as many
/// ghosts behind it as a field at centres.
struct Layout {
  Int3 begin{};   ///< global index of the first cell
  Int3 cells{};   ///< without ghosts
  Int3 ghosts{};  ///< layers on each side (0 in z when 2-D)
  std::ptrdiff_t sy = 0, sz = 0;
  std::ptrdiff_t origin = 0;  ///< offset of local cell (0,0,0)
  std::ptrdiff_t size = 0;    ///< doubles per field, a multiple of sy, as sz is

  std::ptrdiff_t offset(int i, int j, int k) const noexcept { return origin + i + j * sy + k * sz; }
};

class Box {
public:
  static constexpr int stencil_width = 3;  ///< layers that WENO5 reads

  Box() = default;
  /// `cells` cells from global cell `begin` on. `whole_rows`: this block and all that it exchanges ghosts with have all
  /// of x, so that in a periodic x the ghosts of a row are filled from its other end.
  Box(const DomainShape &domain, const Int3 &begin, const Int3 &cells, int ghosts, bool whole_rows = false);

  const DomainShape &domain_shape() const { return domain_; }
  const Int3 &domain_cells() const { return domain_.cells; }
  double domain_cell_count() const { return double(domain_.cells[0]) * domain_.cells[1] * domain_.cells[2]; }
  int dimension() const { return domain_.dimension(); }
  Boundary boundary(int d) const { return domain_.boundary[d]; }
  /// Whether the domain ends in direction d, at a side of any kind (field/sides.hpp).
  bool is_wall(int d) const { return domain_.is_wall(d); }
  bool is_open(int d, bool high) const { return is_wall(d) && domain_.open[d][high]; }
  /// Whether the pressure is given on any side; elsewhere its mean is free.
  bool any_open() const;
  struct Side {
    int d;
    bool high;
  };
  /// All sides of the domain, low before high.
  std::vector<Side> sides() const;
  /// A global index along d, mapped into the domain where d is periodic.
  int image(int d, int i) const;

  const Real3 &spacing() const { return spacing_; }
  InverseSquares inverse_squares() const;
  double cell_volume() const;  ///< area in 2-D

  const Layout &layout() const { return layout_; }
  /// Without ghosts.
  const Int3 &cells() const { return layout_.cells; }
  double cell_count() const { return double(layout_.cells[0]) * layout_.cells[1] * layout_.cells[2]; }
  /// Whether the block has all cells of the domain along d.
  bool spans(int d) const { return layout_.cells[d] == domain_.cells[d]; }
  bool whole_rows() const { return whole_rows_; }
  /// Whether the ghosts of a row are its other end.
  bool wraps_x() const { return domain_.boundary[0] == Boundary::periodic && whole_rows_; }
  bool touches_low(int d) const { return is_wall(d) && layout_.begin[d] == 0; }
  bool touches_high(int d) const { return is_wall(d) && layout_.begin[d] + layout_.cells[d] == domain_.cells[d]; }
  bool touches(int d, bool high) const { return high ? touches_high(d) : touches_low(d); }

  /// One past the last point of a field along d: the cells, and one more where the field is staggered and the block
  /// touches the high side of the domain.
  int points_end(int d, bool staggered) const { return layout_.cells[d] + (staggered && touches_high(d) ? 1 : 0); }
  /// All points of a field in the block.
  Extent points(const Staggering &at) const {
    return {{0, 0, 0}, {points_end(0, at[0]), points_end(1, at[1]), points_end(2, at[2])}};
  }
  struct Range {
    int begin, end;
  };
  /// Local indices along d of the points of a field in the block and `layers` of its ghosts (at most all of them),
  /// without those behind sides of the domain.
  Range points_near(int d, bool staggered, int layers) const;
  /// The faces on a side of the domain, if the block touches it. Loops over rows() do not reach those of a high side,
  /// index N.
  std::vector<Segment> faces_on(int d, bool high) const;
  /// The faces on the high side of direction d if it is open, else none.
  std::vector<Segment> open_high_faces(int d) const {
    return is_open(d, true) ? faces_on(d, true) : std::vector<Segment>();
  }
  /// The cells within `layers` of a side of the domain, if the block touches it.
  std::vector<Segment> cells_at(int d, bool high, int layers) const;
  /// All rows, whole.
  std::vector<Segment> rows() const;

private:
  DomainShape domain_;
  Real3 spacing_{};
  bool whole_rows_ = false;
  Layout layout_;
};

/// visit(i, j, k) for all points of a block, x fastest.
template <class Visit>
void for_points(const Extent &block, Visit visit) {
  for (int k = block.begin[2]; k < block.end[2]; ++k)
    for (int j = block.begin[1]; j < block.end[1]; ++j)
      for (int i = block.begin[0]; i < block.end[0]; ++i) visit(i, j, k);
}
/// visit(i, j, k) for all points of these rows.
template <class Visit>
void for_points(const std::vector<Segment> &rows, Visit visit) {
  for (const Segment &row : rows)
    for (int i = row.i_begin; i < row.i_end; ++i) visit(i, row.j, row.k);
}

}  // namespace eulastic
