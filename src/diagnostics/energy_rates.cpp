#include "diagnostics/energy_rates.hpp"

#include "base/events.hpp"
#include "diagnostics/edge_stress.hpp"
#include "grid/sum_row_parts.hpp"

#include <algorithm>

namespace eulastic {
namespace {

enum Sum { momentum_x, momentum_y, momentum_z, wall_power, elastic_power, extended_power, extended_energy, sums };

// A row of a phase and the velocities along it.
struct Row {
  const double *phi, *v[3] = {};
  CellTensor B;  // of cell 0 of the row
  int begin, end;
  std::ptrdiff_t stride[3];
  const Material &material;
  const EvolveRule &rule;

  Row(const Phase &phase, const Segment &row)
      : phi(phase.fraction[0].row(row.j, row.k)),
        B(phase.tensor.field, 0, row.j, row.k),
        begin(row.i_begin),
        end(row.i_end),
        material(phase.material),
        rule(phase.tensor.rule) {
    for (int d = 0; d < 3; ++d) stride[d] = phase.fraction[0].stride(d);
  }
};

// out = phi density(i), 0 in cells without solid.
template <class Density>
EULASTIC_INLINE void times_fraction(const double *phi, int begin, int end, double *out, Density density) {
#pragma omp simd
  for (int i = begin; i < end; ++i) {
    const double whole = density(i);
    out[i] = phi[i] == 0 ? 0 : phi[i] * whole;
  }
}

template <int Dim>
EULASTIC_INLINE void energy_row(const Row &row, double *out) {
  const kernels::TensorAt<Dim> t = kernels::tensor_at<Dim>(row.B.component, row.stride, 0, 1);
  with_law(row.material, [&](const auto &law) EULASTIC_BODY {
    times_fraction(row.phi, row.begin, row.end, out, [=](int i) EULASTIC_BODY { return law.energy(t, i); });
  });
}

EULASTIC_CLONES void energy_2d(const Row &row, double *out) { energy_row<2>(row, out); }
EULASTIC_CLONES void energy_3d(const Row &row, double *out) { energy_row<3>(row, out); }

// Computes phi sigma_e : grad v, processing consecutive vectors that contain solid together.
template <int Dim, class Law, class Viscosity>
EULASTIC_INLINE void power_row(const Row &row, const double *inverse, const Law &law, const Viscosity &viscosity,
                               double *out) {
  constexpr int width = 8;
  std::fill(out + row.begin, out + row.end, 0.0);
  int run = row.begin;  // start of the present run of vectors
  for (int begin = row.begin; begin < row.end; begin += width) {
    const int end = std::min(begin + width, row.end);
    bool any = false;
#pragma omp simd reduction(| : any)
    for (int i = begin; i < end; ++i) any |= row.phi[i] != 0;
    if (any && end < row.end) continue;
    times_fraction(row.phi, run, any ? end : begin, out, [&](int i) EULASTIC_BODY {
      return kernels::stress_power<Dim>(row.phi, row.B.component, row.v, i, row.stride, inverse, law, viscosity);
    });
    run = end;
  }
}

template <int Dim>
EULASTIC_INLINE void power_of_law(const Row &row, const double *inverse, double *out) {
  with_law(row.material, [&](const auto &law) EULASTIC_BODY {
    with_viscosity(row.rule,
                   [&](const auto &viscosity) EULASTIC_BODY { power_row<Dim>(row, inverse, law, viscosity, out); });
  });
}

EULASTIC_CLONES void power_2d(const Row &row, const double *inverse, double *out) {
  power_of_law<2>(row, inverse, out);
}
EULASTIC_CLONES void power_3d(const Row &row, const double *inverse, double *out) {
  power_of_law<3>(row, inverse, out);
}

void stress_power(const Box &box, const Phase &phase, const Field &velocity, const Segment &row, double *out) {
  Row at(phase, row);
  for (int d = 0; d < box.dimension(); ++d) at.v[d] = velocity[d].row(row.j, row.k);
  const Real3 &h = box.spacing();
  const double inverse[3] = {1 / h[0], 1 / h[1], 1 / h[2]};
  (box.dimension() == 2 ? power_2d : power_3d)(at, inverse, out);
}

// A moving wall, whose power is speed times traction of every tangential face beside it.
struct MovingWall {
  const Box &box;
  const Field &velocity;
  const std::vector<const Phase *> &phases;
  const EdgeViscosity *viscosity;  // null: the wall acts on solids alone
  int d;                           // its normal
  bool high;

