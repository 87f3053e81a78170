#include "solids/unresolved.hpp"

#include "base/events.hpp"
#include "kernels/stencils.hpp"

#include <vector>

namespace eulastic {
namespace {

// B at a centre, off-diagonals averaged from the edges.
struct Centre {
  double xx, yy, zz = 1, yz = 0, xz = 0, xy;

  // Of the field whose components are `size` doubles apart, at the centre that `b` points to.
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

  // The factor <= 1 of all diagonals (in 2-D but zz) with which det B is 1; B stays positive definite on the way there.
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
  return (dimension == 2 ? mean * mean : mean * mean * mean) > 0.99 * largest_determinant;  // round-off aside
}

long forget_unresolved(const Box &box, Phase &phase) {
  VerbScope scope(Verb::left_cauchy_green);
  const Layout &layout = box.layout();
  const Int3 n = box.cells();
  const int dimension = box.dimension(), deep = dimension == 3 ? 1 : 0;
  const ConstView phi = phase.fraction[0];
  const EvolveRule &rule = phase.tensor.rule;
  const bool extended = rule.layers > 0;
  // Of B that is reset outside. With one layer of ghosts: an edge looks at the four centres around it.
  std::vector<unsigned char> forgotten;  // empty while there is none
  const auto centre = [&](int i, int j, int k) {
    return Centre(phase.tensor.field.data() + layout.offset(i, j, k), layout.size, layout.sy, layout.sz, dimension);
  };
  long found = 0;
  for (int k = -deep; !extended && k < n[2] + deep; ++k)
    for (int j = -1; j <= n[1]; ++j) {
      if (phase.rows.idle(j, k)) continue;
      for (int i = -1; i <= n[0]; ++i) {
        if (!(phi(i, j, k) >= rule.centre)) continue;
        const double largest = phi(i, j, k) > full_cell ? largest_determinant
                               : phi(i, j, k) >= 0.5    ? largest_at_surface
                                                        : largest_outside;
        if (!(centre(i, j, k).determinant() > largest)) continue;
        forgotten.resize(static_cast<std::size_t>(layout.size));
        forgotten[layout.offset(i, j, k)] = 1;
        found += i >= 0 && i < n[0] && j >= 0 && j < n[1] && k >= 0 && k < n[2];
      }
    }
  for (int f = 0; !forgotten.empty() && f < phase.tensor.field.count(); ++f) {
    const TensorComponent &c = phase.tensor.components()[f];
    const auto [a, b, at] = c;  // the last edge in a ghost layer too: its centre is ours
    const View B = phase.tensor.field[f];
    const std::ptrdiff_t low_a = a == b ? 0 : B.stride(a), low_b = a == b ? 0 : B.stride(b);
    for (int k = 0; k < n[2] + at[2]; ++k)
      for (int j = 0; j < n[1] + at[1]; ++j)
        for (int i = 0; i < n[0] + at[0]; ++i) {
          const unsigned char *here = forgotten.data() + layout.offset(i, j, k);
          if (here[0] | here[-low_a] | here[-low_b] | here[-low_a - low_b]) B(i, j, k) = c.rest();
        }
  }
  // Where B is extended, all that evolve. Else full neighbours: they have lost part of their off-diagonals, and det B
  // is larger for it.
  const double solid = extended ? rule.centre : full_cell;
  for (int k = 0; (extended || !forgotten.empty()) && k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0] && !phase.rows.idle(j, k); ++i) {
        if (!(phi(i, j, k) >= solid)) continue;
        const Centre here = centre(i, j, k);
        if (!(here.determinant() > largest_determinant)) continue;
        const double factor = here.isochoric_factor(dimension);
        for (int d = 0; d < dimension; ++d) phase.tensor.field[d](i, j, k) *= factor;
        ++found;
      }
  return found;
}

PetscErrorCode forget_unresolved(const Domain &domain, Phase &phase, long *count) {
  PetscFunctionBeginUser;
  const long found = forget_unresolved(static_cast<const Box &>(domain), phase);
  PetscCallMPI(MPI_Allreduce(&found, count, 1, MPI_LONG, MPI_SUM, domain.comm()));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
