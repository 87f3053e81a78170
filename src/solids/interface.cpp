#include "solids/interface.hpp"

#include "base/events.hpp"
#include "field/boundaries.hpp"
#include "grid/threads.hpp"
#include "kernels/interface_flux.hpp"

#include <algorithm>
#include <atomic>

namespace eulastic {
namespace {

Extent grown(Extent cells, int d, int low, int high) {
  cells.begin[d] -= low;
  cells.end[d] += high;
  return cells;
}

// Transport along one direction. The strides begin with this direction.
struct DirectionalSplit {
  int direction;
  Extent cells;
  double rate;  // dt/h
  std::ptrdiff_t stride[3];
  ConstView velocity;
  View phi, flux, solid;
};

// The parts of active segments within a block.
std::vector<Segment> inside(const ActiveSegments &active, const Extent &extent) {
  std::vector<Segment> pieces;
  for (int k = extent.begin[2]; k < extent.end[2]; ++k)
    for (int j = extent.begin[1]; j < extent.end[1]; ++j)
      for (const Segment &s : active.row(j, k)) {
        const Segment piece{std::max(s.i_begin, extent.begin[0]), std::min(s.i_end, extent.end[0]), j, k};
        if (piece.size() > 0) pieces.push_back(piece);
      }
  return pieces;
}

EULASTIC_CLONES void uniform_fluxes(const DirectionalSplit &t, const Segment *begin, const Segment *end) {
  for (const Segment *s = begin; s < end; ++s)
    kernels::uniform_flux(*s, t.phi, t.velocity, t.stride[0], t.rate, t.flux.row(s->j, s->k));
}

// Lists the mixed cells of segments and computes their fluxes. Of cells beside the block only the flux into it is
// needed.
template <int Dim>
EULASTIC_INLINE long mixed_fluxes(const DirectionalSplit &t, const Segment *begin, const Segment *end) {
  kernels::MixedCells mixed;
  long planes = 0;
  const auto work = [&] {
    kernels::mixed_flux<Dim>(mixed, t.phi.origin, t.stride, t.velocity.origin, t.rate, t.flux.origin);
    planes += std::exchange(mixed.count, 0);
  };
  const int d = t.direction, first = t.cells.begin[d], last = t.cells.end[d];
  for (const Segment *s = begin; s < end; ++s) {
    const double *q = t.phi.row(s->j, s->k);
    for (int i = s->i_begin; i < s->i_end; ++i) {
      if (!(q[i] > 0 && q[i] < 1)) continue;
      const int place = d == 0 ? i : d == 1 ? s->j : s->k;
      mixed.at[mixed.count] = q + i - t.phi.origin;
      mixed.low[mixed.count] = place >= first;
      mixed.high[mixed.count] = place < last;
      if (++mixed.count == kernels::MixedCells::capacity) work();
    }
  }
  work();
  return planes;
}

EULASTIC_CLONES long mixed_fluxes_2d(const DirectionalSplit &t, const Segment *begin, const Segment *end) {
  return mixed_fluxes<2>(t, begin, end);
}
EULASTIC_CLONES long mixed_fluxes_3d(const DirectionalSplit &t, const Segment *begin, const Segment *end) {
  return mixed_fluxes<3>(t, begin, end);
}
EULASTIC_CLONES void apply_fluxes(const DirectionalSplit &t, const Segment *begin, const Segment *end) {
  for (const Segment *s = begin; s < end; ++s)
    kernels::apply_flux(*s, t.flux, t.velocity, t.solid, t.stride[0], t.rate, t.phi.row(s->j, s->k));
}

// Advances phi along one direction. Returns the number of planes constructed.
long advance_direction(const Box &box, const DirectionalSplit &t, const ActiveSegments &cells,
                       const ActiveSegments &faces) {
  const auto pass = [&](const ActiveSegments &active, const Extent &extent, auto kernel) {
    in_segment_parts(inside(active, extent), box, kernel);
  };
  std::atomic<long> planes{0};
  const auto mixed = box.dimension() == 2 ? mixed_fluxes_2d : mixed_fluxes_3d;
  pass(faces, grown(t.cells, t.direction, 0, 1),
       [&](const Segment *begin, const Segment *end) { uniform_fluxes(t, begin, end); });
  pass(cells, grown(t.cells, t.direction, 1, 1),
       [&](const Segment *begin, const Segment *end) { planes += mixed(t, begin, end); });
  pass(cells, t.cells, [&](const Segment *begin, const Segment *end) { apply_fluxes(t, begin, end); });
  return planes;
}

// Order of the directions in a step: each direction is first, second and last equally often, and each order is followed
// by its reverse.
Int3 order_of_directions(int dimension, long step) {
  static constexpr Int3 orders[6] = {{0, 1, 2}, {2, 1, 0}, {1, 2, 0}, {0, 2, 1}, {2, 0, 1}, {1, 0, 2}};
  if (dimension == 3) return orders[step % 6];
  return step % 2 == 0 ? Int3{0, 1, 2} : Int3{1, 0, 2};
}

// The cells each directional step must advance so that the later ones find their neighbours: a step along d reads two
// more layers in d and one more in the other directions. Behind boundaries only the first layer matters, and it is
// reflected again.
std::array<Extent, 3> cells_of_directions(const Box &box, const Int3 &order) {
  std::array<Extent, 3> boxes{};
  Int3 layers{};
  for (int s = box.dimension() - 1; s >= 0; --s) {
    boxes[s] = {{0, 0, 0}, box.cells()};
    for (int d = 0; d < box.dimension(); ++d) {
      boxes[s] = grown(boxes[s], d, layers[d], layers[d]);
      layers[d] += d == order[s] ? 2 : 1;
    }
  }
  return boxes;
}

}  // namespace

PetscErrorCode InterfaceTransport::advance(const Box &box, double dt, const Field &velocity, long step,
                                           const OccupiedRows &rows, Field &fraction, Field &work) {
  PetscFunctionBeginUser;
  EventScope scope(Event::solid_fraction);
  const int dimension = box.dimension();
  const Int3 order = order_of_directions(dimension, step);
  const std::array<Extent, 3> cells = cells_of_directions(box, order);
  const View phi = fraction[0], flux = work[0], solid = work[1];
  fill_wall_ghosts_even(box, at_centre, phi, 1, &rows);
  cells_.build_band(box, phi, rows, dimension);
  faces_.build_faces(box, cells_);
  in_segment_parts(cells_.all(), box, [&](const Segment *begin, const Segment *end) {
    for (const Segment *s = begin; s < end; ++s)
      for (int i = s->i_begin; i < s->i_end; ++i) solid(i, s->j, s->k) = phi(i, s->j, s->k) > 0.5;
  });
  planes_ = 0;
  for (int s = 0; s < dimension; ++s) {
    const int d = order[s], e = (d + 1) % dimension, f = dimension == 3 ? (d + 2) % 3 : e;
    DirectionalSplit split{d, cells[s], dt / box.spacing()[d], {}, velocity[d], phi, flux, solid};
    for (int r = 0; r < 3; ++r) split.stride[r] = phi.stride(r == 0 ? d : r == 1 ? e : f);
    planes_ += static_cast<double>(advance_direction(box, split, cells_, faces_));
    fill_wall_ghosts_even(box, at_centre, phi, 1, &rows);
  }
  scope.flops(dimension *
                  (cells_.points() * kernels::apply_flux_flops + faces_.points() * kernels::uniform_flux_flops) +
              planes_ * (dimension == 2 ? kernels::mixed_flux_flops_2d : kernels::mixed_flux_flops_3d));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
