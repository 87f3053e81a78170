// Where rows of a field hold anything but zeros: what there is to do elsewhere is known without reading it.
#pragma once

#include "base/petsc.hpp"
#include "grid/domain.hpp"

#include <algorithm>
#include <vector>

namespace eulastic {

/// Whether work is skipped where a scene has nothing to compute, which must not change a bit of the result: tests
/// switch it off and compare (tests/same_bits). With true every cell of every row is computed, and work space is filled
/// with a wrong value each time it is leased. Must be set before there is a grid. The default is false.
void set_skip_nothing(bool nothing) noexcept;
bool skips_nothing() noexcept;

class OccupiedRows {
public:
  /// Cells of a row, ghosts included: begin <= i < end.
  struct Span {
    int begin, end;
  };

  /// Cells that spans reach further than ghosts do, one for edges and one for what moves within a step.
  static constexpr int beyond_ghosts = 2;

  /// Reads all of `value`, ghosts included. Before that every row counts as occupied throughout. Collective.
  PetscErrorCode find(const Domain &domain, ConstView value);
  /// The same of a field in a box that is whole on this rank, with nothing in its ghosts: spans are known there, too,
  /// and reach `reach` cells beyond what is not zero. Not collective.
  void find_in_box(const Box &box, ConstView value, int reach);
  /// Those of find_in_box() after a transport by less than a cell.
  void follow_in_box(const Box &box, ConstView value, int reach);
  struct Moved {
    OccupiedRows *rows;
    ConstView value;  ///< the field whose rows they are
  };
  /// Finds the rows of several fields again after a transport by less than a cell, in one reduction: what was outside
  /// the spans is still empty and is not read; ghost rows are not read either if all was inside().
  static PetscErrorCode follow(const Domain &domain, const std::vector<Moved> &moved);

  /// Adds the spans of another field of the grid.
  void join(const OccupiedRows &other);

  /// Outside it row (j, k) and all that stencils join to it are zero: as far as there are ghosts, one as edges belong
  /// to the centres below them too, one for what moves within a step. On the grid all of a ghost row: what comes to it
  /// from beyond is not known.
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
  /// What is in spans of a piece of a row.
  Segment within(const Segment &row) const noexcept {
    const Span s = span(row.j, row.k);
    return {std::max(row.i_begin, s.begin), std::max({row.i_begin, s.begin, std::min(row.i_end, s.end)}), row.j, row.k};
  }
  /// The least of it, but for some cells, that has all that is not zero of `value`, which is zero outside the spans.
  Segment within(const Segment &row, ConstView value) const noexcept;
  /// Whether on no rank a span comes as near to the others, or to a side of the domain, as ghosts see: there is nothing
  /// to exchange, nor behind sides. Of find_in_box(): to a side that is no periodic one.
  bool inside() const noexcept { return inside_; }

  /// Whether one of these values is not zero.
  static bool any(const double *row, int begin, int end) noexcept;
  /// Owned cells in spans.
  std::ptrdiff_t cells() const noexcept { return cells_; }

private:
  void count() noexcept;
  struct Reading {
    int reach;
    bool alone;  ///< the box is whole on this rank
  };
  void read(const Box &box, ConstView value, const OccupiedRows &before, const Reading &reading);

  static constexpr int far = 1 << 30;
  int low_y_ = 0, low_z_ = 0;    ///< first row of spans_
  int rows_y_ = 0, rows_z_ = 0;  ///< those of spans_
  Int3 cells_of_box_{};
  Span unknown_{-far, far};  ///< of other rows
  std::vector<Span> spans_;
  bool inside_ = false;
  std::ptrdiff_t cells_ = 0;
};

}  // namespace eulastic
