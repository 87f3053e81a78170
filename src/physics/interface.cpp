#include "physics/interface.hpp"

#include "base/events.hpp"
#include "field/sides.hpp"
#include "grid/threads.hpp"
#include "kernels/thinc.hpp"

#include <algorithm>

namespace eulastic {
namespace {

// Local cells begin <= (i, j, k) < end.
struct Box {
  Int3 begin, end;
  Box grown(int d, int low, int high) const {
    Box box = *this;
    box.begin[d] -= low;
    box.end[d] += high;
    return box;
  }
};

// One direction of one transport; the strides begin with its own.
struct Sweep {
  int direction;
  Box cells;
  double rate;  // dt/h
  std::ptrdiff_t stride[3];
  ConstView velocity;
  View phi, slope, flux, solid;
};

// The pieces of the active segments in a box.
std::vector<Segment> inside(const ActiveSegments &active, const Box &box) {
  std::vector<Segment> pieces;
  for (int k = box.begin[2]; k < box.end[2]; ++k)
    for (int j = box.begin[1]; j < box.end[1]; ++j)
      for (const Segment &s : active.row(j, k)) {
        const Segment piece{std::max(s.i_begin, box.begin[0]), std::min(s.i_end, box.end[0]), j, k};
        if (piece.size() > 0) pieces.push_back(piece);
      }
  return pieces;
}

template <int Dim>
EULASTIC_INLINE void find_slopes(const Sweep &t, const Segment *begin, const Segment *end) {
  for (const Segment *s = begin; s < end; ++s)
    kernels::interface_slope<Dim>(*s, t.phi, t.stride, t.slope.row(s->j, s->k));
}

EULASTIC_CLONES void slopes_2d(const Sweep &t, const Segment *begin, const Segment *end) {
  find_slopes<2>(t, begin, end);
}
EULASTIC_CLONES void slopes_3d(const Sweep &t, const Segment *begin, const Segment *end) {
  find_slopes<3>(t, begin, end);
}
EULASTIC_CLONES void find_fluxes(const Sweep &t, const Segment *begin, const Segment *end) {
  for (const Segment *s = begin; s < end; ++s)
    kernels::interface_flux(*s, t.phi, t.slope, t.velocity, t.stride[0], t.rate, t.flux.row(s->j, s->k));
}
EULASTIC_CLONES void apply_fluxes(const Sweep &t, const Segment *begin, const Segment *end) {
  for (const Segment *s = begin; s < end; ++s)
    kernels::apply_flux(*s, t.flux, t.velocity, t.solid, t.stride[0], t.rate, t.phi.row(s->j, s->k));
}

void sweep_band(const Grid &grid, const Sweep &t, const ActiveSegments &cells, const ActiveSegments &faces) {
  const auto pass = [&](auto kernel, const ActiveSegments &active, const Box &box) {
    in_parts_of(inside(active, box), grid, [&](const Segment *begin, const Segment *end) { kernel(t, begin, end); });
  };
  pass(grid.dimension() == 2 ? slopes_2d : slopes_3d, cells, t.cells.grown(t.direction, 1, 1));
  pass(find_fluxes, faces, t.cells.grown(t.direction, 0, 1));
  pass(apply_fluxes, cells, t.cells);
}

// Directions of a step: every one is first, in the middle and last equally often, and each order is followed by the
// opposite one.
Int3 order_of_directions(int dimension, long step) {
  static constexpr Int3 orders[6] = {{0, 1, 2}, {2, 1, 0}, {1, 2, 0}, {0, 2, 1}, {2, 0, 1}, {1, 0, 2}};
  if (dimension == 3) return orders[step % 6];
  return step % 2 == 0 ? Int3{0, 1, 2} : Int3{1, 0, 2};
}

// The cells each sweep has to move so that the later ones find their neighbours: a sweep along d reads two more
// layers in d and one more in the others. Behind walls only the first layer matters, and that is reflected anew.
std::array<Box, 3> cells_of_sweeps(const Grid &grid, const Int3 &order) {
  std::array<Box, 3> boxes{};
  Int3 layers{};
  for (int s = grid.dimension() - 1; s >= 0; --s) {
    boxes[s] = {{0, 0, 0}, grid.owned()};
    for (int d = 0; d < grid.dimension(); ++d) {
      boxes[s] = boxes[s].grown(d, layers[d], layers[d]);
      layers[d] += d == order[s] ? 2 : 1;
    }
  }
  return boxes;
}

}  // namespace

PetscErrorCode InterfaceTransport::advance(double dt, const FieldBlock &velocity, long step, const OccupiedRows &rows,
                                           FieldBlock &fraction) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::solid_fraction);
  const int dimension = grid_->dimension();
  const Int3 order = order_of_directions(dimension, step);
  const std::array<Box, 3> cells = cells_of_sweeps(*grid_, order);
  WorkSpace::Lease work;
  PetscCall(work_->take("fluxes of the interface", work_fields, &work));
  const View phi = fraction[0], slope = work.fields()[0], flux = work.fields()[1], solid = work.fields()[2];
  fill_wall_ghosts_even(*grid_, at_centre, phi, 1, &rows);
  cells_.build_band(*grid_, phi, rows, dimension);
  faces_.build_faces(*grid_, cells_);
  in_parts_of(cells_.all(), *grid_, [&](const Segment *begin, const Segment *end) {
    for (const Segment *s = begin; s < end; ++s)
      for (int i = s->i_begin; i < s->i_end; ++i) solid(i, s->j, s->k) = phi(i, s->j, s->k) > 0.5;
  });
  for (int s = 0; s < dimension; ++s) {
    const int d = order[s], e = (d + 1) % dimension, f = dimension == 3 ? (d + 2) % 3 : e;
    Sweep sweep{d, cells[s], dt / grid_->spacing()[d], {}, velocity[d], phi, slope, flux, solid};
    for (int r = 0; r < 3; ++r) sweep.stride[r] = phi.stride(r == 0 ? d : r == 1 ? e : f);
    sweep_band(*grid_, sweep, cells_, faces_);
    fill_wall_ghosts_even(*grid_, at_centre, phi, 1, &rows);
  }
  const double slope_flops = dimension == 2 ? kernels::interface_slope_flops_2d : kernels::interface_slope_flops_3d;
  scope.flops(dimension * (cells_.points() * (slope_flops + kernels::apply_flux_flops) +
                           faces_.points() * kernels::interface_flux_flops));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
