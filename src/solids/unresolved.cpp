#include "solids/unresolved.hpp"

#include "base/events.hpp"
#include "kernels/stencils.hpp"

#include <vector>

namespace eulastic {
namespace {

// B at a centre, with off-diagonals averaged from the edges.
struct Centre {
  double xx, yy, zz = 1, yz = 0, xz = 0, xy;

  // Reads B at the centre that `b` points to; components are `size` doubles apart.
  Centre(const double *b, std::ptrdiff_t size, std::ptrdiff_t y, std::ptrdiff_t z, int dimension)
      : xx(b[0]), yy(b[size]) {
    if (dimension == 2) {
      xy = kernels::average4(b + 2 * size, 1, y);
      return;
    }
    zz = b[2 * size];
    yz = kernels::average4(b + 3 * size, y, z);
    xz = kernels::average4(b + 4 * size, 1, z);
    xy = kernels::average4(b + 5 * size, 1, y);
  }

  double determinant() const { return xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz); }

  // The factor <= 1 of all diagonals (in 2-D except zz) that makes det B = 1. B stays positive definite.
  double isochoric_factor(int dimension) const {
    double low = 0, high = 1;
    for (int n = 0; n < 53; ++n) {
      const double middle = 0.5 * (low + high);
      Centre scaled = *this;
      scaled.xx *= middle;
      scaled.yy *= middle;
      if (dimension == 3) scaled.zz *= middle;
      (scaled.determinant() > 1 ? high : low) = middle;
    }
    return high;
  }
};

}  // namespace

bool may_be_unresolved(double trace, int dimension) {
  const double mean = dimension == 2 ? (trace - 1) / 2 : trace / 3;
  return (dimension == 2 ? mean * mean : mean * mean * mean) > 0.99 * largest_determinant;  // margin for round-off
}

long reset_unresolved(const Box &box, Phase &phase) {
  EventScope scope(Event::left_cauchy_green);
  const Layout &layout = box.layout();
  const Int3 n = box.cells();
  const int dimension = box.dimension(), layers_z = dimension == 3 ? 1 : 0;
  const ConstView phi = phase.fraction[0];
  const EvolveRule &rule = phase.tensor.rule;
  const bool extended = rule.layers > 0;
  // Centres to reset where B is I outside, ghosts included, because an edge depends on the four centres around it.
  std::vector<unsigned char> reset;  // empty if there are none
  const auto centre = [&](int i, int j, int k) {
    return Centre(phase.tensor.field.data() + layout.offset(i, j, k), layout.size, layout.sy, layout.sz, dimension);
  };
  long found = 0;
  for (int k = -layers_z; !extended && k < n[2] + layers_z; ++k)
    for (int j = -1; j <= n[1]; ++j) {
      if (phase.rows.idle(j, k)) continue;
      for (int i = -1; i <= n[0]; ++i) {
        if (!(phi(i, j, k) >= rule.centre)) continue;
        const double largest = phi(i, j, k) > full_cell ? largest_determinant
                               : phi(i, j, k) >= 0.5    ? largest_at_surface
                                                        : largest_outside;
        if (!(centre(i, j, k).determinant() > largest)) continue;
        reset.resize(static_cast<std::size_t>(layout.size));
        reset[layout.offset(i, j, k)] = 1;
        found += i >= 0 && i < n[0] && j >= 0 && j < n[1] && k >= 0 && k < n[2];
      }
    }
  for (int f = 0; !reset.empty() && f < phase.tensor.field.count(); ++f) {
    const TensorComponent &c = phase.tensor.components()[f];
    const auto [a, b, at] = c;  // includes edges in the last ghost layer, which are around owned centres
    const View B = phase.tensor.field[f];
    const std::ptrdiff_t low_a = a == b ? 0 : B.stride(a), low_b = a == b ? 0 : B.stride(b);
    for (int k = 0; k < n[2] + at[2]; ++k)
      for (int j = 0; j < n[1] + at[1]; ++j)
        for (int i = 0; i < n[0] + at[0]; ++i) {
          const unsigned char *is_reset = reset.data() + layout.offset(i, j, k);
          if (is_reset[0] | is_reset[-low_a] | is_reset[-low_b] | is_reset[-low_a - low_b]) B(i, j, k) = c.rest();
        }
  }
  // Centres that are repaired: all that evolve where B is extrapolated; else full cells beside those that were reset,
  // which have lost part of their off-diagonals, so that det B has grown.
  const double solid = extended ? rule.centre : full_cell;
  for (int k = 0; (extended || !reset.empty()) && k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0] && !phase.rows.idle(j, k); ++i) {
        if (!(phi(i, j, k) >= solid)) continue;
        const Centre B = centre(i, j, k);
        if (!(B.determinant() > largest_determinant)) continue;
        const double factor = B.isochoric_factor(dimension);
        for (int d = 0; d < dimension; ++d) phase.tensor.field[d](i, j, k) *= factor;
        ++found;
      }
  return found;
}

PetscErrorCode reset_unresolved(const Domain &domain, Phase &phase, long *count) {
  PetscFunctionBeginUser;
  const long found = reset_unresolved(static_cast<const Box &>(domain), phase);
  PetscCallMPI(MPI_Allreduce(&found, count, 1, MPI_LONG, MPI_SUM, domain.comm()));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
