#include "physics/surface_cells.hpp"

#include "base/events.hpp"
#include "field/sides.hpp"
#include "grid/row_scratch.hpp"
#include "grid/threads.hpp"
#include "kernels/bending.hpp"
#include "kernels/exp.hpp"
#include "kernels/tensor.hpp"
#include "physics/membrane_tensor.hpp"
#include "physics/smooth_row.hpp"

#include <algorithm>

namespace eulastic {
namespace {

constexpr double variance = 1.15;  // of filter and cell, in h^2; filtered once more: 1 more
constexpr double solid = 1e-5;     // a body's own cells have more, as labels do
constexpr double reach = 0.9;      // of the nearest cells, in cells across the surface
constexpr double far = 4;          // levels are cut here, where the filter ends

// The level of the surface itself: a filter moves a surface whose curvatures add up to kappa by half its variance times
// kappa, twice the filter accordingly further. far - that, so that 0 is far outside.
EULASTIC_CLONES void level_row(const double *once, const double *twice, int begin, int end, double *out) {
  const double ratio = __builtin_sqrt((variance + 1) / variance);
  constexpr double reliable = 3.3;
#pragma omp simd
  for (int i = begin; i < end; ++i) {
    const double z = kernels::surface_level(once[i]), moved = z - ratio * kernels::surface_level(twice[i]);
    const double x = __builtin_fabs(z) < reliable ? kernels::fma(variance, moved, z) : z;
    out[i] = far - (x < -far ? -far : x > far ? far : x);
  }
}

// Values of the 3^d cells around one, in order, summed up so that mirrored ones give the same bits.
template <int Dim>
EULASTIC_INLINE double nested_sum(const double *v) {
  const auto along = [](const double *q, int s) { return (q[0] + q[2 * s]) + q[s]; };
  double rows[9], planes[3];
  for (int r = 0; r < (Dim == 3 ? 9 : 3); ++r) rows[r] = along(v + 3 * r, 1);
  if constexpr (Dim == 2) return along(rows, 1);
  for (int p = 0; p < 3; ++p) planes[p] = along(rows + 3 * p, 1);
  return along(planes, 1);
}

// One point of a layer from those of its neighbours that are nearer to the surface, weighted by how far they lie
// towards it, and turned into its plane.
template <int Dim>
void fill_point(const std::vector<SurfaceCells::Cell> &cells, const int *number, const SurfaceCells::Cell &cell,
                const std::ptrdiff_t *stride, FieldBlock &tensor) {
  constexpr int count = Dim == 3 ? 27 : 9, fields = Dim == 3 ? 6 : 3;
  double weight[count], plain[count], values[fields][count] = {};
  const SurfaceCells::Cell *from[count];
  const kernels::Vector<Dim> normal = normal_of<Dim>(cell.normal);
  int n = 0;
  for (int z = Dim == 3 ? -1 : 0; z <= (Dim == 3 ? 1 : 0); ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x, ++n) {
        const int at = number[cell.at + x + y * stride[1] + z * stride[2]];
        from[n] = at >= 0 && cells[at].layer < cell.layer ? &cells[at] : nullptr;
        plain[n] = from[n] ? 1 : 0;
        double along = (x * cell.normal[0] + y * cell.normal[1]) + z * cell.normal[2];
        if (cell.distance > 0) along = -along;
        weight[n] = from[n] && along > 0 ? along / __builtin_sqrt(double(x * x + y * y + z * z)) : 0;
      }
  const double towards = nested_sum<Dim>(weight);
  const double *w = towards > 0 ? weight : plain, sum = towards > 0 ? towards : nested_sum<Dim>(plain);
  for (int m = 0; m < count; ++m) {
    if (!(w[m] > 0)) continue;
    const kernels::Tensor<Dim> turned =
        kernels::turn<Dim>(tensor_at<Dim>(tensor, from[m]->at), normal_of<Dim>(from[m]->normal), normal);
    for (int a = 0; a < Dim; ++a)
      for (int b = a; b < Dim; ++b) values[kernels::position<Dim>(a, b)][m] = w[m] * turned[a][b];
  }
  for (int f = 0; f < fields; ++f) tensor[f].origin[cell.at] = nested_sum<Dim>(values[f]) / sum;
}

struct Steps {
  double sharp, spread;  ///< from -1/2 to 1/2 across the surface
};
// The integral over x of the normal distribution N, in units of its width (Abramowitz and Stegun 26.2.17, 1e-7), and
// that of N (1 + .7 (1 - x^2)), whose mean |x| is a third of that of N; docs/method.md, (26a).
EULASTIC_INLINE Steps steps_at(double x) {
  constexpr double peak = 0.3989422804014327, ends = 0.5003431;  // of the second at `far`
  const double away = std::min(__builtin_fabs(x), far), xx = away * away, N = peak * kernels::exp(-0.5 * xx);
  const double t = 1 / kernels::fma(0.2316419, away, 1.0);
  double tail = 1.330274429;
  for (const double c : {-1.821255978, 1.781477937, -0.356563782, 0.319381530}) tail = kernels::fma(tail, t, c);
  const double sharp = kernels::fma(-N, tail * t, 0.5);
  const double spread = kernels::fma(0.7 * N, away, sharp) * (0.5 / ends);
  return {x < 0 ? -sharp : sharp, x < 0 ? -spread : spread};
}

}  // namespace

// Differences of the steps add up to 1 across a surface. Those of the sharp one are too small by
// (n_d h_d/width)^2 (1 - x^2)/6 and the next term, which turns normals towards the axes.
SurfaceCells::Cell SurfaceCells::cell_at(ConstView levels, const Int3 &place) const {
  Cell cell{};
  cell.place = place;
  cell.at = place[0] + place[1] * levels.sy + place[2] * levels.sz;
  const double *p = levels.origin + cell.at;
  const Real3 &h = grid_->spacing();
  Real3 sharp_step{}, spread_step{};
  for (int d = 0; d < grid_->dimension(); ++d) {
    const double low = far - p[-levels.stride(d)], high = far - p[levels.stride(d)];
    const Steps at_low = steps_at(low), at_high = steps_at(high);
    sharp_step[d] = (at_high.sharp - at_low.sharp) / (2 * h[d]);
    spread_step[d] = (at_high.spread - at_low.spread) / (2 * h[d]);
  }
  const auto dot = [](const Real3 &a, const Real3 &b) { return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]; };
  double width = 0;
  const auto normalise = [&](const Real3 &g) {
    const double size = __builtin_sqrt(dot(g, g));
    width = 0;
    for (int d = 0; d < 3; ++d) {
      cell.normal[d] = size > 0 ? g[d] / size : 0;
      width += variance * (cell.normal[d] * h[d]) * (cell.normal[d] * h[d]);
    }
  };
  normalise(sharp_step);
  const double x = far - *p, xx = std::min(x * x, 3.0), slope = (1 - xx) / 6,
               bend = kernels::fma(xx - 6, xx, 3.0) / 120;
  Real3 mended = sharp_step;
  for (int d = 0; d < 3 && width > 0; ++d) {
    const double q = (cell.normal[d] * h[d]) * (cell.normal[d] * h[d]) / width;
    mended[d] /= kernels::fma(q, kernels::fma(q, bend, -slope), 1);
  }
  normalise(mended);
  cell.distance = x * __builtin_sqrt(width);
  cell.delta = dot(cell.normal, sharp_step);
  cell.spread = dot(cell.normal, spread_step);
  cell.owned = true;
  for (int d = 0; d < 3; ++d) cell.owned = cell.owned && place[d] >= 0 && place[d] < grid_->owned()[d];
  return cell;
}

