// Curvature of an interface from heights: the volumes of solid in columns of cells across it, 3 in 2-D and 3 x 3 in
// 3-D.
//
// Popinet, J. Comput. Phys. 228 (2009), with columns of fixed length that are made monotonic; docs/method.md,
// section 17. Second order.
#pragma once

#include "kernels/interface_normal.hpp"
#include "kernels/plane.hpp"

#include <cstddef>

namespace eulastic::kernels {

/// Number of cells of a column on either side of the central one, enough for any inclination.
inline constexpr int height_reach = 4;
inline constexpr double height_curvature_flops_2d = 3 * 24 + 12, height_curvature_flops_3d = 9 * 24 + 40;

/// Position of the columns around a cell. `along` points, with its sign, to increasing phi.
struct ColumnFrame {
  std::ptrdiff_t along, b, c;   ///< strides
  double height;                ///< spacing along the columns
  double inverse_b, inverse_c;  ///< of the spacings across; 2-D ignores c
};

/// Volume of solid in a column of nine cells, in cells. From the middle, phi is made non-decreasing on one side and
/// non-increasing on the other, so that another surface has no effect.
struct Column {
  double solid;
  bool whole;  ///< whether its ends are full and empty, so that it contains the whole interface
};

EULASTIC_INLINE Column column_at(const double *q, std::ptrdiff_t along) noexcept {
  constexpr double tolerance = 1e-4;  // deviation from full and empty cells that the planes leave
  double up = q[0], down = q[0], sum = q[0];
#pragma GCC unroll 4
  for (int n = 1; n <= height_reach; ++n) {
    up = larger(up, q[n * along]);
    down = smaller(down, q[-n * along]);
    sum += up + down;
  }
  return {sum, up >= 1 - tolerance && down <= tolerance};
}

struct HeightCurvature {
  double value;  ///< in 1/length, positive where the solid is convex; the sum of the principal curvatures
  bool whole;    ///< whether all columns contain the interface
};

/// Returns the curvature at q. Mirrored neighbours give the same bits.
template <int Dim>
EULASTIC_INLINE HeightCurvature height_curvature(const double *q, const ColumnFrame &f) noexcept {
  const Column middle = column_at(q, f.along), lower = column_at(q - f.b, f.along), upper = column_at(q + f.b, f.along);
  const double slope_b = 0.5 * f.height * f.inverse_b * (upper.solid - lower.solid);
  const double second_b = f.height * f.inverse_b * f.inverse_b * ((upper.solid + lower.solid) - 2 * middle.solid);
  bool whole = middle.whole && lower.whole && upper.whole;
  if constexpr (Dim == 2) {
    const double square = fma(slope_b, slope_b, 1);
    return {-second_b / (square * __builtin_sqrt(square)), whole};
  }
  const Column front = column_at(q - f.c, f.along), back = column_at(q + f.c, f.along);
  const Column low_front = column_at(q - f.b - f.c, f.along), low_back = column_at(q - f.b + f.c, f.along);
  const Column high_front = column_at(q + f.b - f.c, f.along), high_back = column_at(q + f.b + f.c, f.along);
  whole =
      whole && front.whole && back.whole && low_front.whole && low_back.whole && high_front.whole && high_back.whole;
  const double slope_c = 0.5 * f.height * f.inverse_c * (back.solid - front.solid);
  const double second_c = f.height * f.inverse_c * f.inverse_c * ((back.solid + front.solid) - 2 * middle.solid);
  const double mixed = 0.25 * f.height * f.inverse_b * f.inverse_c *
                       ((high_back.solid + low_front.solid) - (high_front.solid + low_back.solid));
  const double bb = slope_b * slope_b, cc = slope_c * slope_c, square = 1 + (bb + cc);
  const double sum = (second_b * (1 + cc) + second_c * (1 + bb)) - 2 * (mixed * (slope_b * slope_c));
  return {-sum / (square * __builtin_sqrt(square)), whole};
}

/// Sets *frame so that the columns at q are as close to the normal as possible. `stride` and `spacing` are in the order
/// of the directions. Returns false if phi has no gradient.
template <int Dim>
EULASTIC_INLINE bool column_frame(const double *q, const std::ptrdiff_t *stride, const double *spacing,
                                  ColumnFrame *frame) noexcept {
  double g[3] = {};
  for (int d = 0; d < Dim; ++d)
    g[d] = youngs_component<Dim>(q, stride[d], stride[(d + 1) % Dim], stride[Dim == 3 ? (d + 2) % 3 : (d + 1) % 2]);
  int a = 0;
  for (int d = 1; d < Dim; ++d)
    if (__builtin_fabs(g[d]) > __builtin_fabs(g[a])) a = d;
  if (g[a] == 0) return false;
  const int b = (a + 1) % Dim, c = Dim == 3 ? (a + 2) % 3 : b;
  *frame = {g[a] > 0 ? stride[a] : -stride[a], stride[b], stride[c], spacing[a], 1 / spacing[b], 1 / spacing[c]};
  return true;
}

}  // namespace eulastic::kernels
