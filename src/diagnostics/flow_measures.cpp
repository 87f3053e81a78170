#include "diagnostics/flow_measures.hpp"

#include "base/events.hpp"
#include "diagnostics/energy_rates.hpp"
#include "flow/local_viscosity.hpp"
#include "flow/tangential_rows.hpp"
#include "grid/sum_row_parts.hpp"

#include <algorithm>
#include <cmath>

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

// Writes tau : grad v per mass of the cells of a row to out[0 .. cells): normal stress at the centre, shear on the
// cell's low edges. Edges on a boundary count half, and those on a high boundary belong to the last cell; an edge on
// two boundaries does not move. The sum is the power of the walls less that of add_viscous_force(), (30).
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

enum Sum { speed_squared, momentum_x, momentum_y, momentum_z, divergence_squared, gradient_squared, flow_sums };
enum Maximum { max_speed_squared, max_divergence, maxima };

// Computes each measure for the cells of one row at a time.
class RowMeasures {
public:
  RowMeasures(const Box &box, const Field &velocity)
      : box_(box), velocity_(velocity), dimension_(box.dimension()), n_(box.cells()[0]), values_(n_) {}

  /// Sum over the components of term(q, next, 1/h), with the values q and next on both faces of a cell.
  template <class Term>
  const double *sum(const Segment &row, const Term &term) {
    std::fill(values_.begin(), values_.end(), 0.0);
    for (int c = 0; c < dimension_; ++c) {
      const ConstView view = velocity_[c];
      const double *q = view.row(row.j, row.k), *next = q + view.stride(c), inverse_h = 1 / box_.spacing()[c];
      for (int i = 0; i < n_; ++i) values_[i] += term(q[i], next[i], inverse_h);
    }
    return values_.data();
  }

  /// Sum of (dv_a/dx_b)^2 in compact differences: dv_a/dx_a at the centre, the others on the cell's low edges.
  const double *squared_gradient(const Segment &row) {
    std::fill(values_.begin(), values_.end(), 0.0);
    for (int a = 0; a < dimension_; ++a)
      for (int b = 0; b < dimension_; ++b)
        if (a == b)
          add_difference(row, a, b, +1, 0, n_, 1);
        else
          add_cross_differences(row, a, b);
    return values_.data();
  }

  const double *squared(const double *from) {
    for (int i = 0; i < n_; ++i) values_[i] = square(from[i]);
    return values_.data();
  }

private:
  void add_difference(const Segment &row, int a, int b, int side, int begin, int end, double weight) {
    const ConstView view = velocity_[a];
    const double *q = view.row(row.j, row.k), *other = q + side * view.stride(b), inverse_h = 1 / box_.spacing()[b];
    for (int i = begin; i < end; ++i) values_[i] += weight * square((other[i] - q[i]) * inverse_h);
  }

  // Edges on a wall normal to b have half a control volume; those on the high wall belong to the last cell. A face on a
  // wall does not move, so that there is no shear where this wall meets a moving one.
  void add_cross_differences(const Segment &row, int a, int b) {
    const int last = box_.cells()[b] - 1, index = b == 1 ? row.j : row.k;
    if (a != 0 && box_.touches_low(a) && (a == 1 ? row.j : row.k) == 0) return;
    const int begin = a == 0 && box_.touches_low(0) ? 1 : 0;
    const bool low = box_.touches_low(b), high = box_.touches_high(b);
    if (b == 0) {
      if (low) add_difference(row, a, b, -1, 0, 1, 0.5);
      add_difference(row, a, b, -1, low ? 1 : 0, n_, 1);
      if (high) add_difference(row, a, b, +1, last, last + 1, 0.5);
    } else {
      add_difference(row, a, b, -1, begin, n_, low && index == 0 ? 0.5 : 1);
      if (high && index == last) add_difference(row, a, b, +1, begin, n_, 0.5);
    }
  }

