#include "bodies/closed_surface.hpp"

#include "bodies/resample.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

namespace eulastic {
namespace {

// A triangle after up to six cuts; each cut multiplies the number of corners by at most 3/2, round-off included.
struct Polygon {
  int n = 0;
  std::array<Real3, 36> corner;
};

// Returns the part with x_d >= plane (side = 1) or <= plane (side = -1): Sutherland and Hodgman, Comm. ACM 17 (1974).
Polygon cut(const Polygon &polygon, int d, double plane, int side) noexcept {
  Polygon result;
  for (int a = 0; a < polygon.n; ++a) {
    const Real3 &p = polygon.corner[a], &q = polygon.corner[a + 1 < polygon.n ? a + 1 : 0];
    const bool p_in = side * (p[d] - plane) >= 0, q_in = side * (q[d] - plane) >= 0;
    if (p_in) result.corner[result.n++] = p;
    if (p_in == q_in) continue;
    // Interpolating from the low end gives the neighbouring triangle the same point on this edge.
    const Real3 &low = p[d] < q[d] ? p : q, &high = p[d] < q[d] ? q : p;
    const double t = (plane - low[d]) / (high[d] - low[d]);
    Real3 &point = result.corner[result.n++];
    for (int e = 0; e < 3; ++e) point[e] = low[e] + t * (high[e] - low[e]);
    point[d] = plane;
  }
  return result;
}

// Returns the lowest and the highest coordinate of the corners along d.
std::pair<double, double> ends(const Polygon &polygon, int d) noexcept {
  double low = polygon.corner[0][d], high = low;
  for (int a = 1; a < polygon.n; ++a)
    low = std::min(low, polygon.corner[a][d]), high = std::max(high, polygon.corner[a][d]);
  return {low, high};
}

// Calls visit(c, piece) for the pieces between the cell faces c and c + 1, begin <= c < end. Each is cut out of the
// whole polygon, so that its bits do not depend on `begin`.
template <class Visit>
void for_strips(const Polygon &polygon, int d, int begin, int end, Visit visit) {
  if (polygon.n < 3) return;
  const auto [low, high] = ends(polygon, d);
  const double first = std::floor(low), last = std::max(std::ceil(high), first + 1);
  const int from = static_cast<int>(std::clamp(first, double(begin), double(end)));
  const int to = static_cast<int>(std::clamp(last, double(begin), double(end)));
  for (int c = from; c < to; ++c) {
    if (first == c && last == c + 1.0)
      visit(c, polygon);
    else if (const Polygon piece = cut(cut(polygon, d, c, 1), d, c + 1.0, -1); piece.n >= 3)
      visit(c, piece);
  }
}

struct Projection {
  double area = 0;    // projected along x, positive if the normal's x component is
  double moment = 0;  // integral of x over the projected area
};

Projection project(const Polygon &polygon, double x) noexcept {
  Projection sum;
  const Real3 &o = polygon.corner[0];
  for (int a = 1; a + 1 < polygon.n; ++a) {
    const Real3 &p = polygon.corner[a], &q = polygon.corner[a + 1];
    const double area = ((p[1] - o[1]) * (q[2] - o[2]) - (p[2] - o[2]) * (q[1] - o[1])) / 2;
    sum.area += area;
    sum.moment += area * ((o[0] - x) + (p[0] - x) + (q[0] - x)) / 3;
  }
  return sum;
}

std::uint64_t fixed(double volume) { return static_cast<std::uint64_t>(std::llround(std::ldexp(volume, 50))); }

// Differences of the volumes along x, with one cell more than the window has. Unsigned, so that invalid surfaces wrap
// around without undefined behaviour.
class Volumes {
public:
  explicit Volumes(const CellWindow &window)
      : begin_(window.begin), n_(window.size), sums_((n_[0] + 1) * std::size_t(n_[1]) * n_[2]) {}

  void add(const Polygon &triangle, int sign) {
    for_strips(triangle, 2, begin_[2], begin_[2] + n_[2], [&](int k, const Polygon &in_z) {
      for_strips(in_z, 1, begin_[1], begin_[1] + n_[1], [&](int j, const Polygon &column) {
        const double low = ends(column, 0).first;
        if (low >= begin_[0] + n_[0]) return;
        if (low < 0)  // before the domain: all cells are at higher x
          if (const Polygon before = cut(column, 0, 0, -1); before.n >= 3)
            at(0, j, k) -= sign * fixed(project(before, 0).area);
        for_strips(column, 0, 0, begin_[0] + n_[0], [&](int i, const Polygon &piece) {
          const Projection p = project(piece, i + 1.0);
          const std::uint64_t area = fixed(p.area), volume = fixed(-p.moment);
          at(i, j, k) -= sign * volume;
          at(i + 1, j, k) -= sign * (area - volume);
        });
      });
    });
  }