// Of this rank, with ghosts where bodies may reach into them: rows that wrap around hold both ends of what is inside.
Grid::Range SurfaceCells::near_box(const Phase &phase, int d, int ghosts) const {
  const bool alone = phase.rows.inside() && !(d == 0 && grid_->wraps_x());
  return grid_->points_near(d, false, d < grid_->dimension() && !alone ? ghosts : 0);
}

// psi, levels, and the cells within reach of the surface.
PetscErrorCode SurfaceCells::find(const Phase &phase, FieldBlock &fields) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::membrane);
  const int dim = grid_->dimension(), ghosts = grid_->spec().ghosts;
  const Int3 &n = grid_->owned();
  const ConstView phi = phase.fraction[0];
  const auto fill = [&](int field, const auto &row) {
    PetscFunctionBeginUser;
    clear_around(*grid_, phase.rows, ghosts, fields[field]);
    in_row_parts(*grid_, [&](const RowPart &part) {
      RowScratch scratch(*grid_, 2);
      for (int k = part.k_begin; k < part.k_end; ++k)
        for (int j = part.j_begin; j < part.j_end; ++j) {
          const OccupiedRows::Span s = phase.rows.span(j, k);
          const int begin = std::max(s.begin, 0), end = std::min(s.end, n[0]);
          if (begin < end) row(j, k, begin, end, scratch);
        }
    });
    FieldBlock filled = fields.part(field, 1);
    PetscCall(exchange_->update(filled, ghosts, &phase.rows));
    fill_wall_ghosts_even(*grid_, at_centre, fields[field], ghosts, &phase.rows);
    PetscFunctionReturn(0);
  };
  PetscCall(fill(smoothed, [&](int j, int k, int begin, int end, RowScratch &scratch) {
    smooth_row(dim, phi, j, k, begin, end, scratch.row(0), fields[smoothed].row(j, k));
  }));
  const ConstView once = fields[smoothed];
  PetscCall(fill(level, [&](int j, int k, int begin, int end, RowScratch &scratch) {
    smooth_row(dim, once, j, k, begin, end, scratch.row(0), scratch.row(1));
    level_row(once.row(j, k), scratch.row(1), begin, end, fields[level].row(j, k));
  }));
  cells_.clear();
  const double within = far - reach / __builtin_sqrt(variance);
  const auto range = [&](int d) { return near_box(phase, d, layers + 1); };
  const ConstView levels = fields[level];
  for (int k = range(2).begin; k < range(2).end; ++k)
    for (int j = range(1).begin; j < range(1).end; ++j) {
      const OccupiedRows::Span s = phase.rows.span(j, k);
      for (int i = std::max(s.begin, range(0).begin); i < std::min(s.end, range(0).end); ++i) {
        const double value = levels(i, j, k);
        if (!(value >= within && value <= 2 * far - within && phi(i, j, k) > solid)) continue;
        const Cell cell = cell_at(levels, {i, j, k});
        if (cell.delta > 0) cells_.push_back(cell);
      }
    }
  find_layers(phase, levels);
  scope.flops(double(phase.rows.cells()) * (dim == 2 ? 90 : 270));
  PetscFunctionReturn(0);
}

