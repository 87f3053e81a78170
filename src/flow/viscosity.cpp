#include "flow/viscosity.hpp"

#include "base/events.hpp"
#include "grid/row_scratch.hpp"
#include "grid/threads.hpp"
#include "kernels/interface_normal.hpp"
#include "kernels/stencils.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

constexpr int ghosts = 2;  // ghosts of phi: for the edges of a cell in the ghost layer

// Adds a phase to the solid fraction of a row, to the excess of its fluidity 1/nu over that of the fluid, and to its
// difference of viscosity relative to the largest one.
EULASTIC_CLONES void add_phase_row(const double *phi, double excess, double share, int begin, int end, double *solid,
                                   double *fluidity, double *difference) {
#pragma omp simd
  for (int i = begin; i < end; ++i) {
    const double below = phi[i] < 0 ? 0 : phi[i], part = below > 1 ? 1 : below;
    solid[i] += part;
    fluidity[i] = kernels::fma(excess, part, fluidity[i]);
    difference[i] = kernels::fma(share, part, difference[i]);
  }
}

// Where the sum of fractions exceeds 1, it is normalised.
EULASTIC_CLONES void end_mixture_row(double fluid, const double *solid, int begin, int end, double *fluidity,
                                     double *difference) {
#pragma omp simd
  for (int i = begin; i < end; ++i) {
    const double divisor = solid[i] > 1 ? solid[i] : 1;
    fluidity[i] = fluid + fluidity[i] / divisor;
    difference[i] /= divisor;
  }
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

// The mixture of fluid and phases in the cells: the arithmetic mean is nu = fluid + most difference, the harmonic mean
// 1/fluidity.
struct Mixture {
  double fluid, most = 0;
  const Field &fluidity, &difference;
  std::vector<double> excess, share;  // of every phase

  Mixture(const Fluid &carrier, const std::vector<Phase> &phases, const Field &f, const Field &d)
      : fluid(carrier.kinematic_viscosity()), fluidity(f), difference(d) {
    for (const Phase &phase : phases) share.push_back(viscosity_of(phase.material, carrier) / carrier.density - fluid);
    for (const double s : share) most = std::fabs(s) > std::fabs(most) ? s : most;
    for (double &s : share) {
      excess.push_back(1 / (fluid + s) - 1 / fluid);
      s /= most;
    }
  }
};

void fill_row(const Box &box, const std::vector<Phase> &phases, const Mixture &mixture, int j, int k, double *solid,
              double *fluidity, double *difference) {
  const Int3 &n = box.cells();
  const int begin = -ghosts, end = n[0] + ghosts;
  const bool owned = j >= 0 && j < n[1] && k >= 0 && k < n[2];
  for (double *row : {solid, fluidity, difference}) std::fill(row + begin, row + end, 0.0);
  for (std::size_t p = 0; p < phases.size(); ++p)
    if (!(owned && phases[p].rows.idle(j, k)))
      add_phase_row(phases[p].fraction[0].row(j, k), mixture.excess[p], mixture.share[p], begin, end, solid, fluidity,
                    difference);
  end_mixture_row(1 / mixture.fluid, solid, begin, end, fluidity, difference);
}

// Computes the excess of the arithmetic over the harmonic mean in cells that a surface cuts, averaged over the
// components of a tensor at the centre and on the edges around, and the normal of the surface.
template <int Dim>
EULASTIC_INLINE void along_surface(const Segment &row, const Mixture &mixture, const Real3 &spacing,
                                   const View *fields) {
  const ConstView f = mixture.fluidity[0];
  const double *F = f.row(row.j, row.k), *q = mixture.difference[0].row(row.j, row.k);
  const std::ptrdiff_t x = f.stride(0), y = f.stride(1), z = f.stride(2);
  const double fluid = mixture.fluid, most = mixture.most, least = 1e-6 * std::fabs(most);
  const double ix = 1 / spacing[0], iy = 1 / spacing[1], iz = Dim == 3 ? 1 / spacing[2] : 0;
  const auto edge = [=](std::ptrdiff_t i, std::ptrdiff_t a, std::ptrdiff_t b) EULASTIC_BODY {
    return kernels::fma(most, kernels::average4(q + i, -a, -b), fluid) - 4 / kernels::sum4(F + i, -a, -b);
  };
  const auto around = [=](std::ptrdiff_t i, std::ptrdiff_t a, std::ptrdiff_t b) EULASTIC_BODY {
    return 0.25 * ((edge(i, a, b) + edge(i + a + b, a, b)) + (edge(i + a, a, b) + edge(i + b, a, b)));
  };
  double *excess_viscosity = fields[0].row(row.j, row.k), *nx = fields[1].row(row.j, row.k),
         *ny = fields[2].row(row.j, row.k);
  double *nz = Dim == 3 ? fields[3].row(row.j, row.k) : ny;
#pragma omp simd
  for (int i = row.i_begin; i < row.i_end; ++i) {
    const double excess_at_centre = kernels::fma(most, q[i], fluid) - 1 / F[i];
    const double mean = Dim == 2
                            ? 0.5 * (excess_at_centre + around(i, x, y))
                            : (3 * excess_at_centre + 2 * ((around(i, y, z) + around(i, x, z)) + around(i, x, y))) / 9;
    excess_viscosity[i] = excess_at_centre > least ? mean : 0;
    const kernels::InterfaceNormal n = kernels::interface_normal<Dim>(q + i, x, y, z);
    const double a = ix * n.a, b = iy * n.b, c = iz * n.c, size = __builtin_sqrt((a * a + b * b) + c * c);
    const double scale = size > 0 ? 1 / size : 0;
    nx[i] = scale * a;
    ny[i] = scale * b;
    if (Dim == 3) nz[i] = scale * c;
  }
}

EULASTIC_CLONES void along_surface_2d(const Segment &row, const Mixture &mixture, const Real3 &h, const View *fields) {
  along_surface<2>(row, mixture, h, fields);
}
EULASTIC_CLONES void along_surface_3d(const Segment &row, const Mixture &mixture, const Real3 &h, const View *fields) {
  along_surface<3>(row, mixture, h, fields);
}

// Clears the excess beside boundaries other than planes of symmetry, so that edges on a boundary are not affected.
void clear_beside_sides(const Box &box, const BoundaryConditions &sides, const Segment &row, double *values) {
  const int place[3] = {0, row.j, row.k};
  for (const auto [d, high] : box.sides()) {
    if (!box.touches(d, high) || sides[d][high].kind == BoundaryKind::symmetry) continue;
    const int first = box.cells()[d] - 1;
    if (d > 0 && (high ? place[d] >= first : place[d] <= 0)) std::fill(values + row.i_begin, values + row.i_end, 0.0);
    if (d > 0) continue;
    const int begin = high ? std::max(row.i_begin, first) : row.i_begin;
    const int end = high ? row.i_end : std::min(row.i_end, 1);
    if (begin < end) std::fill(values + begin, values + end, 0.0);
  }
}

// Clears the excess beside rigid bodies, because the velocity of faces inside them is not that of the fluid.
void clear_beside_rigid(const Box &box, const std::vector<Phase> &phases, const Segment &row, double *values) {
  const int layers_z = box.dimension() == 3 ? 1 : 0;
  for (const Phase &phase : phases) {
    if (!phase.material.is_rigid()) continue;
    const ConstView phi = phase.fraction[0];
    for (int i = row.i_begin; i < row.i_end; ++i) {
      if (values[i] == 0) continue;
      double solid = 0;
      for (int k = row.k - layers_z; k <= row.k + layers_z; ++k)
        for (int j = row.j - 1; j <= row.j + 1; ++j)
          for (int x = i - 1; x <= i + 1; ++x) solid = std::max(solid, phi(x, j, k));
      if (solid > 0) values[i] = 0;
    }
  }
}

void clear(const ActiveSegments &cells, View field) {
  for (const Segment &s : cells.all()) {
    double *row = field.row(s.j, s.k);
    std::fill(row + s.i_begin, row + s.i_end, 0.0);
  }
}

// Calls visit(j, k, scratch) for all rows, including `layers` ghost layers.
template <class Row>
void for_rows_with_ghosts(const Box &box, int layers, const Row &visit) {
  const int layers_z = box.dimension() == 3 ? layers : 0, parts = row_parts(box);
  const int rows = box.cells()[1] + 2 * layers, planes = box.cells()[2] + 2 * layers_z;
  in_parallel(parts, parts, [&](int part) {
    const Piece piece(std::size_t(rows) * planes, part, parts);
    RowScratch scratch(box, 1);
    for (std::size_t r = piece.begin; r < piece.end; ++r)
      visit(static_cast<int>(r % rows) - layers, static_cast<int>(r / rows) - layers_z, scratch.row(0));
  });
}

}  // namespace

