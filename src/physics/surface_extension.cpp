// SurfaceCells: what lives on a surface, extended from the cells nearest to it.
#include "base/events.hpp"
#include "field/sides.hpp"
#include "grid/threads.hpp"
#include "kernels/tensor.hpp"
#include "physics/membrane_tensor.hpp"
#include "physics/surface_cells.hpp"

namespace eulastic {
namespace {

// The cells around one, in the order of memory.
template <int Dim>
struct Around {
  static constexpr int count = Dim == 3 ? 27 : 9;
  double x[count], y[count], z[count], length[count];
  std::ptrdiff_t first_of_row[count / 3];
  explicit Around(const Layout &layout) {
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

// Fields side by side: whole vectors.
constexpr int width = 8;

// Values of the 3^d cells around one, in order, summed up so that mirrored ones give the same bits.
template <int Dim>
EULASTIC_INLINE double nested_sum(const double *v) {
  double rows[9];
  for (int r = 0; r < (Dim == 3 ? 9 : 3); ++r) rows[r] = (v[3 * r] + v[3 * r + 2]) + v[3 * r + 1];
  double planes[3];
  for (int p = 0; p < (Dim == 3 ? 3 : 1); ++p) planes[p] = (rows[3 * p] + rows[3 * p + 2]) + rows[3 * p + 1];
  return Dim == 3 ? (planes[0] + planes[2]) + planes[1] : planes[0];
}

// The same of fields side by side, into the first; spoils the others.
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
  const int *number;  // by offset from the origin
  int known;          // numbers below this one: nearer to the surface
};

// One point of a layer from those of its neighbours that are nearer to the surface, weighted by how far they lie
// towards it, and turned into its plane.
template <int Dim>
EULASTIC_INLINE void fill_point(const Source &source, const Around<Dim> &around, const SurfaceCells::Cell &cell,
                                Field &tensor) {
  constexpr int count = Around<Dim>::count, fields = Dim == 3 ? 6 : 3;
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
  double sum = nested_sum<Dim>(towards);
  const double *w = towards;
  if (!(sum > 0)) {
    sum = nested_sum<Dim>(plain);
    w = plain;
  }
  // Neighbours that count, side by side, and zeros to fill the last vector.
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
  kernels::turn<Dim>(normal_of<Dim>(cell.normal), whole, share, normals, tensors);
  alignas(64) double values[count][width];
  for (int m = 0; m < count; ++m)
    for (int f = 0; f < width; ++f) values[m][f] = 0;
  for (int m = 0; m < neighbours; ++m)
    for (int f = 0; f < fields; ++f) values[place[m]][f] = tensors[f][m];
  nested_sums<Dim>(values);
  for (int f = 0; f < fields; ++f) tensor[f].origin[cell.at] = values[0][f] / sum;
}

EULASTIC_CLONES void fill_2d(const Source &source, const Around<2> &around, std::size_t begin, std::size_t end,
                             Field &tensor) {
  for (std::size_t c = begin; c < end; ++c) fill_point<2>(source, around, (*source.cells)[c], tensor);
}
EULASTIC_CLONES void fill_3d(const Source &source, const Around<3> &around, std::size_t begin, std::size_t end,
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
  VerbScope scope(Verb::membrane);
  const Layout &layout = place_.box->layout();
  const Around<2> flat(layout);
  const Around<3> around(layout);
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
