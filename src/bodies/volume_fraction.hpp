// The volume fraction phi of a placed body in a cell.
//
// Cells the surface may pass are halved three times; the pieces are cut by a plane that has the piece's mean level
// and gradient (Simpson), so that the error of curvature cancels on average: a sphere of 8 cells radius has its volume
// to 3e-7. Volumes are added as integers and positions are multiples of 2^-36 cells from the middle of the box:
// mirrored or shifted scenes give the same bits, and faces on cell faces give exactly 0 and 1.
#pragma once

#include "bodies/placement.hpp"
#include "bodies/shapes.hpp"

#include <cstdint>
#include <vector>

namespace eulastic {

/// Part of a unit cube where level + slopes . x < 0, x from its centre; the cube's edges are scaled into `slopes`.
double half_space_fraction(double level, const Real3 &slopes) noexcept;

class PlacedBody {
public:
  PlacedBody(const Surface &surface, const DomainShape &grid, const BodyPlace &place);

  /// Cells of the box; the body has them at begin + shift, not wrapped into a periodic box.
  struct Range {
    int begin, end, shift;
  };
  /// Cells first <= i < last of direction d that the body may touch, in every periodic image.
  std::vector<Range> ranges(int d, int first, int last) const;
  /// visit(cell, unwrapped) for the cells first <= cell < first + size that the body may touch, once for every image;
  /// `unwrapped`: where the body has it.
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
  /// Cells of direction d that the body may touch, not wrapped into the domain nor cut at its sides.
  Range extent(int d) const { return {begin_[d], end_[d], 0}; }
  /// Whether the surface cannot pass a global, unwrapped cell, and the cell is outside: cheaper than its fraction.
  bool is_clear_of(const Int3 &cell) const noexcept;
  /// Negative inside, at a place in cells from the middle of the box.
  double level(const Real3 &place) const noexcept;
  /// Whether the body ends in direction d; and its centre, in cells from the middle of the box.
  bool ends(int d) const noexcept { return ends_[d]; }
  const Real3 &centre() const noexcept { return middle_; }
  /// phi of a global, unwrapped cell, 0 ... 1.
  double fraction(const Int3 &cell) const noexcept;

private:
  Real3 from_body(const Int3 &cell) const noexcept;
  Real3 body_coordinates(const Real3 &r) const noexcept;
  std::int64_t inside(const Real3 &r, int depth) const noexcept;

  const Surface &surface_;
  int dimension_;
  Int3 cells_;
  Real3 spacing_, middle_;  ///< middle_: body centre from box centre, in cells
  double half_diagonal_;    ///< of a cell
  Rotation rotation_;
  Int3 begin_{}, end_{};
  std::array<bool, 3> ends_{}, has_images_{};
};

/// Of a closed body, in its own coordinates.
RigidMass moments(const Surface &surface, int dimension);

}  // namespace eulastic