  // Adds the power of its motion with `speed` along c.
  void add_power(int c, double speed, ExactSums *sums) const {
    Int3 begin{}, end = box.cells();
    begin[d] = high ? end[d] - 1 : 0;
    end[d] = begin[d] + 1;
    // A face on another wall does not move, so that the fluid has no shear there. Solids have the stress of the edge,
    // whose control volume is half of that of other edges.
    for (const bool corner_high : {false, true}) {
      if (!box.touches(c, corner_high) || box.is_open(c, corner_high)) continue;
      Int3 first = begin, last = end;
      first[c] = corner_high ? box.cells()[c] : 0;
      last[c] = first[c] + 1;
      for_points({first, last}, [&](int i, int j, int k) {
        sums->add(wall_power, 0.5 * speed * elastic_traction(c, edge_of({i, j, k})));
      });
    }
    // The control volume of a face on an open boundary is half of that of other faces.
    for (const bool end_high : {false, true}) {
      if (!box.touches(c, end_high) || !box.is_open(c, end_high)) continue;
      Int3 first = begin, last = end;
      first[c] = end_high ? box.cells()[c] : 0;
      last[c] = first[c] + 1;
      for_points({first, last}, [&](int i, int j, int k) {
        sums->add(wall_power, 0.5 * speed * traction(c, {i, j, k}));
      });
    }
    if (box.touches_low(c)) begin[c] = 1;
    for_points({begin, end}, [&](int i, int j, int k) { sums->add(wall_power, speed * traction(c, {i, j, k})); });
  }

  Int3 edge_of(Int3 cell) const {
    cell[d] += high ? 1 : 0;
    return cell;
  }

  // Traction of the wall on the material inside, along c, divided by the spacing.
  double traction(int c, const Int3 &cell) const {
    const Int3 edge = edge_of(cell);
    if (!viscosity) return elastic_traction(c, edge);
    const ConstView q = velocity[c];
    const double *inside = &q(cell[0], cell[1], cell[2]), *ghost = inside + (high ? q.stride(d) : -q.stride(d));
    const double h = box.spacing()[d], viscous = viscosity->at(c, d, edge) * (*ghost - *inside) / h;
    return viscous / h + elastic_traction(c, edge);
  }