  double next(int i, int j, int k, std::uint64_t *sum) {
    *sum += at(begin_[0] + i, begin_[1] + j, begin_[2] + k);
    return std::ldexp(double(static_cast<std::int64_t>(*sum)), -50);
  }

private:
  // Cells before the window are accumulated in its first one.
  std::uint64_t &at(int i, int j, int k) {
    const std::size_t row = std::size_t(k - begin_[2]) * n_[1] + (j - begin_[1]);
    return sums_[row * (n_[0] + 1) + std::max(i - begin_[0], 0)];
  }

  Int3 begin_, n_;
  std::vector<std::uint64_t> sums_;
};

}  // namespace

std::string why_not_closed(const std::vector<Triangle> &triangles) {
  using Edge = std::array<std::uint32_t, 2>;
  std::vector<std::uint32_t> order(3 * triangles.size()), name(order.size());
  const auto corner = [&](std::uint32_t n) -> const Real3 & { return triangles[n / 3][n % 3]; };
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return corner(a) < corner(b); });
  for (std::size_t n = 0; n < order.size(); ++n)
    name[order[n]] = n > 0 && corner(order[n]) == corner(order[n - 1]) ? name[order[n - 1]] : std::uint32_t(n);
  std::vector<Edge> forward, backward;  // from the lower to the higher corner, and from the higher to the lower
  for (std::uint32_t n = 0; n < name.size(); ++n) {
    const std::uint32_t a = name[n], b = name[n % 3 == 2 ? n - 2 : n + 1];
    if (a < b) forward.push_back({a, b});
    if (a > b) backward.push_back({b, a});
  }
  std::sort(forward.begin(), forward.end());
  std::sort(backward.begin(), backward.end());
  std::vector<Edge> alone;
  std::set_symmetric_difference(forward.begin(), forward.end(), backward.begin(), backward.end(),
                                std::back_inserter(alone));
  const std::size_t all = forward.size() + backward.size();
  if (alone.empty()) return {};
  return "the surface is open or inconsistent: " + std::to_string(alone.size()) + " of its " + std::to_string(all) +
         " sides of triangles have no partner; accepted: every edge shared by two triangles in opposite directions";
}

double enclosed_volume(const std::vector<Triangle> &triangles) {
  double sum = 0;
  const Real3 o = triangles.empty() ? Real3{} : triangles[0][0];
  for (const Triangle &t : triangles) {
    Triangle r;
    for (int a = 0; a < 3; ++a)
      for (int d = 0; d < 3; ++d) r[a][d] = t[a][d] - o[d];
    sum += r[0][0] * (r[1][1] * r[2][2] - r[1][2] * r[2][1]) + r[0][1] * (r[1][2] * r[2][0] - r[1][0] * r[2][2]) +
           r[0][2] * (r[1][0] * r[2][1] - r[1][1] * r[2][0]);
  }
  return sum / 6;
}

std::string fill_surface(const CellWindow &window, const std::vector<Triangle> &triangles, View fraction) {
  const int sign = enclosed_volume(triangles) < 0 ? -1 : 1;
  Volumes volumes(window);
  for (const Triangle &triangle : triangles) {
    Polygon polygon;
    polygon.n = 3;
    for (int a = 0; a < 3; ++a)
      for (int d = 0; d < 3; ++d) {
        polygon.corner[a][d] = triangle[a][d] / window.spacing(d);
        if (!(std::abs(polygon.corner[a][d]) < 1e9))
          return "a corner is more than 1e9 cells away from the box; accepted: a surface near it";
      }
    volumes.add(polygon, sign);
  }
  for (int k = 0; k < window.size[2]; ++k)
    for (int j = 0; j < window.size[1]; ++j) {
      std::uint64_t sum = 0;
      for (int i = 0; i < window.size[0]; ++i) {
        const double phi = volumes.next(i, j, k, &sum);
        if (!(phi > -1e-9 && phi < 1 + 1e-9))
          return "the surface crosses itself or has parts with opposite normals; accepted: no point inside it twice";
        fraction(i, j, k) = clean_fraction(phi);
      }
    }
  return {};
}

}  // namespace eulastic
