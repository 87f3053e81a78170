// Flow measures against integrals known in closed form, and the same bits on any ranks as on one.
#include "diagnostics/flow_measures.hpp"
#include "base/rank_zero.hpp"
#include "field/boundaries.hpp"
#include "field/ghost_exchange.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>

namespace eulastic {
namespace {

using Function = std::function<double(double x, double y, double z)>;

struct Flow {
  Flow(MPI_Comm comm, const Int3 &cells, const Real3 &length, const std::array<bool, 3> &has_walls) {
    GridSpec spec;
    spec.cells = cells;
    spec.length = length;
    for (int d = 0; d < 3; ++d) spec.boundary[d] = has_walls[d] ? Boundary::wall : Boundary::periodic;
    domain.create(comm, spec);
    velocity = Field(domain, domain.dimension());
  }

  void set(View q, const Staggering &s, const Function &field) const {
    const Real3 &h = domain.spacing();
    const auto at = [&](int d, int index) { return (domain.layout().begin[d] + index + (s[d] ? 0.0 : 0.5)) * h[d]; };
    for (const Segment &row : domain.rows())
      for (int i = 0; i < row.i_end; ++i) q(i, row.j, row.k) = field(at(0, i), at(1, row.j), at(2, row.k));
  }

  void add_phase(double shear_modulus, const Function &fraction, const std::array<double, 3> &diagonal) {
    const int components = static_cast<int>(tensor_components(domain.dimension()).size());
    Phase phase;
    phase.material.shear_modulus = shear_modulus;
    phase.fraction = Field(domain, 1);
    phase.tensor.field = Field(domain, components);
    set(phase.fraction[0], at_centre, fraction);
    for (int c = 0; c < domain.dimension(); ++c) phase.tensor.field.fill(c, diagonal[c]);
    for (int c = domain.dimension(); c < components; ++c) phase.tensor.field.fill(c, 7.0);  // off-diagonal: no energy
    phases.push_back(std::move(phase));
  }

  FlowMeasures measure(const std::array<Function, 3> &field, const FlowParameters &numbers) {
    for (int c = 0; c < domain.dimension(); ++c) set(velocity[c], at_face[c], field[c]);
    GhostExchange exchange(domain);
    exchange.update_ghosts(velocity, 1);
    fill_wall_ghosts_velocity(domain, walls, 0, velocity, 1);
    FlowMeasures measures;
    EXPECT_EQ(measure_flow(domain, velocity, numbers, &measures), 0);
    EXPECT_EQ(measure_phases(domain, phases, &measures), 0);
    return measures;
  }