  const Box &box_;
  const Field &velocity_;
  int dimension_, n_;
  std::vector<double> values_;
};

// Corrections on a boundary that volume crosses: each face has half a control volume, where the rows have counted a
// whole one on low boundaries and none on high ones, and there is no shear along these boundaries. `viscosity`: weight
// of the squared gradients.
void add_boundary_faces(const Box &box, const Field &velocity, double viscosity, int d, bool high, ExactSums *sums) {
  const ConstView v = velocity[d];
  for_points(box.boundary_faces(d, high), [&](int i, int j, int k) {
    const double *q = &v(i, j, k), half = high ? 0.5 : -0.5;
    sums->add(speed_squared, half * q[0] * q[0]);
    sums->add(momentum_x + d, half * q[0]);
    for (int e = 0; e < box.dimension(); ++e) {
      if (e == d) continue;
      const int index = Int3{i, j, k}[e];
      const std::ptrdiff_t step = v.stride(e);
      const double inverse_h = 1 / box.spacing()[e], share = index == 0 && box.touches_low(e) ? 0.25 : 0.5;
      sums->add(gradient_squared, viscosity * share * square((q[0] - q[-step]) * inverse_h));
      if (index == box.cells()[e] - 1 && box.touches_high(e))
        sums->add(gradient_squared, viscosity * 0.25 * square((q[step] - q[0]) * inverse_h));
    }
  });
}

double largest(const double *values, int n, double so_far) {
  for (int i = 0; i < n; ++i) so_far = std::max(so_far, std::abs(values[i]));
  return so_far;
}

// Computes the measures from sums and maxima over all ranks, in the order of the enumerations above.
FlowMeasures evaluate(const Box &box, const FlowParameters &numbers, const double *sum,
                      const std::vector<double> &maximum) {
  FlowMeasures m;
  const double volume = box.cell_volume(), cells = box.domain_cell_count();
  m.kinetic_energy = 0.5 * numbers.density * sum[speed_squared] * volume;
  for (int c = 0; c < 3; ++c) m.bulk_velocity[c] = sum[momentum_x + c] / cells;
  // Maxima ignore NaN; adding 0 * sum restores it.
  m.speed_max = std::sqrt(maximum[max_speed_squared]) + 0 * sum[speed_squared];
  const Real3 &h = box.spacing();
  const double smallest = *std::min_element(h.begin(), h.begin() + box.dimension());
  const double speed = std::max(m.speed_max, numbers.force * numbers.dt);
  const double scale = speed > 0 ? smallest / speed : 0;
  m.divergence_rms = std::sqrt(sum[divergence_squared] / cells) * scale;
  m.divergence_max = maximum[max_divergence] * scale + 0 * sum[divergence_squared];
  m.viscous_dissipation =
      (numbers.local_viscosity ? numbers.density : numbers.viscosity) * sum[gradient_squared] * volume;
  return m;
}

}  // namespace

