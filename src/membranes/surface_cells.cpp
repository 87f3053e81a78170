#include "membranes/surface_cells.hpp"

#include "base/events.hpp"
#include "field/boundaries.hpp"
#include "grid/row_scratch.hpp"
#include "grid/threads.hpp"
#include "kernels/bending.hpp"
#include "kernels/exp.hpp"
#include "kernels/tensor.hpp"
#include "membranes/membrane_tensor.hpp"
#include "membranes/smooth_row.hpp"

#include <algorithm>

namespace eulastic {
namespace {

constexpr double variance = 1.15;        // of filter and cell, in h^2; a second filter adds 1
constexpr double least_fraction = 1e-5;  // least phi of a cell that belongs to a body, as for labels
constexpr double reach = 0.9;            // of the nearest cells, in cells across the surface
// Least delta times its width in a nearest cell: half of its value at `reach`. Where two sides of a body are less than
// two cells apart their slopes cancel, and the normal is that of neither side.
constexpr double least_slope = 0.14;
constexpr double cut_level = 4;  // levels are limited to this, where the filter ends

// Computes cut_level minus the level x of the surface itself, so that 0 is far outside. A filter moves a surface
// by half its variance times the sum of the curvatures, and two filters move it further accordingly, which gives x by
// extrapolation.
EULASTIC_CLONES void level_row(const double *once, const double *twice, int begin, int end, double *out) {
  const double ratio = __builtin_sqrt((variance + 1) / variance);
  constexpr double reliable = 3.3;
#pragma omp simd
  for (int i = begin; i < end; ++i) {
    const double z = kernels::surface_level(once[i]), moved = z - ratio * kernels::surface_level(twice[i]);
    const double x = __builtin_fabs(z) < reliable ? kernels::fma(variance, moved, z) : z;
    out[i] = cut_level - (x < -cut_level ? -cut_level : x > cut_level ? cut_level : x);
  }
}

// Integrals over x of the normal distribution N, in units of its width (Abramowitz and Stegun 26.2.17, error 1e-7), and
// of N (1 + .7 (1 - x^2)), whose mean |x| is a third of that of N; docs/method.md, (26a). Both go from -1/2 to 1/2
// across the surface.
EULASTIC_CLONES void steps_row(const double *level, int begin, int end, double *sharp, double *spread) {
  constexpr double peak = 0.3989422804014327, ends = 0.5003431;  // `ends`: the second integral at cut_level
#pragma omp simd
  for (int i = begin; i < end; ++i) {
    const double x = cut_level - level[i], size = __builtin_fabs(x), away = size < cut_level ? size : cut_level;
    const double N = peak * kernels::exp(-0.5 * (away * away)), t = 1 / kernels::fma(0.2316419, away, 1.0);
    double tail = 1.330274429;
    tail = kernels::fma(tail, t, -1.821255978);
    tail = kernels::fma(tail, t, 1.781477937);
    tail = kernels::fma(tail, t, -0.356563782);
    tail = kernels::fma(tail, t, 0.319381530);
    const double first = kernels::fma(-N, tail * t, 0.5), second = kernels::fma(0.7 * N, away, first) * (0.5 / ends);
    sharp[i] = x < 0 ? -first : first;
    spread[i] = x < 0 ? -second : second;
  }
}

}  // namespace

// Computes normal, distance and deltas of a cell. Differences of the integrals add up to 1 across a surface. Those of
// the first one are too small by the factor (n_d h_d/width)^2 (1 - x^2)/6 and the next term, which would turn normals
// towards the axes and is corrected.
void SurfaceCells::measure_cell(const Field &fields, Cell *measured) const {
  Cell &cell = *measured;
  const Real3 &h = place_.box->spacing();
  Real3 sharp_step{}, spread_step{};
  for (int d = 0; d < place_.box->dimension(); ++d) {
    const std::ptrdiff_t s = fields[level].stride(d);
    const double *at_sharp = fields[sharp].origin + cell.at, *at_spread = fields[spread].origin + cell.at;
    sharp_step[d] = (at_sharp[s] - at_sharp[-s]) / (2 * h[d]);
    spread_step[d] = (at_spread[s] - at_spread[-s]) / (2 * h[d]);
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
  const double x = cut_level - fields[level].origin[cell.at], xx = std::min(x * x, 3.0), slope = (1 - xx) / 6,
               bend = kernels::fma(xx - 6, xx, 3.0) / 120;
  Real3 corrected = sharp_step;
  for (int d = 0; d < 3 && width > 0; ++d) {
    const double q = (cell.normal[d] * h[d]) * (cell.normal[d] * h[d]) / width;
    corrected[d] /= kernels::fma(q, kernels::fma(q, bend, -slope), 1);
  }
  normalise(corrected);
  cell.distance = x * __builtin_sqrt(width);
  cell.delta = dot(cell.normal, sharp_step);
  cell.spread = dot(cell.normal, spread_step);
  cell.owned = true;
  for (int d = 0; d < 3; ++d) cell.owned = cell.owned && cell.place[d] >= 0 && cell.place[d] < place_.box->cells()[d];
}

// Interpolates the levels, which are nearly linear, by a quadratic through three points along each direction.
double SurfaceCells::distance_at(const Field &fields, const Cell &cell, const Real3 &offset) const {
  const ConstView levels = fields[level];
  double weight[3][3] = {{0, 1, 0}, {0, 1, 0}, {0, 1, 0}}, x = 0;
  for (int d = 0; d < place_.box->dimension(); ++d) {
    const double o = offset[d];
    weight[d][0] = 0.5 * o * (o - 1);
    weight[d][1] = 1 - o * o;
    weight[d][2] = 0.5 * o * (o + 1);
  }
  const int layers_z = place_.box->dimension() == 3 ? 1 : 0;
  for (int k = -layers_z; k <= layers_z; ++k)
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i)
        x += weight[0][i + 1] * weight[1][j + 1] * weight[2][k + 1] *
             (cut_level - levels.origin[cell.at + i + j * levels.sy + k * levels.sz]);
  return x * width(cell.normal);
}

double SurfaceCells::sharpest(const Field &fields) const {
  constexpr double least_radius = 2;  // in cells
  constexpr std::ptrdiff_t stride[3] = {1, 3, 9};
  const ConstView levels = fields[level];
  const Real3 &h = place_.box->spacing();
  const bool flat = place_.box->dimension() == 2;
  const double inverse[3] = {1 / h[0], 1 / h[1], 1 / h[2]}, longest = std::max({h[0], h[1], flat ? 0 : h[2]}),
               steepest = 1 / (least_radius * longest);
  const auto largest_at = [&](std::ptrdiff_t at) {
    double x[27];
    int m = 0;
    for (int k = flat ? 0 : -1; k <= (flat ? 0 : 1); ++k)
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) x[m++] = cut_level - levels.origin[at + i + j * levels.sy + k * levels.sz];
    const kernels::Curvatures found = flat ? kernels::surface_curvatures<2>(x + m / 2, stride, inverse, steepest)
                                           : kernels::surface_curvatures<3>(x + m / 2, stride, inverse, steepest);
    const double mean = 0.5 * found.sum, square = mean * mean - found.product;
    return std::abs(mean) + std::sqrt(std::max(square, 0.0));
  };
  const int parts = row_parts(*place_.box);
  std::vector<double> most(parts);
  in_parallel(parts, parts, [&](int part) {
    const Piece piece(nearest_count(), part, parts);
    for (std::size_t c = piece.begin; c < piece.end; ++c)
      if (cells_[c].owned) most[part] = std::max(most[part], largest_at(cells_[c].at));
  });
  return longest * *std::max_element(most.begin(), most.end());
}