  double elastic_traction(int c, const Int3 &edge) const {
    double sum = 0;
    for (const Phase *phase : phases) sum += edge_stress(box, *phase, c, d, edge[0], edge[1], edge[2]);
    return (high ? sum : -sum) / box.spacing()[d];
  }
};

void add_elastic(const Box &box, const std::vector<Segment> &rows, const Field &velocity, const Phase &phase,
                 ExactSums *sums) {
  std::vector<double> power(box.cells()[0]), energy(power.size());
  for (const Segment &whole : rows) {
    const Segment row = phase.rows.within(whole, phase.fraction[0]);
    const double *phi = phase.fraction[0].row(row.j, row.k);
    const auto add = [&, first = box.layout().begin[0] + row.i_begin](int s, const std::vector<double> &values) {
      sums->add_row(s, values.data() + row.i_begin, row.size(), first);
    };
    strain_energy(box, phase, row, energy.data());
    stress_power(box, phase, velocity, row, power.data());
    add(elastic_power, power);
    for (int i = row.i_begin; i < row.i_end; ++i)
      if (phi[i] >= phase.tensor.rule.centre) power[i] = energy[i] = 0;
    add(extended_power, power);
    add(extended_energy, energy);
  }
}

// Adds the power of moving walls on the contents of a box, on solids alone if `viscosity` is null.
void add_wall_power(const Box &box, const Field &velocity, const std::vector<const Phase *> &phases,
                    const EdgeViscosity *viscosity, const EnergyParameters &numbers, ExactSums *sums) {
  if (!numbers.sides) return;
  for (const auto [d, high] : box.sides()) {
    if (!box.touches(d, high)) continue;
    const Real3 speed = (*numbers.sides)[d][high].motion.at(numbers.time);
    for (int c = 0; c < box.dimension(); ++c)
      if (c != d && speed[c] != 0) MovingWall{box, velocity, phases, viscosity, d, high}.add_power(c, speed[c], sums);
  }
}

// Corrects the sum of the faces 0 to n - 1 of a direction c that is not periodic: faces 0 and n have half of the volume
// of others.
void add_momentum_at_ends(const Domain &domain, ConstView velocity, int c, ExactSums *sums) {
  for (const bool high : {false, true}) {
    if (!domain.is_wall(c) || !domain.touches(c, high)) continue;
    const std::ptrdiff_t to_face = high ? velocity.stride(c) : 0;
    for_points(domain.boundary_cells(c, high, 1), [&](int i, int j, int k) {
      const double face = (&velocity(i, j, k))[to_face];
      sums->add(momentum_x + c, high ? 0.5 * face : -0.5 * face);
    });
  }
}

}  // namespace

void strain_energy(const Box &box, const Phase &phase, const Segment &row, double *out) {
  (box.dimension() == 2 ? energy_2d : energy_3d)(Row(phase, row), out);
}

PetscErrorCode measure_energy_rates(const Domain &domain, const Field &velocity, const std::vector<Phase> &phases,
                                    const EnergyParameters &numbers, EnergyRates *rates,
                                    const std::vector<BodyInBox> &bodies) {
  PetscFunctionBeginUser;
  EventScope scope(Event::sums);
  std::vector<const Phase *> elastic;
  for (const Phase &phase : phases)
    if (phase.material.elastic() && !phase.boxed) elastic.push_back(&phase);
  const EdgeViscosity viscosity{domain, numbers.viscosity, numbers.density, numbers.local_viscosity};
  const auto add = [&](const RowPart &part, ExactSums &all) {
    const int n = domain.cells()[0], first = domain.layout().begin[0];
    for (int c = 0; c < domain.dimension(); ++c)
      if (numbers.force[c] != 0)
        for (const Segment &row : part.rows(domain))
          all.add_row(momentum_x + c, velocity[c].row(row.j, row.k), n, first);
    for (int c = 0; part.first && c < domain.dimension(); ++c)
      if (numbers.force[c] != 0) add_momentum_at_ends(domain, velocity[c], c, &all);
    for (const Phase *phase : elastic) add_elastic(domain, part.rows(domain), velocity, *phase, &all);
    const Piece own(bodies.size(), part.number, row_parts(domain));
    for (std::size_t b = own.begin; b < own.end; ++b) {
      const BodyInBox &body = bodies[b];
      if (!body.phase->material.elastic()) continue;
      add_elastic(*body.box, body.box->rows(), *body.velocity, *body.phase, &all);
      add_wall_power(*body.box, *body.velocity, {body.phase}, nullptr, numbers, &all);
    }
    if (part.first) add_wall_power(domain, velocity, elastic, &viscosity, numbers, &all);
  };
  double sum[sums];
  PetscCall(sum_row_parts(domain, sums, add, sum));
  const double volume = domain.cell_volume();
  rates->force_power = 0;
  for (int c = 0; c < 3; ++c) rates->force_power += numbers.density * numbers.force[c] * sum[momentum_x + c] * volume;
  rates->wall_power = sum[wall_power] * volume;
  rates->elastic_power = sum[elastic_power] * volume;
  rates->extended_power = sum[extended_power] * volume;
  rates->extended_energy = sum[extended_energy] * volume;
  PetscFunctionReturn(0);
}

}  // namespace eulastic
