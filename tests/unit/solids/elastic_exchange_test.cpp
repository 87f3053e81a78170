// Power of the elastic stress against the rate of the elastic energy, for every law, and the velocity differences that
// stretch B.
#include "diagnostics/energy_rates.hpp"
#include "kernels/tensor.hpp"
#include "kernels/upper_convected.hpp"
#include "support/materials.hpp"
#include "support/solid_box.hpp"

using namespace eulastic;
using namespace eulastic::test;

namespace {

const Material rubber = test::mooney_rivlin(0.7, 0.4, 0.3);

// d(B)/dt by stretching alone.
template <int Dim, class Viscosity>
void stretch(const Domain &domain, const Phase &phase, const Viscosity &viscosity, const Field &v, Field &rate) {
  const Field &B = phase.tensor.field;
  const auto at = [](int a, int b) { return kernels::position<Dim>(a, b); };
  for (const Segment &s : domain.rows())
    for (int a = 0; a < Dim; ++a)
      for (int b = a; b < Dim; ++b) {
        const int other = a == b ? (a + 1) % Dim : b, third = Dim == 3 ? 3 - a - other : other;
        const auto inverse = [&](int d) { return 1 / domain.spacing()[d]; };
        const kernels::Directions d{v[0].stride(a), v[0].stride(other), v[0].stride(third),
                                    inverse(a),     inverse(other),     inverse(third)};
        double *out = rate[at(a, b)].row(s.j, s.k);
        const auto row = [&s](ConstView q) { return q.row(s.j, s.k); };
        const double *aa = row(B[a]), *bb = row(B[b]), *ab = row(B[at(a, other)]), *bc = row(B[at(b, third)]);
        const double *ac = row(B[at(a, third)]), *va = row(v[a]), *vb = row(v[other]), *vc = row(v[third]);
        const double *phi = row(phase.fraction[0]);
        for (int i = s.i_begin; i < s.i_end; ++i) {
          const auto shear = viscosity.template shear<Dim>(va + i, vb + i, vc + i, phi + i);
          out[i] += a == b ? 2 * kernels::half_diagonal_stretch<Dim>(aa + i, ab + i, ac + i, shear, d)
                           : kernels::shear_stretch<Dim>(aa + i, bb + i, ab + i, bc + i, ac + i, shear, d);
        }
      }
}

double total_energy(const Domain &domain, const Phase &phase) {
  double sum = 0;
  std::vector<double> row(domain.cells()[0]);
  for (const Segment &s : domain.rows()) {
    strain_energy(domain, phase, s, row.data());
    for (const double e : row) sum += e;
  }
  return sum * domain.cell_volume();
}

struct Exchange {
  double force = 0, stress = 0, energy = 0;  // power of the force, of the stress, rate of the energy
};

// Fields: random B, random or uniform phi, solenoidal v. The energy is quadratic in B, so that a central difference is
// its exact rate. `contrast`: viscosity of the solid over that of the fluid.
Exchange exchange_of(bool flat, const Material &material, bool uniform, double contrast) {
  Solid solid(flat, 0, 30);
  const Domain &domain = solid.domain;
  Phase &phase = solid.phases[0];
  phase.material = material;
  phase.tensor.rule.viscosity_excess = contrast - 1;
  Random random(31);
  randomise(domain, phase.fraction, random, contrast == 1 ? 1.5 : 0.5);
  if (uniform) fill_everywhere(domain, phase.fraction[0], at_centre, [](const Point &) { return 0.8; });
  randomise(domain, phase.tensor.field, random, 0.4);
  randomise_solenoidal(domain, solid.velocity, random);
  Field force(domain, domain.dimension()), rate(domain, phase.tensor.field.count());
  EXPECT_EQ(compute_elastic_force(domain, 1, solid.phases, force), 0);
  Exchange e;
  for (int a = 0; a < domain.dimension(); ++a)
    for (const Segment &s : domain.rows())
      for (int i = 0; i < s.i_end; ++i)
        e.force += solid.velocity[a](i, s.j, s.k) * force[a](i, s.j, s.k) * domain.cell_volume();
  EnergyRates rates;
  EnergyParameters numbers;
  EXPECT_EQ(measure_energy_rates(domain, solid.velocity, solid.phases, numbers, &rates), 0);
  e.stress = rates.elastic_power;
  with_viscosity(phase.tensor.rule, [&](const auto &viscosity) {
    if (flat)
      stretch<2>(domain, phase, viscosity, solid.velocity, rate);
    else
      stretch<3>(domain, phase, viscosity, solid.velocity, rate);
  });
  GhostExchange exchange(domain);
  EXPECT_EQ(exchange.update_ghosts(rate, 1), 0);
  Field before;
  before.copy_from(phase.tensor.field);
  for (const double sign : {1.0, -1.0}) {
    const std::size_t doubles = before.bytes() / sizeof(double);
    for (std::size_t n = 0; n < doubles; ++n) phase.tensor.field.data()[n] = before.data()[n] + sign * rate.data()[n];
    e.energy += sign / 2 * total_energy(domain, phase);
  }
  return e;
}

// The power of the force equals that of the stress for any phi, and the rate of the energy. For c2 this needs a uniform
// phi, because no symmetric stress has this power where phi varies.
TEST(ElasticExchange, PowerOfForceAndStressAndRateOfEnergy) {
  for (const bool flat : {false, true})
    for (const Material &material : {Material{0.9}, test::mooney_rivlin(0.7, 0, 0.3), rubber})
      for (const bool uniform : {false, true})
        for (const double contrast : {1.0, 0.1, 5.0}) {
          const Exchange e = exchange_of(flat, material, uniform, contrast);
          EXPECT_GT(std::fabs(e.energy), 0.01);
          EXPECT_NEAR(e.force, -e.stress, 1e-13) << flat << uniform << contrast;
          if (uniform || material.c2 == 0) {
            EXPECT_NEAR(e.energy, e.stress, 1e-12) << flat << uniform << contrast;
          }
        }
}

// A rigid rotation turns B without changing it otherwise, for any viscosities.
TEST(ElasticExchange, RotationIsThatOfTheMixture) {
  for (const bool flat : {false, true}) {
    Solid solid(flat, 0, 20);
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) solid.v[a].g[b] = a == b ? 0 : a < b ? solid.v[a].g[b] : -solid.v[b].g[a];
    solid.fill();
    Phase &phase = solid.phases[0];
    Random random(8);
    randomise(solid.domain, phase.fraction, random, 0.5);
    Field rate[2];
    for (const bool own : {false, true}) {
      phase.tensor.rule.viscosity_excess = own ? 4 : 0;
      rate[own] = Field(solid.domain, phase.tensor.field.count());
      with_viscosity(phase.tensor.rule, [&](const auto &viscosity) {
        if (flat)
          stretch<2>(solid.domain, phase, viscosity, solid.velocity, rate[own]);
        else
          stretch<3>(solid.domain, phase, viscosity, solid.velocity, rate[own]);
      });
    }
    for (int c = 0; c < rate[0].count(); ++c)
      for (const Segment &s : solid.domain.rows())
        for (int i = 0; i < s.i_end; ++i) EXPECT_NEAR(rate[0][c](i, s.j, s.k), rate[1][c](i, s.j, s.k), 1e-12);
  }
}

}  // namespace