// Width of delta.
double SurfaceCells::width(const Real3 &normal) const {
  double square = 0;
  for (int d = 0; d < place_.box->dimension(); ++d) {
    const double step = normal[d] * place_.box->spacing()[d];
    square += variance * step * step;
  }
  return __builtin_sqrt(square);
}

// Indices of this rank, with ghosts if bodies may reach into them. Rows that wrap around a periodic direction contain
// both ends of a body.
Box::Range SurfaceCells::near_box(const Phase &phase, int d, int ghosts) const {
  const bool alone = phase.rows.inside() && !(d == 0 && place_.box->wraps_x());
  return place_.box->points_with_ghosts(d, false, d < place_.box->dimension() && !alone ? ghosts : 0);
}

// Whether the first filter reads behind a solid boundary. Ghost cells are checked as well, so that all ranks
// that see a body there agree.
bool SurfaceCells::is_beside_solid_side(const Phase &phase) const {
  const Int3 &n = place_.box->cells();
  for (const auto [d, high] : place_.box->sides()) {
    if (!is_solid((*place_.sides)[d][high].kind) || !place_.box->touches(d, high)) continue;
    Int3 begin{}, end = n;
    for (int e = 0; e < place_.box->dimension(); ++e) {
      begin[e] = e != d ? -smooth_reach : high ? std::max(0, n[e] - smooth_reach) : 0;
      end[e] = e != d ? n[e] + smooth_reach : high ? n[e] : std::min(smooth_reach, n[e]);
    }
    for (int k = begin[2]; k < end[2]; ++k)
      for (int j = begin[1]; j < end[1]; ++j)
        if (!phase.rows.idle(j, k) && OccupiedRows::any(phase.fraction[0].row(j, k), begin[0], end[0])) return true;
  }
  return false;
}

