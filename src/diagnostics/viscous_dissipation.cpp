#include "diagnostics/viscous_dissipation.hpp"

#include "flow/tangential_rows.hpp"

namespace eulastic {
namespace {

double square(double x) { return x * x; }

// nu (d_b v_a + d_a v_b)^2 on the low edge, normal to a and b, of the cell `edge`.
double on_edge(const Field &viscosity, const Field &velocity, const Real3 &h, int slot, int a, int b,
               const Int3 &edge) {
  const ConstView u = velocity[a], v = velocity[b];
  const double *p = &u(edge[0], edge[1], edge[2]), *q = &v(edge[0], edge[1], edge[2]);
  const double rate = (*p - p[-u.stride(b)]) / h[b] + (*q - q[-v.stride(a)]) / h[a];
  return viscosity[slot](edge[0], edge[1], edge[2]) * square(rate);
}

// Dissipation by the deviator of 2 D at a centre.
double at_centre_of(const ConstView &viscosity, const Field &velocity, const Real3 &h, int dimension,
                    const Int3 &cell) {
  double rate[3] = {}, sum = 0;
  for (int a = 0; a < dimension; ++a) {
    const ConstView u = velocity[a];
    const double *p = &u(cell[0], cell[1], cell[2]);
    rate[a] = (p[u.stride(a)] - *p) / h[a];
  }
  for (int a = 0; a < dimension; ++a)
    for (int b = a + 1; b < dimension; ++b) sum += square(rate[a] - rate[b]);
  return (dimension == 2 ? 1 : 2. / 3) * viscosity(cell[0], cell[1], cell[2]) * sum;
}

// Dissipation by the stress along surfaces, (29a). It equals stress times its own rate of strain, as neither has shear
// across the surface.
template <int Dim>
double along_surface(const Box &box, const Field &viscosity, const Field &velocity, const Int3 &cell) {
  const kernels::TangentialStress<Dim> stress = tangential_stress<Dim>(box, viscosity, velocity, cell[1], cell[2]);
  if (stress.excess[cell[0]] == 0) return 0;
  const typename kernels::TangentialStress<Dim>::Rate D = stress.rate(cell[0]);
  const double sum =
      0.5 * square(D.xx) + 0.5 * square(D.yy) + 0.5 * square(D.zz) + square(D.yz) + square(D.xz) + square(D.xy);
  return stress.excess[cell[0]] * sum;
}

}  // namespace

void viscous_dissipation(const Box &box, const Field &viscosity, const Field &velocity, const Segment &row,
                         double *out) {
  const int dim = box.dimension();
  const Real3 &h = box.spacing();
  // Share of the control volume of edges with this index along d: half on a boundary; behind the last cell only edges
  // on a boundary count.
  const auto share = [&](int d, int index) {
    if (index == 0) return box.touches_low(d) ? 0.5 : 1.0;
    if (index == box.cells()[d]) return box.touches_high(d) ? 0.5 : 0.0;
    return 1.0;
  };
  for (int i = 0; i < box.cells()[0]; ++i) {
    const Int3 cell{i, row.j, row.k};
    double sum = at_centre_of(viscosity[0], velocity, h, dim, cell) +
                 (dim == 2 ? along_surface<2> : along_surface<3>)(box, viscosity, velocity, cell);
    for (int a = 0; a < dim; ++a)
      for (int b = a + 1; b < dim; ++b)
        for (int upper_a = 0; upper_a < 2; ++upper_a)
          for (int upper_b = 0; upper_b < 2; ++upper_b) {
            if ((upper_a && cell[a] + 1 < box.cells()[a]) || (upper_b && cell[b] + 1 < box.cells()[b])) continue;
            Int3 edge = cell;
            edge[a] += upper_a;
            edge[b] += upper_b;
            const double along_a = share(a, edge[a]), along_b = share(b, edge[b]);
            if (along_a == 0 || along_b == 0 || (along_a < 1 && along_b < 1)) continue;
            sum += along_a * along_b * on_edge(viscosity, velocity, h, viscosity_of_edge(dim, a, b), a, b, edge);
          }
    out[i] = sum;
  }
}

}  // namespace eulastic
