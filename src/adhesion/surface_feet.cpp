#include "adhesion/surface_feet.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace eulastic {
namespace {

// Of the plane in a cell, the way from the cell's centre to its point that is nearest to `from`, itself seen from the
// centre; clamped to the cell. False where the cell is not cut.
bool nearest_in_cell(const Box &box, ConstView phi, const Int3 &cell, const Real3 &from, Real3 *nearest) {
  const double here = phi(cell[0], cell[1], cell[2]);
  if (!(here > 1e-3 && here < 1 - 1e-3)) return false;
  const Real3 &h = box.spacing();
  Real3 normal{};
  double squares = 0;
  for (int d = 0; d < box.dimension(); ++d) {
    const std::ptrdiff_t step = phi.stride(d);
    const double *at = &phi(cell[0], cell[1], cell[2]);
    normal[d] = (at[step] - at[-step]) / (2 * h[d]);
    squares += normal[d] * normal[d];
  }
  const double steepness = std::sqrt(squares);
  if (!(steepness > 0)) return false;
  double height = (0.5 - here) / steepness, away = -height;  // of the plane above the centre, of `from` above the plane
  for (int d = 0; d < box.dimension(); ++d) away += from[d] * normal[d] / steepness;
  for (int d = 0; d < box.dimension(); ++d)
    (*nearest)[d] = std::clamp(from[d] - away * normal[d] / steepness, -0.5 * h[d], 0.5 * h[d]);
  return true;
}

}  // namespace

PetscErrorCode find_feet(const Domain &domain, const Phase &phase, const std::vector<Real3> &places,
                         const std::vector<char> &wanted, std::vector<Foot> *feet) {
  const int dimension = domain.dimension(), deep = dimension == 3 ? foot_reach : 0;
  const Real3 &h = domain.spacing();
  const Layout &layout = domain.layout();
  const ConstView phi = std::as_const(phase.fraction)[0];
  PetscFunctionBeginUser;
  feet->assign(places.size(), {});
  for (std::size_t p = 0; p < places.size(); ++p) {
    if (!wanted[p]) continue;
    Int3 cell{}, plain{};
    for (int d = 0; d < dimension; ++d) {
      plain[d] = static_cast<int>(std::floor(places[p][d] / h[d]));
      cell[d] = domain.is_wall(d) ? std::clamp(plain[d], 0, domain.domain_cells()[d] - 1) : domain.image(d, plain[d]);
    }
    if (domain.owner(cell[0], cell[1], cell[2]) != domain.rank()) continue;
    double least = HUGE_VAL;
    for (int z = -deep; z <= deep; ++z)
      for (int y = -foot_reach; y <= foot_reach; ++y)
        for (int x = -foot_reach; x <= foot_reach; ++x) {
          const int step[3] = {x, y, z};
          Int3 local{};
          Real3 from{}, nearest{};
          for (int d = 0; d < dimension; ++d) {
            local[d] = cell[d] + step[d] - layout.begin[d];
            from[d] = places[p][d] - (plain[d] + step[d] + 0.5) * h[d];
          }
          if (!nearest_in_cell(domain, phi, local, from, &nearest)) continue;
          double distance = 0;
          for (int d = 0; d < dimension; ++d) distance += std::pow(nearest[d] - from[d], 2);
          if (distance >= least) continue;
          least = distance;
          Foot &foot = (*feet)[p];
          foot.found = 1;
          for (int d = 0; d < dimension; ++d) foot.place[d] = places[p][d] + (nearest[d] - from[d]);
        }
  }
  constexpr int numbers = sizeof(Foot) / sizeof(double);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, feet->data(), static_cast<int>(numbers * feet->size()), MPI_DOUBLE, MPI_SUM,
                             domain.comm()));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
