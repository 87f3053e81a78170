#include "bodies/solid_mask.hpp"

#include <cmath>

namespace eulastic {
namespace {

ConvexBody cell_of(const DomainShape &grid) {
  Real3 half{};
  for (int d = 0; d < grid.dimension(); ++d) half[d] = grid.spacing(d) / 2;
  return ConvexBody(half);
}

}  // namespace

SolidMask::SolidMask(const DomainShape &grid)
    : grid_(grid),
      dimension_(grid.dimension()),
      words_((std::size_t(grid.cells[0]) + 63) / 64),
      bits_(words_ * grid.cells[1] * grid.cells[2]),
      cell_(cell_of(grid)) {
  for (int d = 0; d < 3; ++d) spacing_[d] = grid.spacing(d);
}

void SolidMask::add(const CellWindow &window, ConstView fraction) {
  for_points({{0, 0, 0}, window.size}, [&](int i, int j, int k) {
    const int x = window.begin[0] + i;
    if (fraction(i, j, k) > 0) bits_[word(x, window.begin[1] + j, window.begin[2] + k)] |= std::uint64_t{1} << (x % 64);
  });
}

bool SolidMask::touches(const PlacedConvex &body) const {
  const double reach = body.body->outer_radius() + cell_.outer_radius();
  Int3 begin{}, end{1, 1, 1};
  for (int d = 0; d < dimension_; ++d) {
    begin[d] = static_cast<int>(std::floor((body.centre[d] - reach) / spacing_[d]));
    end[d] = static_cast<int>(std::ceil((body.centre[d] + reach) / spacing_[d]));
    if (grid_.boundary[d] == Boundary::periodic) continue;
    begin[d] = std::max(begin[d], 0);
    end[d] = std::min(end[d], grid_.cells[d]);
  }
  const auto wrapped = [&](int i, int d) { return (i % grid_.cells[d] + grid_.cells[d]) % grid_.cells[d]; };
  for (int k = begin[2]; k < end[2]; ++k)
    for (int j = begin[1]; j < end[1]; ++j) {
      Real3 centre{0, (j + 0.5) * spacing_[1], (k + 0.5) * spacing_[2]};
      if (dimension_ == 2) centre[2] = body.centre[2];
      for (int i = begin[0]; i < end[0];) {  // one piece per periodic image
        const int first = wrapped(i, 0), last = std::min(grid_.cells[0], first + end[0] - i);
        centre[0] = (i - first + 0.5) * spacing_[0];  // centre of cell 0 of this image
        if (row_touches(body, wrapped(j, 1), wrapped(k, 2), centre, first, last)) return true;
        i += last - first;
      }
    }
  return false;
}

bool SolidMask::row_touches(const PlacedConvex &body, int j, int k, const Real3 &centre, int begin, int end) const {
  const double far = body.body->outer_radius() + cell_.outer_radius();
  const double near = body.body->inner_radius() + cell_.inner_radius();
  for (int i = begin; i < end; ++i) {
    const std::uint64_t rest = bits_[word(i, j, k)] >> (i % 64);
    if (rest == 0) i |= 63;  // no bit up to the end of the word
    if ((rest & 1) == 0) continue;
    const PlacedConvex cell{&cell_, {centre[0] + i * spacing_[0], centre[1], centre[2]}, rotation({})};
    double square = 0;
    for (int d = 0; d < 3; ++d) square += std::pow(cell.centre[d] - body.centre[d], 2);
    if (square < near * near) return true;
    if (square < far * far && !separated(cell, body, {})) return true;
  }
  return false;
}

}  // namespace eulastic
