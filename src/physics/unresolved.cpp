#include "physics/unresolved.hpp"

#include "base/events.hpp"
#include "kernels/stencils.hpp"

#include <algorithm>
#include <vector>

namespace eulastic {
namespace {

// Of B at the centre that `b` points to, its components `size` doubles apart.
double determinant(const double *b, std::ptrdiff_t size, std::ptrdiff_t y, std::ptrdiff_t z, int dimension) {
  const double xx = b[0], yy = b[size];
  if (dimension == 2) {
    const double xy = kernels::average4(b + 2 * size, 1, y);
    return xx * yy - xy * xy;
  }
  const double zz = b[2 * size], yz = kernels::average4(b + 3 * size, y, z), xz = kernels::average4(b + 4 * size, 1, z),
               xy = kernels::average4(b + 5 * size, 1, y);
  return xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
}

}  // namespace

bool may_be_unresolved(double trace, int dimension) {
  const double mean = dimension == 2 ? (trace - 1) / 2 : trace / 3;
  return (dimension == 2 ? mean * mean : mean * mean * mean) > 0.99 * largest_determinant;  // round-off aside
}

PetscErrorCode forget_unresolved(const Grid &grid, const EvolveRule &rule, Phase &phase, long *count) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::left_cauchy_green);
  const Layout &layout = grid.layout();
  const Int3 n = grid.owned();
  const int dimension = grid.dimension(), deep = dimension == 3 ? 1 : 0;
  const ConstView phi = phase.fraction[0];
  // With one layer of ghosts: an edge looks at the four centres around it.
  std::vector<unsigned char> forgotten;  // empty while there is none
  long found = 0;
  for (int k = -deep; k < n[2] + deep; ++k)
    for (int j = -1; j <= n[1]; ++j) {
      if (phase.rows.idle(j, k)) continue;
      for (int i = -1; i <= n[0]; ++i) {
        if (!(phi(i, j, k) >= rule.centre)) continue;
        const std::ptrdiff_t p = layout.offset(i, j, k);
        const double largest = phi(i, j, k) > full_cell ? largest_determinant
                               : phi(i, j, k) >= 0.5    ? largest_at_surface
                                                        : largest_outside;
        if (!(determinant(phase.tensor.data() + p, layout.size, layout.sy, layout.sz, dimension) > largest)) continue;
        forgotten.resize(static_cast<std::size_t>(layout.size));
        forgotten[p] = 1;
        found += i >= 0 && i < n[0] && j >= 0 && j < n[1] && k >= 0 && k < n[2];
      }
    }
  const auto &components = tensor_components(dimension);
  for (int f = 0; !forgotten.empty() && f < phase.tensor.count(); ++f) {
    const auto [a, b] = components[f];
    const View B = phase.tensor[f];
    const std::ptrdiff_t low_a = a == b ? 0 : B.stride(a), low_b = a == b ? 0 : B.stride(b);
    const Staggering at = components[f].staggering();
    for (int k = 0; k < grid.points_end(2, at[2]); ++k)
      for (int j = 0; j < grid.points_end(1, at[1]); ++j)
        for (int i = 0; i < grid.points_end(0, at[0]); ++i) {
          const unsigned char *here = forgotten.data() + layout.offset(i, j, k);
          if (here[0] | here[-low_a] | here[-low_b] | here[-low_a - low_b]) B(i, j, k) = a == b ? 1 : 0;
        }
  }
  PetscCallMPI(MPI_Allreduce(&found, count, 1, MPI_LONG, MPI_SUM, grid.comm()));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
