#include "solver/state.hpp"

#include "field/exact_sum.hpp"

namespace eulastic {

PetscErrorCode state_hash(const Grid &grid, const State &state, std::uint64_t *hash) {
  PetscFunctionBeginUser;
  std::uint64_t sum = 0, salt = 0;
  for (int d = 0; d < state.velocity.count(); ++d) sum += hash_points(grid, state.velocity[d], at_face[d], ++salt);
  sum += hash_points(grid, state.pressure[0], at_centre, ++salt);
  for (const Phase &phase : state.phases) {
    sum += hash_points(grid, phase.fraction[0], at_centre, ++salt);
    for (int c = 0; c < phase.tensor.field.count(); ++c)
      sum += hash_points(grid, phase.tensor.field[c], phase.tensor.components()[c].at, ++salt);
    if (phase.label) sum += hash_points(grid, phase.label[0], at_centre, ++salt);
  }
  for (const SurfaceMarker &marker : state.markers) {
    const auto values = marker.packed();
    sum += hash_values(values.data(), values.size());
  }
  PetscCallMPI(MPI_Allreduce(&sum, hash, 1, MPI_UINT64_T, MPI_SUM, grid.comm()));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
