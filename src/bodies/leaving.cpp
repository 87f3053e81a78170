#include "bodies/leaving.hpp"

#include "bodies/near_bodies.hpp"

#include <algorithm>

namespace eulastic {
namespace {

// work(i, j, k) for the owned cells within so many of a side, if this rank touches it.
template <class Work>
void for_cells_at(const Grid &grid, int d, bool high, int layers, const Work &work) {
  if (!(high ? grid.touches_high(d) : grid.touches_low(d))) return;
  Int3 begin{}, end = grid.owned();
  if (high)
    begin[d] = std::max(0, end[d] - layers);
  else
    end[d] = std::min(layers, end[d]);
  for (int k = begin[2]; k < end[2]; ++k)
    for (int j = begin[1]; j < end[1]; ++j)
      for (int i = begin[0]; i < end[0]; ++i) work(i, j, k);
}

}  // namespace

bool has_solid(const Grid &grid, ConstView fraction, int d, bool high, int layers, double more_than) {
  bool any = false;
  for_cells_at(grid, d, high, layers, [&](int i, int j, int k) { any = any || fraction(i, j, k) > more_than; });
  return any;
}

bool leave_whole(const Material &material) {
  return material.is_membrane() || material.surface_tension > 0 || material.viscosity > 0;
}

void mark_staying(const Grid &grid, int layers, const Phase &phase, std::vector<int> *leaves) {
  const BodyCells cells{phase.label[0], phase.fraction[0]};
  Int3 begin{}, end = grid.owned();
  for (int d = 0; d < grid.dimension(); ++d) {
    const int first = grid.layout().begin[d], last = grid.cells()[d] - layers - first;
    if (grid.is_open(d, false)) begin[d] = std::max(begin[d], layers - first);
    if (grid.is_open(d, true)) end[d] = std::min(end[d], last);
  }
  for (int k = begin[2]; k < end[2]; ++k)
    for (int j = begin[1]; j < end[1]; ++j)
      for (int i = begin[0]; i < end[0]; ++i)
        if (const double label = cells(i, j, k); label > 0 && (*leaves)[static_cast<std::size_t>(label)])
          (*leaves)[static_cast<std::size_t>(label)] = 2;
}

void mark_leaving(const Grid &grid, int d, bool high, int layers, bool whole, Phase *phase, std::vector<int> *leaves) {
  const View fraction = phase->fraction[0], label = phase->label[0];
  for_cells_at(grid, d, high, layers, [&](int i, int j, int k) {
    if (!(fraction(i, j, k) > 0)) return;
    if (label(i, j, k) > 0)
      (*leaves)[static_cast<std::size_t>(label(i, j, k))] = 1;
    else if (whole)
      fraction(i, j, k) = 0;
  });
}

void take_out(const Grid &grid, const std::vector<int> &leaves, Phase *phase) {
  const View fraction = phase->fraction[0], label = phase->label[0];
  for (const Segment &row : grid.rows())
    for (int i = row.i_begin; i < row.i_end; ++i) {
      double &name = label(i, row.j, row.k);
      if (!(name > 0 && leaves[static_cast<std::size_t>(name)] == 1)) continue;
      fraction(i, row.j, row.k) = 0;
      name = 0;
    }
}

}  // namespace eulastic
