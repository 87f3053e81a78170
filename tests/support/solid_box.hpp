// A box full of solid whose fields are polynomials or random numbers, ghosts included, for tests of the elastic terms.
#pragma once

#include "support/all_segments.hpp"
#include "support/polynomials.hpp"
#include "support/verbs.hpp"

namespace eulastic::test {

// A solid everywhere, phi and B polynomials of the given degree, velocity linear (L = gradients of v).
struct Solid {
  Domain domain;
  Fluid fluid;
  std::vector<Phase> phases;
  Field velocity, pressure, velocity_star, next;
  Polynomial phi, v[3], B[3][3];

  Solid(bool flat, int degree, int seed) {
    EXPECT_EQ(domain.create(PETSC_COMM_SELF, uneven_box(flat)), 0);
    Random random(seed);
    const int dim = domain.dimension();
    velocity = Field(domain, dim);
    velocity_star = Field(domain, dim);
    pressure = Field(domain, 1);
    for (int a = 0; a < dim; ++a) v[a] = Polynomial(random, 1);
    phi = Polynomial(random, degree);
    phi.c = 5;  // well above the threshold
    B[2][2].c = 1;
    const auto &components = tensor_components(dim);
    for (const auto [a, b, at] : components) B[a][b] = B[b][a] = Polynomial(random, degree);
    phases.resize(1);
    Phase &phase = phases[0];
    phase.material.shear_modulus = 0.7;
    phase.fraction = Field(domain, 1);
    phase.tensor.field = Field(domain, static_cast<int>(components.size()));
    next = Field(domain, phase.tensor.field.count());
    phase.tensor.rule = reset_below_one_per_cent;
    build_all(domain, &phase.tensor.evolving);
    build_all(domain, &phase.tensor.stressed);
    fill();
  }

  void fill() {
    const auto &components = tensor_components(domain.dimension());
    for (int a = 0; a < domain.dimension(); ++a) fill_everywhere(domain, velocity[a], at_face[a], v[a]);
    fill_everywhere(domain, phases[0].fraction[0], at_centre, phi);
    for (int c = 0; c < phases[0].tensor.field.count(); ++c)
      fill_everywhere(domain, phases[0].tensor.field[c], components[c].at, B[components[c].a][components[c].b]);
  }

  // Transport keeps the diagonal of B above 0 (solids/solid_transport.hpp); here it is there already.
  void make_positive() {
    for (int a = 0; a < domain.dimension(); ++a) B[a][a].c += 20;
    fill();
  }

  double deviator(int a, int b, const Point &x) const {
    const double trace = B[0][0](x) + B[1][1](x) + B[2][2](x);
    return B[a][b](x) - (a == b ? trace / 3 : 0);
  }
  double deviator_slope(int a, int b, int d, const Point &x) const {
    const double trace = B[0][0].slope(d, x) + B[1][1].slope(d, x) + B[2][2].slope(d, x);
    return B[a][b].slope(d, x) - (a == b ? trace / 3 : 0);
  }
  // L.B + B.L^T - v.grad B
  double rate(int a, int b, const Point &x) const {
    double sum = 0;
    for (int d = 0; d < domain.dimension(); ++d)
      sum += v[a].g[d] * B[d][b](x) + B[a][d](x) * v[b].g[d] - v[d](x) * B[a][b].slope(d, x);
    return sum;
  }
};

/// A solenoidal velocity at all faces of a periodic grid: the curl of a random potential on the edges.
inline void randomise_solenoidal(const Domain &domain, Field &velocity, Random &random) {
  const Real3 &h = domain.spacing();
  Field psi(domain, 3);
  randomise(domain, psi, random);
  for (int a = 0; a < domain.dimension(); ++a) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    const auto next = [&](View q, int i, int j, int k, int d) { return q(i + (d == 0), j + (d == 1), k + (d == 2)); };
    for (int k = 0; k < domain.cells()[2]; ++k)
      for (int j = 0; j < domain.cells()[1]; ++j)
        for (int i = 0; i < domain.cells()[0]; ++i) {
          double curl = 0;
          if (b < domain.dimension()) curl += (next(psi[c], i, j, k, b) - psi[c](i, j, k)) / h[b];
          if (c < domain.dimension()) curl -= (next(psi[b], i, j, k, c) - psi[b](i, j, k)) / h[c];
          velocity[a](i, j, k) = 0.1 * curl;
        }
  }
  GhostExchange exchange(domain);
  EXPECT_EQ(exchange.update_ghosts(velocity, 3), 0);
}

}  // namespace eulastic::test