// The stress is G phi dev(B). In a cell with the solid fraction phi the ratio of stiffness to viscosity is rho c^2
// times phi ((1 - phi)/mu_f + phi/mu_s). Its maximum is in the body or, if this is more than twice as viscous, in cells
// at its surface.
void ViscosityContrast::add(const Material &material, double stiffness) {
  const double own = material.viscosity > 0 ? material.viscosity : fluid;
  least = std::min(least, own);
  most = std::max(most, own);
  // A quarter of the moduli: membranes are stable with steps more than ten times as long as for a tension of that size.
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

LocalViscosity::LocalViscosity(const Box &box)
    : fields(box, viscosity_fields(box.dimension())),
      stress(box, static_cast<int>(tensor_components(box.dimension()).size())) {}

PetscErrorCode compute_viscosity(const Box &box, const Fluid &fluid, const BoundaryConditions &sides,
                                 const std::vector<Phase> &phases, LocalViscosity *viscosity) {
  PetscFunctionBeginUser;
  EventScope scope(Event::viscous);
  const int dim = box.dimension(), end = box.cells()[0] + 1;
  Field &fields = viscosity->fields;
  const Field fluidity = fields.part(0, 1), difference = viscosity->stress.part(0, 1);
  const Mixture mixture(fluid, phases, fluidity, difference);
  const View centre = fields[0], mixed = viscosity->stress[0];
  const int along = viscosity_along_surface(dim);
  for (int c = 0; c < viscosity->stress.count(); ++c) clear(viscosity->stressed, viscosity->stress[c]);
  clear(viscosity->cut, fields[along]);
  for_rows_with_ghosts(box, ghosts, [&](int j, int k, double *solid) {
    fill_row(box, phases, mixture, j, k, solid, centre.row(j, k), mixed.row(j, k));
  });
  OccupiedRows rows = phases.front().rows;
  for (const Phase &phase : phases) rows.join(phase.rows);
  viscosity->cut.build_band(box, difference[0], rows, 1);
  const View surface[4] = {fields[along], fields[along + 1], fields[along + 2], fields[along + dim]};
  const std::vector<Segment> &cut = viscosity->cut.all();
  const int parts = row_parts(box);
  in_parallel(parts, parts, [&](int part) {
    const Piece piece(cut.size(), part, parts);
    for (std::size_t s = piece.begin; s < piece.end; ++s) {
      (dim == 2 ? along_surface_2d : along_surface_3d)(cut[s], mixture, box.spacing(), surface);
      clear_beside_sides(box, sides, cut[s], surface[0].row(cut[s].j, cut[s].k));
      clear_beside_rigid(box, phases, cut[s], surface[0].row(cut[s].j, cut[s].k));
    }
  });
  viscosity->stressed.build_within(box, viscosity->cut, surface[0]);
  viscosity->beside.build(box, surface[0], rows, 1e-9 * std::fabs(mixture.most), 1, 1);
  for_rows_with_ghosts(box, 1, [&](int j, int k, double *) {
    if (j < 0 || k < 0) return;
    for (int a = 0; a < dim; ++a)
      for (int b = a + 1; b < dim; ++b)
        edge_row(centre.row(j, k), centre.stride(a), centre.stride(b), 0, end,
                 fields[viscosity_of_edge(dim, a, b)].row(j, k));
  });
  for_rows_with_ghosts(box, ghosts, [&](int j, int k, double *) {
    centre_row(-1, end, centre.row(j, k));
    std::fill(mixed.row(j, k) - ghosts, mixed.row(j, k) + end + 1, 0.0);
  });
  scope.flops(box.cell_count() * (6. * double(phases.size()) + (dim == 2 ? 7 : 15)) +
              viscosity->cut.points() * (dim == 2 ? 90 : 330));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
