#include "bodies/volume_fraction.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

constexpr int max_depth = 3;
constexpr int fraction_bits = 50;  // phi = 1 is 2^50

double snap(double cells) { return std::ldexp(std::round(std::ldexp(cells, 36)), -36); }

}  // namespace

// Scardovelli & Zaleski, J. Comput. Phys. 164 (2000) 228.
double half_space_fraction(double level, const Real3 &slopes) noexcept {
  double m1 = std::abs(slopes[0]), m2 = std::abs(slopes[1]), m3 = std::abs(slopes[2]);
  if (m1 > m2) std::swap(m1, m2);
  if (m2 > m3) std::swap(m2, m3);
  if (m1 > m2) std::swap(m1, m2);
  const double sum = m1 + m2 + m3;
  if (!(std::abs(level) < sum / 2)) return level < 0 ? 1 : 0;
  m1 = m1 < 1e-7 * sum ? 0 : m1 / sum;  // below, m1 m2 m3 would drown in round-off; the error is its square
  m2 = m2 < 1e-7 * sum ? 0 : m2 / sum;
  m3 = 1 - m1 - m2;
  const double a = 0.5 - std::abs(level) / sum, m12 = m1 + m2;  // cut off at the corner, a <= 1/2
  const auto corner = [a](double m) { return m * m * (m - 3 * a); };
  double v;
  if (a < m1)
    v = a * a * a / (6 * m1 * m2 * m3);
  else if (a < m2)
    v = a * (a - m1) / (2 * m2 * m3) + m1 * m1 / (6 * m2 * m3);
  else if (a < std::min(m12, m3))
    v = (a * a * (3 * m12 - a) + corner(m1) + corner(m2)) / (6 * m1 * m2 * m3);
  else if (m3 < m12)
    v = (a * a * (3 - 2 * a) + corner(m1) + corner(m2) + corner(m3)) / (6 * m1 * m2 * m3);
  else
    v = (2 * a - m12) / (2 * m3);
  return level < 0 ? 1 - v : v;
}

PlacedBody::PlacedBody(const Surface &surface, const DomainShape &grid, const BodyPlace &place)
    : surface_(surface),
      dimension_(grid.dimension()),
      cells_(grid.cells),
      spacing_{},
      middle_{},
      rotation_(rotation(place.orientation)) {
  double square = 0;
  end_ = cells_;
  for (int d = 0; d < dimension_; ++d) {
    spacing_[d] = grid.length[d] / cells_[d];
    square += spacing_[d] * spacing_[d];
    middle_[d] = snap((place.centre[d] - grid.length[d] / 2) / spacing_[d]);
    const double extent = surface.support(rotation_[d]) / spacing_[d], centre = middle_[d] + 0.5 * cells_[d];
    if (!std::isfinite(extent)) continue;
    ends_[d] = true;
    has_images_[d] = grid.boundary[d] == Boundary::periodic;
    begin_[d] = static_cast<int>(std::floor(centre - extent)) - 1;
    end_[d] = static_cast<int>(std::ceil(centre + extent)) + 1;
  }
  half_diagonal_ = std::sqrt(square) / 2;
}

std::vector<PlacedBody::Range> PlacedBody::ranges(int d, int first, int last) const {
  std::vector<Range> result;
  const int images = has_images_[d] ? 1 : 0;
  for (int image = -images; image <= images; ++image) {
    const int shift = image * cells_[d];
    const int begin = std::max(begin_[d] - shift, first), end = std::min(end_[d] - shift, last);
    if (begin < end) result.push_back({begin, end, shift});
  }
  return result;
}

Real3 PlacedBody::body_coordinates(const Real3 &r) const noexcept {
  const double x = r[0] * spacing_[0], y = r[1] * spacing_[1], z = r[2] * spacing_[2];
  const Rotation &q = rotation_;
  return {q[0][0] * x + q[1][0] * y + q[2][0] * z, q[0][1] * x + q[1][1] * y + q[2][1] * z,
          q[0][2] * x + q[1][2] * y + q[2][2] * z};
}