ConstView SurfaceCells::fraction_within_walls(const Phase &phase, View copy) const {
  const ConstView phi = phase.fraction[0];
  if (!is_beside_solid_side(phase)) return phi;
  const int ghosts = place_.box->layout().ghosts[0], layers_z = place_.box->dimension() == 3 ? ghosts : 0;
  const Int3 &n = place_.box->cells();
  for (int k = -layers_z; k < n[2] + layers_z; ++k)
    for (int j = -ghosts; j < n[1] + ghosts; ++j)
      if (is_near_occupied_row(*place_.box, phase.rows, j, k))
        std::copy_n(phi.row(j, k) - ghosts, n[0] + 2 * ghosts, copy.row(j, k) - ghosts);
  clear_solid_ghosts(*place_.box, *place_.sides, copy, ghosts, &phase.rows);
  return copy;
}

// Computes psi, levels and integrals.
PetscErrorCode SurfaceCells::find_level(const Phase &phase, Field &fields) {
  PetscFunctionBeginUser;
  const int dim = place_.box->dimension(), ghosts = place_.box->layout().ghosts[0], layers_z = dim == 3 ? ghosts : 0;
  const Int3 &n = place_.box->cells();
  const ConstView phi = fraction_within_walls(phase, fields[sharp]);
  const auto fill = [&](int field, const auto &row) {
    PetscFunctionBeginUser;
    clear_near_rows(*place_.box, phase.rows, ghosts, fields[field]);
    in_row_parts(*place_.box, [&](const RowPart &part) {
      RowScratch scratch(*place_.box, 2);
      for (int k = part.k_begin; k < part.k_end; ++k)
        for (int j = part.j_begin; j < part.j_end; ++j) {
          const OccupiedRows::Span s = phase.rows.span(j, k);
          const int begin = std::max(s.begin, 0), end = std::min(s.end, n[0]);
          if (begin < end) row(j, k, begin, end, scratch);
        }
    });
    Field filled = fields.part(field, 1);
    PetscCall(place_.exchange_ghosts(filled, ghosts, &phase.rows));
    fill_wall_ghosts_even(*place_.box, at_centre, fields[field], ghosts, &phase.rows);
    clear_solid_ghosts(*place_.box, *place_.sides, fields[field], ghosts, &phase.rows);
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
  const int rows = n[1] + 2 * ghosts, planes = n[2] + 2 * layers_z;
  const int parts = row_parts(*place_.box);
  in_parallel(parts, parts, [&](int part) {
    const Piece piece(std::size_t(rows) * planes, part, parts);
    for (std::size_t r = piece.begin; r < piece.end; ++r) {
      const int j = static_cast<int>(r % rows) - ghosts, k = static_cast<int>(r / rows) - layers_z;
      if (is_near_occupied_row(*place_.box, phase.rows, j, k))
        steps_row(fields[level].row(j, k), -ghosts, n[0] + ghosts, fields[sharp].row(j, k), fields[spread].row(j, k));
    }
  });
  PetscFunctionReturn(0);
}

// Lists the cells within reach of the surface.
void SurfaceCells::find_nearest(const Phase &phase, ConstView levels) {
  const double within = cut_level - reach / __builtin_sqrt(variance);
  const auto range = [&](int d) { return near_box(phase, d, layers + 1); };
  const ConstView phi = phase.fraction[0];
  cells_.clear();
  for (int k = range(2).begin; k < range(2).end; ++k)
    for (int j = range(1).begin; j < range(1).end; ++j) {
      const OccupiedRows::Span s = phase.rows.span(j, k);
      for (int i = std::max(s.begin, range(0).begin); i < std::min(s.end, range(0).end); ++i) {
        const double value = levels(i, j, k);
        if (!(value >= within && value <= 2 * cut_level - within && phi(i, j, k) > least_fraction)) continue;
        cells_.push_back({});
        cells_.back().place = {i, j, k};
        cells_.back().at = i + j * levels.sy + k * levels.sz;
      }
    }
}

PetscErrorCode SurfaceCells::find(const Phase &phase, Field &fields) {
  PetscFunctionBeginUser;
  EventScope scope(Event::membrane);
  PetscCall(find_level(phase, fields));
  find_nearest(phase, fields[level]);
  const auto measure_from = [&](std::size_t first) {
    const int parts = row_parts(*place_.box);
    in_parallel(parts, parts, [&](int part) {
      const Piece piece(cells_.size() - first, part, parts);
      for (std::size_t c = first + piece.begin; c < first + piece.end; ++c) measure_cell(fields, &cells_[c]);
    });
  };
  measure_from(0);
  const auto is_between_sides = [this](const Cell &cell) { return !(cell.delta * width(cell.normal) > least_slope); };
  cells_.erase(std::remove_if(cells_.begin(), cells_.end(), is_between_sides), cells_.end());
  find_layers(phase);
  measure_from(nearest_count());
  scope.flops(double(phase.rows.cells()) * (place_.box->dimension() == 2 ? 90 : 270));
  PetscFunctionReturn(0);
}

namespace {

constexpr unsigned char in_no_layer = 0;

// Adds the cells of a row that are in no layer and beside a marked cell to layer `layer`; returns whether there are
// any.
bool mark_layer(const unsigned char *marked, const Box::Range &x, unsigned char layer, unsigned char *row) {
  unsigned char found = 0;
  for (int i = x.begin; i < x.end; ++i) {
    const bool in = row[i] == in_no_layer && (marked[i - 1] | marked[i] | marked[i + 1]);
    row[i] = in ? layer : row[i];
    found |= in;
  }
  return found;
}

}  // namespace

// Layer L contains the cells that are in no lower layer and have a neighbour, corners included, in layer L - 1. Rows
// are processed in the order of memory.
void SurfaceCells::find_layers(const Phase &phase) {
  const Layout &layout = place_.box->layout();
  const int layers_z = place_.box->dimension() == 3 ? 1 : 0, rows_y = layout.cells[1] + 2 * layout.ghosts[1];
  constexpr unsigned char first = in_no_layer + 1;  // first + L marks layer L
  std::vector<unsigned char> layer(layout.size, in_no_layer);
  std::vector<int> last_layer(std::size_t(rows_y) * (layout.cells[2] + 2 * layout.ghosts[2]), -1);  // of every row
  const auto row_of = [&](int j, int k) { return layer.data() + layout.origin + j * layout.sy + k * layout.sz; };
  const auto last_of = [&](int j, int k) -> int & {
    return last_layer[(j + layout.ghosts[1]) + std::size_t(rows_y) * (k + layout.ghosts[2])];
  };
  number_.assign(layout.size, -1);
  int *number = number_.data() + layout.origin;
  for (std::size_t n = 0; n < cells_.size(); ++n) {
    const Cell &cell = cells_[n];
    number[cell.at] = static_cast<int>(n);
    row_of(0, 0)[cell.at] = first;
    last_of(cell.place[1], cell.place[2]) = 0;
  }
  first_[0] = 0;
  first_[1] = cells_.size();
  std::vector<unsigned char> beside(layout.cells[0] + 2 * layout.ghosts[0]);
  for (int l = 1; l <= layers; ++l) {
    const Box::Range x = near_box(phase, 0, layers + 1 - l), y = near_box(phase, 1, layers + 1 - l),
                     z = near_box(phase, 2, layers + 1 - l);
    const auto each_row = [&](const auto &row) {
      for (int k = z.begin; k < z.end; ++k)
        for (int j = y.begin; j < y.end; ++j) row(j, k);
    };
    each_row([&](int j, int k) {
      unsigned char *around = beside.data() + layout.ghosts[0];
      bool any = false;
      for (int m = -layers_z; m <= layers_z; ++m)
        for (int o = -1; o <= 1; ++o) {
          if (last_of(j + o, k + m) < l - 1) continue;
          if (!any) std::fill(beside.begin(), beside.end(), 0);
          any = true;
          const unsigned char *from = row_of(j + o, k + m), before = first + l - 1;
          for (int i = x.begin - 1; i < x.end + 1; ++i) around[i] |= from[i] == before;
        }
      if (any && mark_layer(around, x, first + l, row_of(j, k))) last_of(j, k) = l;
    });
    each_row([&](int j, int k) {
      if (last_of(j, k) < l) return;
      const unsigned char *own = row_of(j, k);
      for (int i = x.begin; i < x.end; ++i) {
        if (own[i] != first + l) continue;
        Cell cell{};
        cell.place = {i, j, k};
        cell.at = i + j * layout.sy + k * layout.sz;
        cell.layer = l;
        number[cell.at] = static_cast<int>(cells_.size());
        cells_.push_back(cell);
      }
    });
    first_[l + 1] = cells_.size();
  }
}

PetscErrorCode SurfaceCells::find_labels(const Phase &phase, Field &scratch, std::vector<int> *labels) const {
  PetscFunctionBeginUser;
  const View all = scratch[0];
  for (std::size_t c = 0; c < nearest_count(); ++c)
    if (cells_[c].owned) all.origin[cells_[c].at] = phase.label[0].origin[cells_[c].at];
  PetscCall(place_.exchange_ghosts(scratch, layers, &phase.rows));
  const Layout &layout = place_.box->layout();
  const int *number = number_.data() + layout.origin;
  labels->assign(cells_.size(), 0);
  const auto within = [&](const Int3 &place, int ghosts) {
    bool inside = true;
    for (int d = 0; d < place_.box->dimension(); ++d)
      inside = inside && place[d] >= -ghosts && place[d] < layout.cells[d] + ghosts;
    return inside;
  };
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    const Cell &cell = cells_[c];
    if (!within(cell.place, layers - cell.layer)) continue;
    int &label = (*labels)[c];
    if (cell.layer == 0) label = static_cast<int>(all.origin[cell.at]);
    const int depth = place_.box->dimension() == 3 ? 1 : 0;
    for (int z = -depth; z <= depth && cell.layer > 0; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
          const int at = number[cell.at + x + y * layout.sy + z * layout.sz];
          if (label == 0 && at >= 0 && cells_[at].layer < cell.layer) label = (*labels)[at];
        }
  }
  PetscFunctionReturn(0);
}

