#include "grid/box.hpp"

#include <cstddef>

namespace eulastic {
namespace {

std::ptrdiff_t round_up(std::ptrdiff_t n, std::ptrdiff_t m) { return (n + m - 1) / m * m; }

std::vector<Segment> rows_between(const Int3 &begin, const Int3 &end) {
  std::vector<Segment> rows;
  rows.reserve(std::size_t(end[1] - begin[1]) * std::size_t(end[2] - begin[2]));
  for (int k = begin[2]; k < end[2]; ++k)
    for (int j = begin[1]; j < end[1]; ++j) rows.push_back({begin[0], end[0], j, k});
  return rows;
}

}  // namespace

Box::Box(const DomainShape &domain, const Int3 &begin, const Int3 &cells, int ghosts, bool whole_rows)
    : domain_(domain), whole_rows_(whole_rows) {
  layout_.begin = begin;
  layout_.cells = cells;
  for (int d = 0; d < 3; ++d) {
    spacing_[d] = domain.length[d] / domain.cells[d];
    layout_.ghosts[d] = d < dimension() ? ghosts : 0;
  }
  // Strides that are multiples of 512 B (rows) or 4 KiB (planes) would map to few cache sets. Planes and fields consist
  // of whole rows, so that a message can move whole rows.
  layout_.sy = round_up(cells[0] + 2 * ghosts + is_wall(0), 8);
  if (layout_.sy % 64 == 0) layout_.sy += 8;
  layout_.sz = layout_.sy * (cells[1] + 2 * layout_.ghosts[1] + is_wall(1));
  if (layout_.sz % 512 == 0) layout_.sz += layout_.sy;
  layout_.origin = 8 + layout_.sy * layout_.ghosts[1] + layout_.sz * layout_.ghosts[2];
  layout_.size = layout_.sy + layout_.sz * (cells[2] + 2 * layout_.ghosts[2] + is_wall(2));
  if (layout_.size % 512 == 0) layout_.size += layout_.sy;
}

Box::Range Box::points_with_ghosts(int d, bool staggered, int layers) const {
  const int ghosts = std::min(layers, layout_.ghosts[d]), begin = layout_.begin[d];
  const Range near{-ghosts, layout_.cells[d] + ghosts};
  if (!is_wall(d)) return near;
  const int end = domain_.cells[d] + staggered - begin;
  return {std::max(near.begin, -begin), touches_high(d) ? end : std::min(near.end, end)};
}

InverseSquares Box::inverse_squares() const {
  const auto &[x, y, z] = spacing_;
  return {1 / (x * x), 1 / (y * y), 1 / (z * z)};
}

double Box::cell_volume() const { return spacing_[0] * spacing_[1] * (dimension() == 3 ? spacing_[2] : 1.0); }

bool Box::any_open() const {
  bool any = false;
  for (int d = 0; d < dimension(); ++d) any = any || is_open(d, false) || is_open(d, true);
  return any;
}

std::vector<Segment> Box::boundary_faces(int d, bool high) const {
  Int3 begin{}, end = cells();
  begin[d] = high ? end[d] : 0;
  end[d] = begin[d] + 1;
  return touches(d, high) ? rows_between(begin, end) : std::vector<Segment>();
}

std::vector<Segment> Box::boundary_cells(int d, bool high, int layers) const {
  Int3 begin{}, end = cells();
  (high ? begin : end)[d] = high ? std::max(0, end[d] - layers) : std::min(layers, end[d]);
  return touches(d, high) ? rows_between(begin, end) : std::vector<Segment>();
}

std::vector<Box::BoundaryFace> Box::sides() const {
  std::vector<BoundaryFace> all;
  for (int d = 0; d < 3; ++d)
    for (int high = 0; high < 2 && is_wall(d); ++high) all.push_back({d, high == 1});
  return all;
}

int Box::image(int d, int i) const {
  const int n = domain_.cells[d];
  return is_wall(d) ? i : (i % n + n) % n;
}

std::vector<Segment> Box::rows() const { return rows_between({}, cells()); }

}  // namespace eulastic