// Returns the volume inside the body of the piece of depth `depth` around r (in cells from the body), in units of
// 2^-fraction_bits.
std::int64_t PlacedBody::inside(const Real3 &r, int depth) const noexcept {
  const std::int64_t full = std::int64_t{1} << (fraction_bits - dimension_ * depth);
  const Real3 y = body_coordinates(r);
  const double middle = surface_.level(y), width = std::ldexp(1.0, -depth), reach = half_diagonal_ * width;
  if (std::abs(middle) >= surface_.slope(y, reach) * reach) return middle < 0 ? full : 0;
  if (depth < max_depth) {
    std::int64_t sum = 0;
    for (int c = 0; c < 1 << dimension_; ++c) {
      Real3 centre = r;
      for (int d = 0; d < dimension_; ++d) centre[d] += (c >> d & 1 ? 0.25 : -0.25) * width;
      sum += inside(centre, depth + 1);
    }
    return sum;
  }
  double mean = middle;
  Real3 slopes{};
  for (int d = 0; d < dimension_; ++d) {
    Real3 low = r, high = r;
    low[d] -= width / 2;
    high[d] += width / 2;
    const double below = surface_.level(body_coordinates(low)), above = surface_.level(body_coordinates(high));
    mean += ((below + above) - 2 * middle) / 6;
    slopes[d] = above - below;
  }
  return std::llround(half_space_fraction(mean, slopes) * static_cast<double>(full));
}

// Returns the centre of a cell relative to that of the body, in cells.
Real3 PlacedBody::from_body(const Int3 &cell) const noexcept {
  Real3 r{};
  for (int d = 0; d < dimension_; ++d) r[d] = (cell[d] + 0.5 - 0.5 * cells_[d]) - middle_[d];
  return r;
}

bool PlacedBody::is_clear_of(const Int3 &cell) const noexcept {
  const Real3 y = body_coordinates(from_body(cell));
  return surface_.level(y) >= surface_.slope(y, half_diagonal_) * half_diagonal_;
}

double PlacedBody::level(const Real3 &place) const noexcept {
  Real3 r{};
  for (int d = 0; d < dimension_; ++d) r[d] = place[d] - middle_[d];
  return surface_.level(body_coordinates(r));
}

double PlacedBody::fraction(const Int3 &cell) const noexcept {
  return std::ldexp(static_cast<double>(inside(from_body(cell), 0)), -fraction_bits);
}

// Sums the fractions of the cells of a box around the body.
RigidMass moments(const Surface &surface, int dimension) {
  constexpr int cells = 96;
  DomainShape box;
  box.cells = {1, 1, 1};
  box.boundary = {Boundary::wall, Boundary::wall, Boundary::wall};
  Real3 h{};
  double volume = 1;
  for (int d = 0; d < dimension; ++d) {
    Real3 n{};
    n[d] = 1;
    box.cells[d] = cells;
    box.length[d] = 2.1 * surface.support(n);
    h[d] = box.length[d] / cells;
    volume *= h[d];
  }
  const PlacedBody body(surface, box, {{box.length[0] / 2, box.length[1] / 2, box.length[2] / 2}, {}});
  RigidMass sum;
  for_points({{}, box.cells}, [&](int i, int j, int k) {
    const Int3 cell{i, j, k};
    const double part = body.fraction(cell) * volume;
    Real3 r{};
    for (int d = 0; d < dimension; ++d) r[d] = (cell[d] + 0.5 - 0.5 * cells) * h[d];
    sum.volume += part;
    for (int d = 0; d < dimension; ++d) sum.second[d] += part * (r[d] * r[d] + h[d] * h[d] / 12);
    for (int d = 0; d < 3; ++d) {
      sum.first[d] += part * r[d];
      sum.second[3 + d] += part * r[(d + 1) % 3] * r[(d + 2) % 3];
    }
  });
  return sum;
}

}  // namespace eulastic