// Extrapolation from the nearest cells to the layers.

namespace {

// The 3^d cells around a cell, in the order of memory.
template <int Dim>
struct Neighbourhood {
  static constexpr int count = Dim == 3 ? 27 : 9;
  double x[count], y[count], z[count], length[count];
  std::ptrdiff_t first_of_row[count / 3];
  explicit Neighbourhood(const Layout &layout) {
    int n = 0;
    for (int k = Dim == 3 ? -1 : 0; k <= (Dim == 3 ? 1 : 0); ++k)
      for (int j = -1; j <= 1; ++j) {
        first_of_row[n / 3] = -1 + j * layout.sy + k * layout.sz;
        for (int i = -1; i <= 1; ++i, ++n) {
          x[n] = i;
          y[n] = j;
          z[n] = k;
          length[n] = i == 0 && j == 0 && k == 0 ? 1 : __builtin_sqrt(double(i * i + j * j + k * k));
        }
      }
  }
};

// Number of fields that are processed side by side, as whole vectors.
constexpr int width = 8;

// Computes kernels::sum_around() of the 3^d cells around one, for fields side by side, in v[0]; overwrites the others.
template <int Dim>
EULASTIC_INLINE void nested_sums(double (*v)[width]) {
  const auto along = [&](int first, int s) EULASTIC_BODY {
    double *sum = v[first];
    const double *middle = v[first + s], *last = v[first + 2 * s];
#pragma omp simd
    for (int f = 0; f < width; ++f) sum[f] = (sum[f] + last[f]) + middle[f];
  };
  for (int r = 0; r < (Dim == 3 ? 9 : 3); ++r) along(3 * r, 1);
  for (int p = 0; p < (Dim == 3 ? 3 : 1); ++p) along(9 * p, 3);
  if (Dim == 3) along(0, 9);
}

struct Source {
  const std::vector<SurfaceCells::Cell> *cells;
  const int *number;  // of the cell at an offset from the origin
  int known;          // cells with lower numbers are nearer to the surface and already filled
};

// Fills one cell of a layer from its neighbours nearer to the surface, weighted by how far they lie towards it,
// each turned into the plane of the cell.
template <int Dim>
EULASTIC_INLINE void fill_point(const Source &source, const Neighbourhood<Dim> &around, const SurfaceCells::Cell &cell,
                                Field &tensor) {
  constexpr int count = Neighbourhood<Dim>::count, fields = Dim == 3 ? 6 : 3;
  int from[count];
  for (int r = 0; r < count / 3; ++r)
    for (int i = 0; i < 3; ++i) from[3 * r + i] = source.number[cell.at + around.first_of_row[r] + i];
  alignas(64) double plain[count], towards[count];
  const double nx = cell.normal[0], ny = cell.normal[1], nz = cell.normal[2], side = cell.distance > 0 ? -1 : 1;
#pragma omp simd
  for (int m = 0; m < count; ++m) {
    const double along = side * ((around.x[m] * nx + around.y[m] * ny) + around.z[m] * nz) / around.length[m];
    const double known = (from[m] >= 0) & (from[m] < source.known) ? 1 : 0;
    plain[m] = known;
    towards[m] = along > 0 ? known * along : 0;
  }
  constexpr std::ptrdiff_t stride[3] = {1, 3, 9};
  double sum = kernels::sum_around<Dim>(towards + count / 2, stride);
  const double *w = towards;
  if (!(sum > 0)) {
    sum = kernels::sum_around<Dim>(plain + count / 2, stride);
    w = plain;
  }
  // Neighbours with a weight, side by side, and zeros to fill the last vector.
  constexpr int most = (count + width - 1) / width * width;
  alignas(64) double share[most], normals[Dim][most], tensors[fields][most];
  int place[count + 1], neighbours = 0;
  for (int m = 0; m < count; ++m) {
    place[neighbours] = m;
    neighbours += w[m] > 0;
  }
  for (int m = 0; m < neighbours; ++m) {
    const SurfaceCells::Cell &near = (*source.cells)[from[place[m]]];
    share[m] = w[place[m]];
    for (int d = 0; d < Dim; ++d) normals[d][m] = near.normal[d];
    for (int f = 0; f < fields; ++f) tensors[f][m] = tensor[f].origin[near.at];
  }
  const int whole = (neighbours + width - 1) / width * width;
  for (int m = neighbours; m < whole; ++m) {
    share[m] = 0;
    for (int d = 0; d < Dim; ++d) normals[d][m] = 0;
    for (int f = 0; f < fields; ++f) tensors[f][m] = 0;
  }
  kernels::rotate_tensors<Dim>(normal_of<Dim>(cell.normal), whole, share, normals, tensors);
  alignas(64) double values[count][width];
  for (int m = 0; m < count; ++m)
    for (int f = 0; f < width; ++f) values[m][f] = 0;
  for (int m = 0; m < neighbours; ++m)
    for (int f = 0; f < fields; ++f) values[place[m]][f] = tensors[f][m];
  nested_sums<Dim>(values);
  for (int f = 0; f < fields; ++f) tensor[f].origin[cell.at] = values[0][f] / sum;
}

EULASTIC_CLONES void fill_2d(const Source &source, const Neighbourhood<2> &around, std::size_t begin, std::size_t end,
                             Field &tensor) {
  for (std::size_t c = begin; c < end; ++c) fill_point<2>(source, around, (*source.cells)[c], tensor);
}
EULASTIC_CLONES void fill_3d(const Source &source, const Neighbourhood<3> &around, std::size_t begin, std::size_t end,
                             Field &tensor) {
  for (std::size_t c = begin; c < end; ++c) fill_point<3>(source, around, (*source.cells)[c], tensor);
}

}  // namespace