// Synchronous: layer L are the cells not yet in one that have a neighbour, corners too, in layer L - 1.
void SurfaceCells::find_layers(const Phase &phase, ConstView levels) {
  const Layout &layout = grid_->layout();
  const int dim = grid_->dimension();
  number_.assign(layout.size, -1);
  int *number = number_.data() + layout.origin;
  for (std::size_t n = 0; n < cells_.size(); ++n) number[cells_[n].at] = static_cast<int>(n);
  first_[0] = 0;
  first_[1] = cells_.size();
  for (int l = 1; l <= layers; ++l) {
    Grid::Range range[3];
    for (int d = 0; d < 3; ++d) range[d] = near_box(phase, d, layers + 1 - l);
    for (std::size_t n = first_[l - 1]; n < first_[l]; ++n) {
      const Int3 middle = cells_[n].place;
      for (int z = dim == 3 ? -1 : 0; z <= (dim == 3 ? 1 : 0); ++z)
        for (int y = -1; y <= 1; ++y)
          for (int x = -1; x <= 1; ++x) {
            const Int3 place{middle[0] + x, middle[1] + y, middle[2] + z};
            bool inside = true;
            for (int d = 0; d < 3; ++d) inside = inside && place[d] >= range[d].begin && place[d] < range[d].end;
            if (!inside) continue;
            int &at = number[place[0] + place[1] * layout.sy + place[2] * layout.sz];
            if (at >= 0) continue;
            at = static_cast<int>(cells_.size());
            cells_.push_back(cell_at(levels, place));
            cells_.back().layer = l;
          }
    }
    first_[l + 1] = cells_.size();
  }
}

PetscErrorCode SurfaceCells::exchange(const Phase &phase, FieldBlock &tensor, int width) const {
  PetscFunctionBeginUser;
  PetscCall(exchange_->update(tensor, width, &phase.rows));
  fill_wall_ghosts_centred_tensor(*grid_, tensor, width, &phase.rows);
  PetscFunctionReturn(0);
}

PetscErrorCode SurfaceCells::extend(const Phase &phase, FieldBlock &tensor) const {
  PetscFunctionBeginUser;
  PetscCall(exchange(phase, tensor, layers + 1));
  const Layout &layout = grid_->layout();
  const std::ptrdiff_t stride[3] = {1, layout.sy, layout.sz};
  const int parts = row_parts(*grid_);
  for (int l = 1; l <= layers; ++l)
    in_parallel(parts, parts, [&](int part) {
      const Piece piece(first_[l + 1] - first_[l], part, parts);
      for (std::size_t c = first_[l] + piece.begin; c < first_[l] + piece.end; ++c)
        (grid_->dimension() == 2 ? fill_point<2> : fill_point<3>)(cells_, number_.data() + layout.origin, cells_[c],
                                                                  stride, tensor);
    });
  PetscCall(exchange(phase, tensor, Grid::stencil_width));
  PetscFunctionReturn(0);
}

PetscErrorCode SurfaceCells::find_labels(const Phase &phase, FieldBlock &scratch, std::vector<int> *labels) const {
  PetscFunctionBeginUser;
  const View all = scratch[0];
  for (std::size_t c = 0; c < nearest(); ++c)
    if (cells_[c].owned) all.origin[cells_[c].at] = phase.label[0].origin[cells_[c].at];
  PetscCall(exchange_->update(scratch, layers, &phase.rows));
  const Layout &layout = grid_->layout();
  const int *number = number_.data() + layout.origin;
  labels->assign(cells_.size(), 0);
  const auto within = [&](const Int3 &place, int ghosts) {
    bool inside = true;
    for (int d = 0; d < grid_->dimension(); ++d)
      inside = inside && place[d] >= -ghosts && place[d] < layout.cells[d] + ghosts;
    return inside;
  };
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    const Cell &cell = cells_[c];
    if (!within(cell.place, layers - cell.layer)) continue;
    int &label = (*labels)[c];
    if (cell.layer == 0) label = static_cast<int>(all.origin[cell.at]);
    const int depth = grid_->dimension() == 3 ? 1 : 0;
    for (int z = -depth; z <= depth && cell.layer > 0; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
          const int at = number[cell.at + x + y * layout.sy + z * layout.sz];
          if (label == 0 && at >= 0 && cells_[at].layer < cell.layer) label = (*labels)[at];
        }
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
