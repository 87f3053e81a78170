#include "physics/viscosity.hpp"

#include "base/events.hpp"
#include "grid/row_scratch.hpp"
#include "grid/threads.hpp"
#include "kernels/stencils.hpp"

#include <algorithm>

namespace eulastic {
namespace {

// Adds a phase to the solid fraction of a row and to what its fluidity 1/nu has beyond the fluid's.
EULASTIC_CLONES void add_phase_row(const double *phi, double excess, int begin, int end, double *solid, double *sum) {
#pragma omp simd
  for (int i = begin; i < end; ++i) {
    const double below = phi[i] < 0 ? 0 : phi[i], part = below > 1 ? 1 : below;
    solid[i] += part;
    sum[i] = kernels::fma(excess, part, sum[i]);
  }
}

// Where phases overlap their fractions share the cell.
EULASTIC_CLONES void end_fluidity_row(double fluid, const double *solid, const double *sum, int begin, int end,
                                      double *fluidity) {
#pragma omp simd
  for (int i = begin; i < end; ++i) fluidity[i] = fluid + sum[i] / (solid[i] > 1 ? solid[i] : 1);
}

EULASTIC_CLONES void edge_row(const double *fluidity, std::ptrdiff_t a, std::ptrdiff_t b, int begin, int end,
                              double *viscosity) {
#pragma omp simd
  for (int i = begin; i < end; ++i) viscosity[i] = 4 / kernels::sum4(fluidity + i, -a, -b);
}

EULASTIC_CLONES void centre_row(int begin, int end, double *values) {
#pragma omp simd
  for (int i = begin; i < end; ++i) values[i] = 1 / values[i];
}

class Fluidity {
public:
  Fluidity(const Grid &grid, const Fluid &fluid, const std::vector<Phase> &phases)
      : grid_(grid), phases_(phases), fluid_(fluid.density / fluid.viscosity) {
    for (const Phase &phase : phases) excess_.push_back(fluid.density / viscosity_of(phase.material, fluid) - fluid_);
  }

  void row(int j, int k, double *solid, double *sum, double *out) const {
    const Int3 &n = grid_.owned();
    const int begin = -1, end = n[0] + 1;
    const bool owned = j >= 0 && j < n[1] && k >= 0 && k < n[2];
    std::fill(solid + begin, solid + end, 0.0);
    std::fill(sum + begin, sum + end, 0.0);
    for (std::size_t p = 0; p < phases_.size(); ++p)
      if (!(owned && phases_[p].rows.idle(j, k)))
        add_phase_row(phases_[p].fraction[0].row(j, k), excess_[p], begin, end, solid, sum);
    end_fluidity_row(fluid_, solid, sum, begin, end, out);
  }

private:
  const Grid &grid_;
  const std::vector<Phase> &phases_;
  double fluid_;
  std::vector<double> excess_;
};

template <class Row>
void for_rows_with_ghosts(const Grid &grid, const Row &row) {
  in_row_parts(grid, [&](const RowPart &owned) {
    const RowPart part = owned.with_ghosts(grid);
    RowScratch scratch(grid, 2);
    for (int k = part.k_begin; k < part.k_end; ++k)
      for (int j = part.j_begin; j < part.j_end; ++j) row(j, k, scratch);
  });
}

}  // namespace

// Stress is G phi dev(B): of a cell that is phi full the ratio of stiffness to viscosity is rho c^2 times
// phi ((1 - phi)/mu_f + phi/mu_s), largest in the body or, if that is more than twice as viscous, in cells of its
// surface.
void ViscosityContrast::add(const Material &material, double stiffness) {
  const double own = material.viscosity > 0 ? material.viscosity : fluid;
  least = std::min(least, own);
  most = std::max(most, own);
  // Membranes bear more than ten times the step of a tension as large as their moduli.
  constexpr double share = 0.25;
  const double tension =
      std::max(material.surface_tension, material.is_membrane() ? share * material.membrane.largest_modulus() : 0);
  surface_tension = std::max(surface_tension, tension);
  if (tension > 0) capillary_speed = std::max(capillary_speed, 2 * tension / (own + fluid));
  const double bending = material.is_membrane() ? material.membrane.bending_modulus : 0;
  bending_modulus = std::max(bending_modulus, bending);
  bending_rate = std::max(bending_rate, 2 * bending / (own + fluid));
  if (!(stiffness > 0)) return;
  const double weakest = own > 2 * fluid ? 4 * fluid * (1 - fluid / own) : own;
  kelvin_voigt = std::min(kelvin_voigt, 2 * weakest / stiffness);
}

PetscErrorCode compute_viscosity(const Grid &grid, const Fluid &fluid, const std::vector<Phase> &phases,
                                 FieldBlock &viscosity) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::viscous);
  const int dim = grid.dimension(), end = grid.owned()[0] + 1;
  const Fluidity fluidity(grid, fluid, phases);
  const View centre = viscosity[0];
  for_rows_with_ghosts(grid, [&](int j, int k, const RowScratch &scratch) {
    fluidity.row(j, k, scratch.row(0), scratch.row(1), centre.row(j, k));
  });
  for_rows_with_ghosts(grid, [&](int j, int k, const RowScratch &) {
    if (j < 0 || k < 0) return;
    for (int a = 0; a < dim; ++a)
      for (int b = a + 1; b < dim; ++b)
        edge_row(centre.row(j, k), centre.stride(a), centre.stride(b), 0, end,
                 viscosity[viscosity_of_edge(dim, a, b)].row(j, k));
  });
  for_rows_with_ghosts(grid, [&](int j, int k, const RowScratch &) { centre_row(-1, end, centre.row(j, k)); });
  scope.flops(grid.owned_count() * (4. * double(phases.size()) + (dim == 2 ? 7 : 15)));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