PetscErrorCode SurfaceCells::exchange(const Phase &phase, Field &tensor, int width) const {
  PetscFunctionBeginUser;
  PetscCall(place_.exchange_ghosts(tensor, width, &phase.rows));
  fill_wall_ghosts_centred_tensor(*place_.box, tensor, width, &phase.rows);
  PetscFunctionReturn(0);
}

PetscErrorCode SurfaceCells::extend(const Phase &phase, Field &tensor) const {
  PetscFunctionBeginUser;
  PetscCall(exchange(phase, tensor, layers + 1));
  EventScope scope(Event::membrane);
  const Layout &layout = place_.box->layout();
  const Neighbourhood<2> flat(layout);
  const Neighbourhood<3> around(layout);
  const int parts = row_parts(*place_.box);
  for (int l = 1; l <= layers; ++l) {
    const Source source{&cells_, number_.data() + layout.origin, static_cast<int>(first_[l])};
    in_parallel(parts, parts, [&](int part) {
      const Piece piece(first_[l + 1] - first_[l], part, parts);
      const std::size_t begin = first_[l] + piece.begin, end = first_[l] + piece.end;
      if (place_.box->dimension() == 2)
        fill_2d(source, flat, begin, end, tensor);
      else
        fill_3d(source, around, begin, end, tensor);
    });
  }
  scope.flops(double(first_[layers + 1] - first_[1]) * (place_.box->dimension() == 2 ? 200 : 900));
  PetscCall(exchange(phase, tensor, Box::stencil_width));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
