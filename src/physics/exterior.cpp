#include "physics/exterior.hpp"

#include "base/events.hpp"
#include "kernels/stencils.hpp"

namespace eulastic {
namespace {

constexpr unsigned char outside = 255;

// A box of local points around the owned ones, widened by `reach` where there is something to read: everywhere but
// behind walls.
struct Reach {
  Int3 begin{}, end{};
  Reach(const Grid &grid, const Staggering &at, int reach) {
    for (int d = 0; d < 3; ++d) {
      const int ghosts = grid.layout().ghosts[d] > 0 ? reach : 0;
      begin[d] = grid.touches_low(d) ? 0 : -ghosts;
      end[d] = grid.touches_high(d) ? grid.points_end(d, at[d]) : grid.owned()[d] + ghosts;
    }
  }
  bool contains(const Int3 &p) const {
    return p[0] >= begin[0] && p[0] < end[0] && p[1] >= begin[1] && p[1] < end[1] && p[2] >= begin[2] && p[2] < end[2];
  }
};

// Whether the way from mask[0] leads towards the body beyond the neighbour.
bool leads_in(const unsigned char *mask, std::ptrdiff_t step) {
  return mask[2 * step] == 0 || mask[2 * step] < mask[step];
}

struct Point {
  Int3 index;
  std::ptrdiff_t offset;
};

// What the neighbour at `step` says of b[0]: its own value, or the line through it and the next.
double extended(const double *b, std::ptrdiff_t step, bool linear) {
  return linear ? 2 * b[step] - b[2 * step] : b[step];
}

}  // namespace

PetscErrorCode ExteriorLayers::build(const Grid &grid, const Phase &phase) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::exterior);
  if (locations_.empty()) {
    locations_.emplace_back();
    for (const TensorComponent &c : tensor_components(grid.dimension()))
      if (c.a != c.b) {
        locations_.emplace_back();
        locations_.back().staggering = c.staggering();
      }
  }
  linear_ = phase.material.attached;
  mask_.resize(static_cast<std::size_t>(grid.layout().size));
  for (Location &location : locations_) build_location(grid, phase, &location);
  PetscFunctionReturn(0);
}

void ExteriorLayers::build_location(const Grid &grid, const Phase &phase, Location *location) {
  const ConstView fraction = phase.fraction[0];
  const EvolveRule &rule = evolve_rule_of(phase.material);
  const Layout &layout = grid.layout();
  const Staggering &at = location->staggering;
  unsigned char *mask = mask_.data();
  std::ptrdiff_t step[2] = {0, 0};
  int steps = 0;
  for (int d = 0; d < 3; ++d)
    if (at[d]) step[steps++] = fraction.stride(d);
  // Edges see one centre further down: four layers of them are as far as five layers of centres allow.
  const Reach all(grid, at, layers);
  for (int k = all.begin[2]; k < all.end[2]; ++k)
    for (int j = all.begin[1]; j < all.end[1]; ++j) {
      const double *phi = fraction.row(j, k);
      unsigned char *row = mask + layout.offset(0, j, k);
      for (int i = all.begin[0]; i < all.end[0]; ++i) {
        const bool evolves = steps ? kernels::average4(phi + i, -step[0], -step[1]) >= rule.edge
                                   : phi[i] >= rule.centre;
        row[i] = evolves ? 0 : outside;
      }
    }
  const std::ptrdiff_t stride[3] = {1, layout.sy, layout.sz};
  std::vector<Point> front, next;
  // Claims the unclaimed face neighbours of a point for layer L.
  const auto claim = [&](const Int3 &from, const Reach &box, unsigned char L) {
    for (int d = 0; d < grid.dimension(); ++d)
      for (const int side : {-1, 1}) {
        Point p{from, 0};
        p.index[d] += side;
        if (p.index[d] < box.begin[d] || p.index[d] >= box.end[d]) continue;
        p.offset = layout.offset(p.index[0], p.index[1], p.index[2]);
        if (mask[p.offset] != outside || !box.contains(p.index)) continue;
        mask[p.offset] = L;
        next.push_back(p);
      }
  };
  for (int L = 1; L <= layers; ++L) {
    const Reach box(grid, at, layers - L);
    next.clear();
    if (L == 1) {
      for (int k = all.begin[2]; k < all.end[2]; ++k)
        for (int j = all.begin[1]; j < all.end[1]; ++j) {
          const unsigned char *row = mask + layout.offset(0, j, k);
          for (int i = all.begin[0]; i < all.end[0]; ++i)
            if (row[i] == 0) claim({i, j, k}, box, 1);
        }
    } else {
      for (const Point &point : front) claim(point.index, box, static_cast<unsigned char>(L));
    }
    std::vector<Entry> &entries = location->layer[L - 1];
    entries.clear();
    const Reach owned(grid, at, 0);
    for (const Point &point : next) {
      if (linear_ && !owned.contains(point.index)) continue;
      const std::ptrdiff_t p = point.offset;
      unsigned neighbours = 0, second = 0;
      for (int d = 0; d < grid.dimension(); ++d) {
        const unsigned low = 1u << (2 * d), high = 2u << (2 * d);
        const int i = point.index[d];
        if (i > all.begin[d] && mask[p - stride[d]] < L) neighbours |= low;
        if (i + 1 < all.end[d] && mask[p + stride[d]] < L) neighbours |= high;
        if (!linear_) continue;
        if (neighbours & low && i > all.begin[d] + 1 && leads_in(mask + p, -stride[d])) second |= low;
        if (neighbours & high && i + 2 < all.end[d] && leads_in(mask + p, stride[d])) second |= high;
      }
      entries.push_back({p, static_cast<unsigned char>(neighbours), static_cast<unsigned char>(second)});
    }
    front.swap(next);
  }
}

PetscErrorCode ExteriorLayers::extend(const Grid &grid, GhostExchange &exchange, FieldBlock &tensor) const {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::exterior);
  const Layout &layout = grid.layout();
  const std::ptrdiff_t stride[3] = {1, layout.sy, layout.sz};
  const auto &components = tensor_components(grid.dimension());
  for (int L = 1; L <= layers; ++L) {
    int next_edge = 1;
    for (int c = 0; c < tensor.count(); ++c) {
      const Location &location = locations_[components[c].a == components[c].b ? 0 : next_edge++];
      double *B = tensor.data() + c * layout.size;
      for (const Entry &entry : location.layer[L - 1]) {
        double sum = 0;
        int count = 0;
        for (int d = 0; d < grid.dimension(); ++d) {
          const int low = entry.neighbours >> (2 * d) & 1, high = entry.neighbours >> (2 * d + 1) & 1;
          const double *b = B + entry.offset;
          const double from_low = low ? extended(b, -stride[d], entry.second >> (2 * d) & 1) : 0;
          const double from_high = high ? extended(b, stride[d], entry.second >> (2 * d + 1) & 1) : 0;
          sum += from_low + from_high;  // the pair first: a mirrored scene gives the mirrored bits
          count += low + high;
        }
        B[entry.offset] = sum / count;
      }
    }
    if (linear_ && L < layers) PetscCall(exchange.update(tensor, 2));
  }
  PetscFunctionReturn(0);
}

double ExteriorLayers::points() const noexcept {
  double sum = 0;
  for (const Location &location : locations_)
    for (const auto &entries : location.layer) sum += double(entries.size());
  return sum;
}

}  // namespace eulastic
