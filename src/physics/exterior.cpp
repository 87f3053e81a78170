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
  mask_.assign(static_cast<std::size_t>(grid.layout().size), outside);
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
  for (int L = 1; L <= layers; ++L) {
    std::vector<Entry> &entries = location->layer[L - 1];
    entries.clear();
    const Reach box(grid, at, layers - L);
    for (int k = box.begin[2]; k < box.end[2]; ++k)
      for (int j = box.begin[1]; j < box.end[1]; ++j) {
        const std::ptrdiff_t row = layout.offset(0, j, k);
        for (int i = box.begin[0]; i < box.end[0]; ++i) {
          const std::ptrdiff_t p = row + i;
          if (mask[p] != outside) continue;
          unsigned neighbours = 0, second = 0;
          const Int3 point{i, j, k};
          for (int d = 0; d < grid.dimension(); ++d) {
            const unsigned low = 1u << (2 * d), high = 2u << (2 * d);
            if (point[d] > all.begin[d] && mask[p - stride[d]] < L) neighbours |= low;
            if (point[d] + 1 < all.end[d] && mask[p + stride[d]] < L) neighbours |= high;
            if (!phase.material.attached) continue;
            if (neighbours & low && point[d] > all.begin[d] + 1 && mask[p - 2 * stride[d]] < L) second |= low;
            if (neighbours & high && point[d] + 2 < all.end[d] && mask[p + 2 * stride[d]] < L) second |= high;
          }
          if (neighbours)
            entries.push_back({p, static_cast<unsigned char>(neighbours), static_cast<unsigned char>(second)});
        }
      }
    for (const Entry &entry : entries) mask[entry.offset] = static_cast<unsigned char>(L);
  }
  // Leave the mask clean for the next location.
  for (int k = all.begin[2]; k < all.end[2]; ++k)
    for (int j = all.begin[1]; j < all.end[1]; ++j) {
      unsigned char *row = mask + layout.offset(0, j, k);
      for (int i = all.begin[0]; i < all.end[0]; ++i) row[i] = outside;
    }
}

PetscErrorCode ExteriorLayers::extend(const Grid &grid, FieldBlock &tensor) const {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::exterior);
  const Layout &layout = grid.layout();
  const std::ptrdiff_t stride[3] = {1, layout.sy, layout.sz};
  const auto &components = tensor_components(grid.dimension());
  int next_edge = 1;
  for (int c = 0; c < tensor.count(); ++c) {
    const Location &location = locations_[components[c].a == components[c].b ? 0 : next_edge++];
    double *B = tensor.data() + c * layout.size;
    for (const std::vector<Entry> &entries : location.layer)
      for (const Entry &entry : entries) {
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
  PetscFunctionReturn(0);
}

double ExteriorLayers::points() const noexcept {
  double sum = 0;
  for (const Location &location : locations_)
    for (const auto &entries : location.layer) sum += double(entries.size());
  return sum;
}

}  // namespace eulastic
