#include "bodies/packing.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

// Rows run along direction `row`. Successive rows along `next` are closer together and shifted by half a distance;
// next < 0: a lattice of bounding boxes without a shift.
struct LatticeStyle {
  int row, next;
};

std::vector<LatticeStyle> lattice_styles(const PlacedConvex &body, int dimension) {
  std::vector<LatticeStyle> list{{0, -1}};
  bool aligned = true;
  for (const Real3 &row : body.rotation)
    for (double q : row) aligned = aligned && (q == 0 || std::abs(q) == 1);
  if (!aligned) return list;
  for (int across = 0; across < 3; ++across) {
    int axis = 0;  // the body axis that lies along direction `across` of the domain
    for (int d = 0; d < 3; ++d)
      if (body.rotation[across][d] != 0) axis = d;
    const int a = (across + 1) % 3, b = (across + 2) % 3;
    if (a >= dimension || b >= dimension || !body.body->has_round_shadow(axis)) continue;
    list.push_back({a, b});
    list.push_back({b, a});
  }
  return list;
}

class Lattice {
public:
  Lattice(const Region &region, const DomainShape &grid, const PlacedConvex &body, const LatticeStyle &style,
          const Int3 &offset, double stretch)
      : region_(region), grid_(grid), body_(body), style_(style), stretch_(stretch) {
    for (int d = 0; d < 3; ++d) {
      x_[d] = {body.centre[d]};
      if (d < grid.dimension()) x_[d] = coordinates(d, offset[d]);
    }
  }

  template <class Visit>
  void for_each_site(Visit &&visit) const {
    for (std::size_t k = 0; k < x_[2].size(); ++k)
      for (std::size_t j = 0; j < x_[1].size(); ++j)
        for (std::size_t i = 0; i < x_[0].size(); ++i) {
          const std::size_t index[3] = {i, j, k};
          Real3 x{x_[0][i], x_[1][j], x_[2][k]};
          if (style_.next >= 0 && index[style_.next] % 2 == 1) x[style_.row] += step_ / 2;
          visit(x);
        }
  }

private:
  std::vector<double> coordinates(int d, int offset) {
    const double half = body_.half_width(d), low = region_.low(d), high = region_.high(d);
    const bool closer = d == style_.next;
    double step = 2 * half * stretch_ * (closer ? std::sqrt(0.75) : 1);
    std::vector<double> x;
    if (region_.is_round(d)) {  // from the middle outwards
      const int rows = static_cast<int>((high - low) / step) / 2 + 1;
      for (int n = -rows; n <= rows; ++n) x.push_back((low + high) / 2 + (n + 0.5 * offset) * step);
    } else if (grid_.boundary[d] == Boundary::periodic && high - low == grid_.length[d]) {
      int rows = static_cast<int>((high - low) / step * (1 + 1e-12));
      if (closer && rows > 1) rows -= rows % 2;
      step = (high - low) / std::max(rows, 1);
      for (int n = 0; n < rows; ++n) x.push_back(low + (n + 0.5) * step);
    } else if (high - low >= 2 * half) {
      const int more = static_cast<int>((high - low - 2 * half) / step * (1 + 1e-12));
      step = more > 0 ? (high - low - 2 * half) / more : 0;
      for (int n = 0; n <= more; ++n) x.push_back(more > 0 ? low + half + n * step : (low + high) / 2);
    }
    if (d == style_.row) step_ = step;
    return x;
  }

  const Region &region_;
  const DomainShape &grid_;
  const PlacedConvex &body_;
  LatticeStyle style_;
  double stretch_;
  std::vector<double> x_[3];
  double step_ = 0;  // along rows
};

// Returns the factor, at least 1, by which a lattice of bounding boxes may be widened and still have about four times
// `enough` sites.
double stretch_for(const Region &region, const PlacedConvex &body, int dimension, std::size_t enough) {
  double free = region.volume() / std::max(1.0, 4.0 * double(enough));
  for (int d = 0; d < dimension; ++d) free /= 2 * body.half_width(d);
  return std::max(1.0, dimension == 2 ? std::sqrt(free) : std::cbrt(free));
}

}  // namespace

std::vector<BodyPlace> find_packing(const Region &region, const Crowd &crowd, const DomainShape &grid,
                                    const ConvexBody &shape, const std::vector<Real3> &orientations,
                                    std::size_t enough) {
  std::vector<BodyPlace> best, sites;
  const int dimension = grid.dimension();
  Int3 offsets{1, 1, 1};
  for (int d = 0; d < 3; ++d)
    if (region.is_round(d)) offsets[d] = 2;
  for (const bool wide : {true, false})
    for (const Real3 &orientation : orientations) {
      PlacedConvex body{&shape, {}, rotation(orientation)};
      body.centre[2] = grid.length[2] / 2;
      const double stretch = wide ? stretch_for(region, body, dimension, enough) : 1;
      if (wide && stretch == 1) continue;
      for (const LatticeStyle &style : lattice_styles(body, dimension))
        for (int o = 0; o < offsets[0] * offsets[1] * offsets[2]; ++o) {
          const Int3 offset{o % offsets[0], o / offsets[0] % offsets[1], o / (offsets[0] * offsets[1])};
          sites.clear();
          Lattice(region, grid, body, style, offset, stretch).for_each_site([&](const Real3 &x) {
            PlacedConvex there = body;
            there.centre = x;
            for (int d = 0; d < 3; ++d) {
              if (!region.is_round(d) && grid.boundary[d] == Boundary::periodic && x[d] >= grid.length[d])
                there.centre[d] -= grid.length[d];
              if (there.centre[d] < 0 || there.centre[d] > grid.length[d]) return;
            }
            if (region.holds(there) && crowd.has_room_for(there)) sites.push_back({there.centre, orientation});
          });
          if (sites.size() > best.size()) best = sites;
          if (best.size() >= enough) return best;
        }
    }
  return best;
}

}  // namespace eulastic
