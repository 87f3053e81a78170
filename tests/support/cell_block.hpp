// A block of cells between boundaries of several kinds, with a random flow and a phase of another viscosity everywhere.
#pragma once

#include "field/boundaries.hpp"
#include "flow/viscosity.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace eulastic::test {

inline Function wild(double a) {
  return [a](double x, double y, double z) { return std::sin(a + 17 * x + 23 * y * y + 5 * z + a * x * y); };
}

struct CellBlock {
  Domain domain;
  BoundaryConditions sides{};
  Fluid fluid;
  std::vector<Phase> phases{1};
  Field velocity;
  LocalViscosity viscosity;

  CellBlock(MPI_Comm comm, bool flat, const std::array<bool, 3> &bounded, double contrast) {
    GridSpec spec;
    spec.cells = {7, 13, flat ? 1 : 9};
    spec.length = {1, 2, 1.5};
    for (int d = 0; d < (flat ? 2 : 3); ++d) spec.boundary[d] = bounded[d] ? Boundary::wall : Boundary::periodic;
    EXPECT_EQ(domain.create(comm, spec), 0);
    const int dim = domain.dimension();
    sides[0][0].motion.velocity = {0, 0.7, flat ? 0 : -0.3};
    sides[1][0].kind = BoundaryKind::symmetry;
    sides[1][1].motion.velocity = {-0.4, 0, flat ? 0 : 0.5};
    sides[2][1].motion.velocity = {0.2, 0.6, 0};
    fluid.density = 1.3;
    fluid.viscosity = 0.2;
    phases[0].material.viscosity = contrast * fluid.viscosity;
    velocity = Field(domain, dim);
    viscosity = LocalViscosity(domain);
    for (int c = 0; c < dim; ++c) set(domain, velocity[c], at_face[c], wild(c + 1));
    GhostExchange exchange(domain);
    EXPECT_EQ(exchange.update_ghosts(velocity, 2), 0);
    fill_wall_ghosts_velocity(domain, sides, 0, velocity, 2);
    Phase &phase = phases[0];
    phase.fraction = Field(domain, 1);
    phase.tensor.field = undeformed_tensor(domain);
    set(domain, phase.fraction[0], at_centre, [](double x, double y, double z) { return std::fabs(wild(4)(x, y, z)); });
    EXPECT_EQ(phase.rows.find(domain, phase.fraction[0]), 0);
    EXPECT_EQ(exchange.update_ghosts(phase.fraction, 2), 0);
    fill_wall_ghosts_even(domain, at_centre, phase.fraction[0], 2);
    EXPECT_EQ(compute_viscosity(domain, fluid, sides, phases, &viscosity), 0);
  }
};

}  // namespace eulastic::test