PetscErrorCode measure_flow(const Domain &domain, const Field &velocity, const FlowParameters &numbers,
                            FlowMeasures *measures) {
  PetscFunctionBeginUser;
  EventScope scope(Event::sums);
  const int dimension = domain.dimension(), n = domain.cells()[0], first = domain.layout().begin[0];
  std::vector<std::vector<double>> found(row_parts(domain), std::vector<double>(maxima, 0.0));
  const auto add = [&](const RowPart &part, ExactSums &sums) {
    std::vector<double> &most = found[part.number];
    RowMeasures measure(domain, velocity);
    std::vector<double> dissipated(n);
    for (const Segment &row : part.rows(domain)) {
      for (int c = 0; c < dimension; ++c) sums.add_row(momentum_x + c, velocity[c].row(row.j, row.k), n, first);
      sums.add_row(speed_squared, measure.sum(row, [](double q, double, double) { return q * q; }), n, first);
      const auto squared_mean = [](double q, double next, double) { return square(0.5 * (q + next)); };
      most[max_speed_squared] = largest(measure.sum(row, squared_mean), n, most[max_speed_squared]);
      const auto difference = [](double q, double next, double inverse_h) { return (next - q) * inverse_h; };
      const double *divergence = measure.sum(row, difference);
      most[max_divergence] = largest(divergence, n, most[max_divergence]);
      sums.add_row(divergence_squared, measure.squared(divergence), n, first);
      if (numbers.local_viscosity)
        viscous_dissipation(domain, *numbers.local_viscosity, velocity, row, dissipated.data());
      sums.add_row(gradient_squared, numbers.local_viscosity ? dissipated.data() : measure.squared_gradient(row), n,
                   first);
    }
    if (!part.first || !numbers.sides) return;
    for (const auto [d, high] : domain.sides())
      if (fluid_crosses((*numbers.sides)[d][high].kind))
        add_boundary_faces(domain, velocity, numbers.local_viscosity ? numbers.viscosity / numbers.density : 1, d, high,
                           &sums);
  };
  scope.flops(domain.cell_count() * dimension * (10 + 4 * dimension));
  double sum[flow_sums];
  PetscCall(sum_row_parts(domain, flow_sums, add, sum));
  std::vector<double> maximum;
  PetscCall(reduce_maxima(domain.comm(), found, &maximum));

  *measures = evaluate(domain, numbers, sum, maximum);
  PetscFunctionReturn(0);
}

PetscErrorCode measure_phases(const Domain &domain, const std::vector<Phase> &phases, FlowMeasures *measures,
                              const std::vector<BodyInBox> &bodies) {
  enum { volume, energy, sums_of_phase };
  PetscFunctionBeginUser;
  EventScope scope(Event::sums);
  const auto add_row = [](const Box &box, const Phase &phase, int p, const Segment &row, std::vector<double> &density,
                          ExactSums &sums) {
    const ConstView phi = phase.fraction[0];
    const Segment occupied = phase.rows.within(row, phi);
    const int sum_of_phase = sums_of_phase * p, i = occupied.i_begin, first = box.layout().begin[0] + i;
    strain_energy(box, phase, occupied, density.data());
    sums.add_row(sum_of_phase + volume, phi.row(row.j, row.k) + i, occupied.size(), first);
    sums.add_row(sum_of_phase + energy, density.data() + i, occupied.size(), first);
  };
  const auto add = [&](const RowPart &part, ExactSums &sums) {
    std::vector<double> density(domain.cells()[0]);
    for (const Segment &row : part.rows(domain))
      for (std::size_t p = 0; p < phases.size(); ++p)
        if (!phases[p].boxed) add_row(domain, phases[p], static_cast<int>(p), row, density, sums);
    const Piece own(bodies.size(), part.number, row_parts(domain));
    for (std::size_t b = own.begin; b < own.end; ++b) {
      const Box &box = *bodies[b].box;
      density.resize(std::max<std::size_t>(density.size(), box.cells()[0]));
      for (const Segment &row : box.rows()) add_row(box, *bodies[b].phase, bodies[b].species, row, density, sums);
    }
  };
  double cells = 0;
  for (const Phase &phase : phases) cells += double(phase.rows.cells());
  for (const BodyInBox &body : bodies) cells += double(body.phase->rows.cells());
  scope.flops(cells * (2 * domain.dimension() + 3));
  std::vector<double> sum(sums_of_phase * phases.size());
  PetscCall(sum_row_parts(domain, static_cast<int>(sum.size()), add, sum.data()));
  measures->elastic_energy = 0;
  measures->phase_volume.clear();
  for (std::size_t p = 0; p < phases.size(); ++p) {
    measures->phase_volume.push_back(sum[sums_of_phase * p + volume] * domain.cell_volume());
    measures->elastic_energy += sum[sums_of_phase * p + energy] * domain.cell_volume();
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
