// Membrane: energies and power of membranes.
#include "base/events.hpp"
#include "base/exact_sum.hpp"
#include "physics/membrane.hpp"
#include "physics/membrane_tensor.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

// Per volume of a cell.
struct Energies {
  double shear, area;
  double rest, stretch;  ///< of SurfaceSample
  double total() const { return shear + area; }
};
template <int Dim>
Energies energies_at(const Phase &phase, const SurfaceCells::Cell &cell) {
  const kernels::SurfaceStrain strain = kernels::surface_strain<Dim>(tensor_at<Dim>(phase.tensor.field, cell.at));
  const kernels::MembraneState state = kernels::membrane_state(phase.material.membrane, strain);
  const double area = kernels::area_energy(phase.material.membrane, strain), weight = cell.delta / state.area;
  return {weight * (state.energy - area), weight * area, weight, kernels::larger_stretch(strain)};
}

// Of the surface that curvatures are those of: a filter moves both, and what it does to the area makes up for the
// curvature.
double smoothed_delta(const Box &box, ConstView psi, std::ptrdiff_t at) {
  const double *p = psi.origin + at;
  Real3 g{};
  for (int d = 0; d < box.dimension(); ++d) g[d] = (p[psi.stride(d)] - p[-psi.stride(d)]) / (2 * box.spacing()[d]);
  return std::sqrt((g[0] * g[0] + g[1] * g[1]) + g[2] * g[2]);
}

Real3 centre_velocity(const Field &velocity, std::ptrdiff_t at) {
  Real3 v{};
  for (int d = 0; d < velocity.count(); ++d) {
    const double *face = velocity[d].origin + at;
    v[d] = 0.5 * (face[0] + face[velocity[d].stride(d)]);
  }
  return v;
}

}  // namespace

PetscErrorCode MembraneMechanics::measure(const Phase &phase, const Field &velocity, const WallFilm &film, int label,
                                          std::vector<ExactSums> *sum, std::vector<SurfaceSample> *samples) {
  PetscFunctionBeginUser;
  const Box &box = *place_.box;
  const int dim = box.dimension(), n = box.cells()[0], first = box.layout().begin[0];
  const double volume = box.cell_volume();
  std::vector<double> bending;
  PetscCall(for_force_rows(
      phase,
      [&](int part, bool, int a, int j, int k, double *force) {
        const double *v = velocity[a].row(j, k);
        for (int i = 0; i < n; ++i) force[i] *= -v[i];
        (*sum)[part].add_row(power, force, n, first);
      },
      &bending));
  VerbScope scope(Verb::sums);
  film.add_energy(phase, velocity, power, stored, &sum->front());
  for (std::size_t c = 0; c < bending.size(); ++c)
    if (bending[c] > 0) bending[c] *= smoothed_delta(box, smooth(), surface_.all()[c].at);
  std::vector<int> labels;
  if (samples && label > 0)
    labels.assign(bending.size(), label);
  else if (samples && phase.label)
    PetscCall(surface_.find_labels(phase, surface_fields_, &labels));
  for (std::size_t c = 0; c < bending.size(); ++c) {
    const SurfaceCells::Cell &cell = surface_.all()[c];
    if (!cell.owned) continue;
    const Energies energies = dim == 2 ? energies_at<2>(phase, cell) : energies_at<3>(phase, cell);
    sum->front().add(stored, energies.total() + bending[c]);
    if (!labels.empty())
      samples->push_back({labels[c], cell.place, cell.delta, energies.rest, energies.stretch,
                          centre_velocity(velocity, cell.at), energies.shear * volume, energies.area * volume,
                          bending[c] * volume});
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
