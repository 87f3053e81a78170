// Finds for every row the span of cells outside of which a field is zero, so that routines can skip the rest unread.
#pragma once

#include "base/petsc.hpp"
#include "grid/domain.hpp"

#include <algorithm>
#include <vector>

namespace eulastic {

/// Whether work is skipped where a scene has nothing to compute, which must not change a bit of the result: tests
/// switch it off and compare (tests/same_bits). With true every cell of every row is computed, and work space is filled
/// with a wrong value each time it is leased. Must be called before a grid is created. The default is false.
void set_skip_nothing(bool nothing) noexcept;
bool skips_nothing() noexcept;

/// For every row of cells the span within which a field, such as phi, or the result of a stencil on it can be nonzero.
class OccupiedRows {
public:
  /// Cells of a row, ghosts included: begin <= i < end.
  struct Span {
    int begin, end;
  };

  /// Cells by which spans exceed the ghost width: one for edges and one for the motion within a step.
  static constexpr int beyond_ghosts = 2;

  /// Finds the spans from all of `value`, including ghosts. Previous spans are ignored. Collective.
  PetscErrorCode find(const Domain &domain, ConstView value);
  /// Finds the spans of a field in a box that is complete on this rank and whose ghosts are zero. The rows of ghosts
  /// have spans, too, and spans extend `reach` cells beyond nonzero values. Not collective.
  void find_in_box(const Box &box, ConstView value, int reach);
  /// Updates the spans of find_in_box() after a transport by less than a cell.
  void update_in_box(const Box &box, ConstView value, int reach);
  struct Transported {
    OccupiedRows *rows;
    ConstView value;  ///< the field of these rows
  };
  /// Updates the spans of several fields after a transport by less than a cell, with one reduction. Cells outside the
  /// old spans are zero and are not read; ghost rows are read only if inside() is false. Collective.
  static PetscErrorCode update(const Domain &domain, const std::vector<Transported> &moved);

  /// Extends the spans to contain those of another field on the same grid.
  void join(const OccupiedRows &other);

  /// Returns the span of row (j, k), outside of which all values and all stencils that reach them are zero: it extends
  /// beyond nonzero values by the ghost width and beyond_ghosts. On the grid the span of a ghost row is the whole row,
  /// because values beyond the ghosts are unknown.
  Span span(int j, int k) const noexcept {
    const int y = j - low_y_, z = k - low_z_;
    const bool known = y >= 0 && z >= 0 && y < rows_y_ && z < rows_z_;
    return known ? spans_[y + static_cast<std::size_t>(rows_y_) * z] : unknown_;
  }
  bool idle(int j, int k) const noexcept {
    const Span s = span(j, k);
    return s.begin >= s.end;
  }
  /// Whether point (i, j, k) is in a span.
  bool holds(int i, int j, int k) const noexcept {
    const Span s = span(j, k);
    return i >= s.begin && i < s.end;
  }
  /// Returns the intersection of a segment with the span of its row.
  Segment within(const Segment &row) const noexcept {
    const Span s = span(row.j, row.k);
    return {std::max(row.i_begin, s.begin), std::max({row.i_begin, s.begin, std::min(row.i_end, s.end)}), row.j, row.k};
  }
  /// Returns the part of a segment that contains all nonzero cells of `value`, to within 16 cells. `value` must be zero
  /// outside the spans.
  Segment within(const Segment &row, ConstView value) const noexcept;
  /// Whether on no rank a span comes as close to another rank or to a boundary as the ghost width: then neither
  /// exchanges nor boundary ghosts are needed. For find_in_box(): to a boundary that is not periodic.
  bool inside() const noexcept { return inside_; }

  /// Whether any of the values begin <= i < end is nonzero.
  static bool any(const double *row, int begin, int end) noexcept;
  /// Number of owned cells in spans.
  std::ptrdiff_t cells() const noexcept { return cells_; }

private:
  void count() noexcept;
  struct Reading {
    int reach;
    bool complete;  ///< the box is complete on this rank
  };
  void read(const Box &box, ConstView value, const OccupiedRows &before, const Reading &reading);

  static constexpr int far = 1 << 30;
  int low_y_ = 0, low_z_ = 0;    ///< first row of spans_
  int rows_y_ = 0, rows_z_ = 0;  ///< number of rows of spans_
  Int3 cells_of_box_{};
  Span unknown_{-far, far};  ///< span of all other rows
  std::vector<Span> spans_;
  bool inside_ = false;
  std::ptrdiff_t cells_ = 0;
};

}  // namespace eulastic
