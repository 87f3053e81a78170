// The volume fraction phi of a placed body in a cell.
//
// Cells that the surface may cut are halved three times along each direction. Each piece is cut by the plane with the
// piece's mean level and gradient (Simpson's rule), so that the error of curvature cancels on average: the volume of a
// sphere of 8 cells radius is correct to 3e-7. Volumes are summed as integers, and positions are multiples of 2^-36
// cells from the middle of the domain: mirrored or shifted scenes give the same bits, and surfaces on cell faces give
// exactly 0 and 1.
#pragma once

#include "bodies/placement.hpp"
#include "bodies/shapes.hpp"

#include <cstdint>
#include <vector>

namespace eulastic {

/// Returns the fraction of a unit cube with level + slopes . x < 0, x relative to its centre; the size of the cube is
/// contained in `slopes`.
double half_space_fraction(double level, const Real3 &slopes) noexcept;

/// Depth in cells up to which a face of the grid counts as on a surface, and not as inside, in spite of round-off.
inline constexpr double on_surface = 1e-9;

class PlacedBody {
public:
  PlacedBody(const Surface &surface, const DomainShape &grid, const BodyPlace &place);

  /// A range of cells of the domain; unwrapped, the body has them at begin + shift.
  struct Range {
    int begin, end, shift;
  };
  /// Returns the cells first <= i < last along d that any periodic image of the body may touch.
  std::vector<Range> ranges(int d, int first, int last) const;
  /// Calls visit(cell, unwrapped) for the cells first <= cell < first + size that the body may touch, once per image;
  /// `unwrapped` are the body's own indices of the cell.
  template <class Visit>
  void for_cells(const Int3 &first, const Int3 &size, const Visit &visit) const {
    const auto along = [&](int d) { return ranges(d, first[d], first[d] + size[d]); };
    for (const Range &z : along(2))
      for (const Range &y : along(1))
        for (const Range &x : along(0))
          for (int k = z.begin; k < z.end; ++k)
            for (int j = y.begin; j < y.end; ++j)
              for (int i = x.begin; i < x.end; ++i) visit(Int3{i, j, k}, Int3{i + x.shift, j + y.shift, k + z.shift});
  }
  /// Returns the cells along d that the body may touch, neither wrapped into the domain nor cut at its boundaries.
  Range extent(int d) const { return {begin_[d], end_[d], 0}; }
  /// Returns whether a global, unwrapped cell is certainly outside; cheaper than its fraction.
  bool is_clear_of(const Int3 &cell) const noexcept;
  /// Returns the level, negative inside, at a position in cells from the middle of the domain.
  double level(const Real3 &place) const noexcept;
  /// Whether the body is finite along d.
  bool ends(int d) const noexcept { return ends_[d]; }
  /// Centre in cells from the middle of the domain.
  const Real3 &centre() const noexcept { return middle_; }
  /// Returns phi of a global, unwrapped cell, 0 ... 1.
  double fraction(const Int3 &cell) const noexcept;

private:
  Real3 from_body(const Int3 &cell) const noexcept;
  Real3 body_coordinates(const Real3 &r) const noexcept;
  std::int64_t inside(const Real3 &r, int depth) const noexcept;

  const Surface &surface_;
  int dimension_;
  Int3 cells_;
  Real3 spacing_, middle_;  ///< middle_: centre of the body from that of the domain, in cells
  double half_diagonal_;    ///< of a cell
  Rotation rotation_;
  Int3 begin_{}, end_{};
  std::array<bool, 3> ends_{}, has_images_{};
};

/// Returns volume and moments of a closed body in its own coordinates.
RigidMass moments(const Surface &surface, int dimension);

}  // namespace eulastic