  Domain domain;
  BoundaryConditions walls{};
  Field velocity;
  std::vector<Phase> phases;
};

const Function zero = [](double, double, double) { return 0.0; };

// Sampled sines: means of squares are exact, and a central difference sees k as 2 sin(k h / 2) / h.
TEST(FlowMeasures, TaylorGreen) {
  const double pi = M_PI, rho = 1.5, mu = 0.3;
  for (const int nz : {1, 9}) {
    SCOPED_TRACE(nz);
    Flow flow(run_communicator(), {20, 12, nz}, {2 * pi, 2 * pi, 1}, {});
    const std::array<Function, 3> v{[](double x, double y, double) { return std::sin(x) * std::cos(y); },
                                    [](double x, double y, double) { return -std::cos(x) * std::sin(y); }, zero};
    const FlowMeasures m = flow.measure(v, {rho, mu, 0, 0});
    EXPECT_NEAR(m.kinetic_energy, 0.5 * rho * 0.5 * 4 * pi * pi, 1e-12 * 30);
    const double kx = 2 * std::sin(pi / 20) / (2 * pi / 20), ky = 2 * std::sin(pi / 12) / (2 * pi / 12);
    EXPECT_NEAR(m.viscous_dissipation, mu * 2 * (kx * kx + ky * ky) * 0.25 * 4 * pi * pi, 1e-11);
    // div v = (kx - ky) cos x cos y.
    const double h = 2 * pi / 20, U = m.speed_max;
    EXPECT_NEAR(m.divergence_rms, (kx - ky) * 0.5 * std::min(h, nz == 1 ? 1.0 : 1.0 / 9) / U, 1e-13);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(m.bulk_velocity[c], 0, 1e-15);
  }
}

TEST(FlowMeasures, UniformFlow) {
  Flow flow(run_communicator(), {5, 13, 7}, {1, 2, 3}, {});
  const std::array<Function, 3> v{[](double, double, double) { return -3.0; },
                                  [](double, double, double) { return 4.0; },
                                  [](double, double, double) { return -12.0; }};
  const FlowMeasures m = flow.measure(v, {2.0, 1.0, 0, 0});
  EXPECT_NEAR(m.kinetic_energy, 169 * 6, 1e-11);
  EXPECT_EQ(m.bulk_velocity, (Real3{-3, 4, -12}));
  EXPECT_EQ(m.speed_max, 13);
  EXPECT_EQ(m.divergence_rms, 0);
  EXPECT_EQ(m.divergence_max, 0);
  EXPECT_EQ(m.viscous_dissipation, 0);
}

// Couette flow between walls: mu (U/H)^2 per volume, the half control volumes at both walls included.
TEST(FlowMeasures, LinearShear) {
  for (int d = 0; d < 3; ++d)
    for (int c = 0; c < 3; ++c) {
      if (c == d) continue;
      SCOPED_TRACE(::testing::Message() << "component " << c << " between walls in " << d);
      std::array<bool, 3> walls{};
      walls[d] = true;
      const Real3 length{1, 2, 3};
      Flow flow(run_communicator(), {5, 13, 7}, length, walls);
      const double speed = 0.7, mu = 0.3;
      flow.walls[d][1].motion.velocity[c] = speed;
      std::array<Function, 3> v{zero, zero, zero};
      v[c] = [&](double x, double y, double z) { return speed * Real3{x, y, z}[d] / length[d]; };
      const FlowMeasures m = flow.measure(v, {1, mu, 0, 0});
      EXPECT_NEAR(m.viscous_dissipation, mu * speed * speed / (length[d] * length[d]) * 6, 1e-13);
      EXPECT_NEAR(m.bulk_velocity[c], speed / 2, 1e-15);
    }
}

// A flow that meets walls loses sum of v . mu lap v: the compact dissipation must be just that.
TEST(FlowMeasures, DissipationIsThePowerOfTheDiscreteViscousForce) {
  for (const std::array<bool, 3> &walls :
       {std::array<bool, 3>{true, true, true}, {true, false, true}, {false, true, false}}) {
    Flow flow(run_communicator(), {5, 13, 7}, {1, 2, 3}, walls);
    const auto wild = [](double a) {
      return [a](double x, double y, double z) { return std::sin(a + 17 * x + 23 * y * y + 5 * z); };
    };
    const FlowMeasures m = flow.measure({wild(1), wild(2), wild(3)}, {1, 1, 0, 0});
    const Domain &domain = flow.domain;
    double power = 0;
    for (int c = 0; c < 3; ++c) {
      const ConstView q = flow.velocity[c];
      for (const Segment &row : domain.rows())
        for (int i = 0; i < row.i_end; ++i)
          for (int d = 0; d < 3; ++d) {
            const double *p = &q(i, row.j, row.k), h = domain.spacing()[d];
            // On its own walls v is 0 and the row below is free.
            if (*p != 0) power -= *p * (p[q.stride(d)] - 2 * *p + p[-q.stride(d)]) / (h * h) * domain.cell_volume();
          }
    }
    MPI_Allreduce(MPI_IN_PLACE, &power, 1, MPI_DOUBLE, MPI_SUM, run_communicator());
    EXPECT_NEAR(m.viscous_dissipation, power, 1e-12 * power);
  }
}

TEST(FlowMeasures, DivergenceIsInUnitsOfSpeedAndSpacing) {
  Flow flow(run_communicator(), {8, 9, 7}, {1, 9, 7}, {});
  // u alternates by +-1 from face to face: |div v| = 2/h_x everywhere; half as fast, the ratio is the same.
  for (const double amplitude : {1.0, 0.5}) {
    const Function u = [=](double x, double, double) { return amplitude * (std::lround(x * 8) % 2 ? 1 : -1); };
    const Function v = [=](double, double, double) { return amplitude; };
    const FlowMeasures m = flow.measure({u, v, zero}, {1, 1, 0, 0});
    EXPECT_NEAR(m.speed_max, amplitude, 1e-15);
    EXPECT_NEAR(m.divergence_rms, 2, 1e-14);
    EXPECT_NEAR(m.divergence_max, 2, 1e-14);
    const FlowMeasures forced = flow.measure({u, v, zero}, {1, 1, 0.5, 20});  // |f| dt = 10
    EXPECT_NEAR(forced.divergence_rms, 0.2 * amplitude, 1e-14);
    EXPECT_NEAR(forced.divergence_max, 0.2 * amplitude, 1e-14);
  }
  const FlowMeasures rest = flow.measure({zero, zero, zero}, {1, 1, 0.5, 0});
  EXPECT_EQ(rest.divergence_rms, 0);
  EXPECT_EQ(rest.divergence_max, 0);
}

TEST(FlowMeasures, ElasticEnergyAndVolumes) {
  for (const int nz : {1, 7}) {
    Flow flow(run_communicator(), {5, 13, nz}, {1, 2, 3}, {false, true, false});
    const double box = nz == 1 ? 2 : 6;
    flow.add_phase(0.5, [](double, double, double) { return 0.25; }, {4, 0.5, 0.75});
    flow.add_phase(2.0, [](double, double y, double) { return y / 2; }, {1, 3, 1});
    const FlowMeasures m = flow.measure({zero, zero, zero}, {});
    ASSERT_EQ(m.phase_volume.size(), 2u);
    EXPECT_NEAR(m.phase_volume[0], 0.25 * box, 1e-13);
    EXPECT_NEAR(m.phase_volume[1], 0.5 * box, 1e-13);
    const double trace = nz == 1 ? 4.5 + 1 : 5.25;  // B_zz = 1 in 2-D
    EXPECT_NEAR(m.elastic_energy, 0.25 * 0.25 * box * (trace - 3) + 1.0 * 0.5 * box * 2, 1e-13);
  }
}

TEST(FlowMeasures, NotANumberIsSeen) {
  Flow flow(run_communicator(), {5, 13, 7}, {1, 2, 3}, {});
  const Function ill = [](double x, double y, double z) { return x + y + z < 0.5 ? std::nan("") : 1.0; };
  const FlowMeasures m = flow.measure({zero, ill, zero}, {});
  for (const double value :
       {m.kinetic_energy, m.bulk_velocity[1], m.speed_max, m.divergence_rms, m.divergence_max, m.viscous_dissipation})
    EXPECT_TRUE(std::isnan(value));
  EXPECT_EQ(m.bulk_velocity[0], 0);
}

TEST(FlowMeasures, SameBitsAsOnOneRank) {
  // The widest is split in x as well on four ranks: 3 x 3 cells leave no other way.
  for (const Int3 &cells : {Int3{13, 21, 1}, Int3{7, 13, 15}, Int3{1024, 5, 5}}) {
    SCOPED_TRACE(cells[0]);
    std::vector<double> results[2];
    for (int alone = 0; alone < 2; ++alone) {
      Flow flow(alone ? PETSC_COMM_SELF : run_communicator(), cells, {1, 2, 3}, {false, true, false});
      const auto wild = [](double a) {
        return [a](double x, double y, double z) {
          const double s = std::sin(a + 171 * x + 235 * y * y + 53 * z);
          return s * s * s * std::exp(9 * s);
        };
      };
      flow.add_phase(0.3, [=](double x, double y, double z) { return std::abs(std::sin(x + 99 * y + 7 * z)); },
                     {1.1, 0.9, 1.2});
      flow.set(flow.phases[0].tensor.field[0], at_centre, wild(4));
      const FlowMeasures m = flow.measure({wild(1), wild(2), wild(3)}, {1.3, 0.7, 0.1, 1});
      std::vector<double> &r = results[alone];
      r = {m.kinetic_energy,      m.speed_max,      m.divergence_rms, m.divergence_max,
           m.viscous_dissipation, m.elastic_energy, m.phase_volume[0]};
      r.insert(r.end(), m.bulk_velocity.begin(), m.bulk_velocity.end());
    }
    EXPECT_EQ(std::memcmp(results[0].data(), results[1].data(), results[0].size() * sizeof(double)), 0);
    EXPECT_GT(results[0][0], 0);
  }
}

}  // namespace
}  // namespace eulastic
