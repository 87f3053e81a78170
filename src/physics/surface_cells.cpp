#include "physics/surface_cells.hpp"

#include "base/events.hpp"
#include "field/sides.hpp"
#include "grid/row_scratch.hpp"
#include "grid/threads.hpp"
#include "kernels/tensor.hpp"
#include "kernels/bending.hpp"
#include <cmath>
#include "physics/membrane_tensor.hpp"
#include "physics/smooth_row.hpp"

#include <algorithm>

namespace eulastic {
namespace {

constexpr double variance = 1.15;    // of filter and cell, in h^2
constexpr double solid = 1e-5;       // a body's own cells have more, as labels do
constexpr double negligible = 1e-6;  // of psi and 1 - psi

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

// Within .9 of a cell across the surface.
bool is_nearest(const SurfaceCells::Cell &cell, const Real3 &spacing) {
  constexpr double reach = 0.9;
  double width = 0;
  for (int d = 0; d < 3; ++d) width = kernels::fma(cell.normal[d] * spacing[d], cell.normal[d] * spacing[d], width);
  return cell.delta > 0 && cell.distance * cell.distance <= reach * reach * width;
}

}  // namespace

// psi is (1 - erf)/2 of the distance over its width s: with y = sqrt(2 pi) (1/2 - psi) that is y + y^3/6 + 7/120 y^5 +
// ... times s. Central differences are too small by (n_d h_d/s)^2 (1 - (distance/s)^2)/6, which turns normals towards
// the axes; their size is right on the whole, as differences across a surface add up to 1.
SurfaceCells::Cell SurfaceCells::cell_at(ConstView psi, const Int3 &place) const {
  constexpr double root_two_pi = 2.5066282746310002;
  Cell cell{};
  cell.place = place;
  cell.at = place[0] + place[1] * psi.sy + place[2] * psi.sz;
  const double *p = psi.origin + cell.at;
  const Real3 &h = grid_->spacing();
  const double y = root_two_pi * (0.5 - *p), yy = y * y;
  const double u = y * kernels::fma(yy, kernels::fma(yy, kernels::fma(yy, 127. / 5040, 7. / 120), 1. / 6), 1);
  Real3 gradient{};
  double width = 0;
  for (int d = 0; d < grid_->dimension(); ++d) gradient[d] = (p[-psi.stride(d)] - p[psi.stride(d)]) / (2 * h[d]);
  const auto normalise = [&](const Real3 &g) {
    const double square = (g[0] * g[0] + g[1] * g[1]) + g[2] * g[2];
    cell.delta = __builtin_sqrt(square);
    width = 0;
    for (int d = 0; d < 3; ++d) {
      cell.normal[d] = cell.delta > 0 ? g[d] / cell.delta : 0;
      width += variance * (cell.normal[d] * h[d]) * (cell.normal[d] * h[d]);
    }
  };
  normalise(gradient);
  const double uu = std::min(u * u, 3.0), slope = (1 - uu) / 6, bend = kernels::fma(uu - 6, uu, 3.0) / 120;
  for (int d = 0; d < 3 && width > 0; ++d) {
    const double q = (cell.normal[d] * h[d]) * (cell.normal[d] * h[d]) / width;
    gradient[d] /= kernels::fma(q, kernels::fma(q, bend, -slope), 1);
  }
  const double unmended = cell.delta;
  normalise(gradient);
  cell.delta = unmended;
  {
    static const double al = getenv("EUL_AL") ? atof(getenv("EUL_AL")) : 0, be = getenv("EUL_BE") ? atof(getenv("EUL_BE")) : 0;
    const auto F = [&](double q) {
      const double v = kernels::surface_level(q), N = std::exp(-v * v / 2) / root_two_pi;
      return q - (al * v - be * (v * v - 3) * v) * N;
    };
    double sum = 0;
    for (int d = 0; d < grid_->dimension(); ++d)
      sum += cell.normal[d] * (F(p[-psi.stride(d)]) - F(p[psi.stride(d)])) / (2 * h[d]);
    cell.spread = sum;
  }
  cell.distance = u * __builtin_sqrt(width);
  cell.owned = true;
  for (int d = 0; d < 3; ++d) cell.owned = cell.owned && place[d] >= 0 && place[d] < grid_->owned()[d];
  return cell;
}

// Of this rank, with ghosts where bodies may reach into them: rows that wrap around hold both ends of what is inside.
Grid::Range SurfaceCells::near_box(const Phase &phase, int d, int ghosts) const {
  const bool alone = phase.rows.inside() && !(d == 0 && grid_->wraps_x());
  return grid_->points_near(d, false, d < grid_->dimension() && !alone ? ghosts : 0);
}

// psi, and the cells within reach of the surface.
PetscErrorCode SurfaceCells::find(const Phase &phase, FieldBlock &psi) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::membrane);
  const int dim = grid_->dimension(), ghosts = grid_->spec().ghosts;
  const Int3 &n = grid_->owned();
  const ConstView phi = phase.fraction[0];
  clear_around(*grid_, phase.rows, ghosts, psi[0]);
  in_row_parts(*grid_, [&](const RowPart &part) {
    RowScratch scratch(*grid_, 1);
    for (int k = part.k_begin; k < part.k_end; ++k)
      for (int j = part.j_begin; j < part.j_end; ++j) {
        const OccupiedRows::Span s = phase.rows.span(j, k);
        const int begin = std::max(s.begin, 0), end = std::min(s.end, n[0]);
        if (begin < end) smooth_row(dim, phi, j, k, begin, end, scratch.row(0), psi[0].row(j, k));
      }
  });
  PetscCall(exchange_->update(psi, ghosts, &phase.rows));
  fill_wall_ghosts_even(*grid_, at_centre, psi[0], ghosts, &phase.rows);
  cells_.clear();
  const auto range = [&](int d) { return near_box(phase, d, layers + 1); };
  const ConstView p = psi[0];
  for (int k = range(2).begin; k < range(2).end; ++k)
    for (int j = range(1).begin; j < range(1).end; ++j) {
      const OccupiedRows::Span s = phase.rows.span(j, k);
      for (int i = std::max(s.begin, range(0).begin); i < std::min(s.end, range(0).end); ++i) {
        const double value = p(i, j, k);
        if (!(value > negligible && value < 1 - negligible && phi(i, j, k) > solid)) continue;
        const Cell cell = cell_at(p, {i, j, k});
        if (is_nearest(cell, grid_->spacing())) cells_.push_back(cell);
      }
    }
  find_layers(phase, psi[0]);
  scope.flops(double(phase.rows.cells()) * (dim == 2 ? 30 : 120));
  PetscFunctionReturn(0);
}

// Synchronous: layer L are the cells not yet in one that have a neighbour, corners too, in layer L - 1.
void SurfaceCells::find_layers(const Phase &phase, ConstView psi) {
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
            cells_.push_back(cell_at(psi, place));
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
