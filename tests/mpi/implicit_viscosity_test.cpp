// The implicit viscous step: SDIRK2 of the force of a viscosity that varies, of second order beside moving walls, and
// with less energy after a step of any length, on any number of ranks.
#include "flow/implicit_viscosity.hpp"
#include "base/rank_zero.hpp"
#include "flow/viscous_stress.hpp"
#include "parts/method.hpp"
#include "support/cell_block.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace eulastic::test {
namespace {

const double share = 1 - std::sqrt(0.5);

double sum_over_ranks(const Domain &domain, double value) {
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_SUM, domain.comm());
  return value;
}

// work(component, i, j, k) for all faces but those on boundaries that they are normal to.
template <class Work>
void for_inner_faces(const Domain &domain, const Work &work) {
  for (int c = 0; c < domain.dimension(); ++c)
    for (const Segment &row : domain.rows())
      for (int i = 0; i < row.i_end; ++i) {
        const int place[3] = {i, row.j, row.k};
        if (!(domain.touches_low(c) && place[c] == 0)) work(c, i, row.j, row.k);
      }
}

double square(const Domain &domain, const Field &v) {
  double sum = 0;
  for_inner_faces(domain, [&](int c, int i, int j, int k) { sum += v[c](i, j, k) * v[c](i, j, k); });
  return sum_over_ranks(domain, sum);
}

double difference(const Domain &domain, const Field &v, const Field &w) {
  double sum = 0;
  for_inner_faces(domain, [&](int c, int i, int j, int k) { sum += std::pow(v[c](i, j, k) - w[c](i, j, k), 2); });
  return std::sqrt(sum_over_ranks(domain, sum));
}

struct Flow : CellBlock {
  GhostExchange exchange;

  Flow(bool flat, const std::array<bool, 3> &bounded, double contrast)
      : CellBlock(run_communicator(), flat, bounded, contrast), exchange(domain) {}

  void stop_walls() {
    for (auto &pair : sides)
      for (BoundaryCondition &side : pair) side.motion.velocity = {};
  }
  Field field() const { return Field(domain, domain.dimension()); }
  double least() const { return std::min(fluid.viscosity, phases[0].material.viscosity) / fluid.density; }
  double largest() const { return std::max(fluid.viscosity, phases[0].material.viscosity) / fluid.density; }
  // div tau/rho of a velocity with the boundaries of a time.
  Field force(double time, Field *v) {
    Field result = field();
    EXPECT_EQ(exchange.update_ghosts(*v, 2), 0);
    fill_wall_ghosts_velocity(domain, sides, time, *v, 2);
    EXPECT_EQ(add_viscous_force(domain, viscosity, 1, *v, result), 0);
    return result;
  }
  // v* of an implicit step; `push`: what else accelerates in the middle of the step, `slope` its change in time.
  Field step(ImplicitViscosity *implicit, double time, double dt, Field *v, const Field &push, const Field *slope) {
    Field rate = force(time, v), result = field();
    for_inner_faces(domain, [&](int c, int i, int j, int k) { rate[c](i, j, k) += push[c](i, j, k); });
    const ViscousStep step{sides, time, dt, 3, *v, fluid.viscosity / fluid.density, &viscosity};
    EXPECT_EQ(implicit->step(exchange, step, rate, slope, result), 0);
    return result;
  }
  // The same in many stages of RKL2, as a reference.
  Field stages(double time, double dt, Field *v, const Field &push, const Field &slope) {
    SuperTimeStepping work{force(time, v), field(), field(), field()};
    Field result = field();
    for_inner_faces(domain, [&](int c, int i, int j, int k) {
      work.rate[c](i, j, k) += push[c](i, j, k);
      work.slope[c](i, j, k) = slope[c](i, j, k);
    });
    ViscousStep step{sides, time, dt, 15, *v, fluid.viscosity / fluid.density, &viscosity};
    step.stressed.assign(domain.rows().size(), 1);
    EXPECT_EQ(super_time_step(domain, exchange, step, work, result), 0);
    return result;
  }
};

// (1 - g L) ((1 - g L) W - g M_0) = (1 - share) dt M_0, g = share dt.
TEST(ImplicitViscosity, SolvesBothSystemsOfSdirk2) {
  for (const bool flat : {false, true})
    for (const double contrast : {0.01, 5.0, 100.0})
      for (const std::array<bool, 3> &bounded : {std::array<bool, 3>{true, true, true}, {false, true, false}}) {
        Flow flow(flat, bounded, contrast);
        flow.stop_walls();
        const double dt = 0.3, part = share * dt;
        ImplicitViscosity implicit;
        ASSERT_EQ(implicit.create(flow.domain, flow.sides, flow.least(), flow.largest(), 1e-12), 0);
        Field v = flow.field(), push = flow.field(), rest = flow.field(), last = flow.field();
        for_inner_faces(flow.domain, [&](int c, int i, int j, int k) { push[c](i, j, k) = flow.velocity[c](i, j, k); });
        Field w = flow.step(&implicit, 0, dt, &v, push, nullptr);
        const Field Lw = flow.force(0, &w);
        for_inner_faces(flow.domain, [&](int c, int i, int j, int k) {
          rest[c](i, j, k) = w[c](i, j, k) - part * (Lw[c](i, j, k) + push[c](i, j, k));
        });
        const Field Lrest = flow.force(0, &rest);
        for_inner_faces(flow.domain, [&](int c, int i, int j, int k) {
          last[c](i, j, k) = (rest[c](i, j, k) - part * Lrest[c](i, j, k)) / ((1 - share) * dt);
        });
        EXPECT_LT(difference(flow.domain, last, push), 1e-9 * std::sqrt(square(flow.domain, push)))
            << flat << contrast << bounded[0];
      }
}

// A force that changes in time between walls that swing, against RKL2 with steps 64 times as short.
TEST(ImplicitViscosity, IsOfSecondOrderBesideMovingWalls) {
  Flow flow(false, {true, true, true}, 5);
  for (auto &pair : flow.sides)
    for (BoundaryCondition &side : pair) side.motion.frequency = 2;
  const double end = 0.4;
  Field shape = flow.field();
  for_inner_faces(flow.domain, [&](int c, int i, int j, int k) { shape[c](i, j, k) = flow.velocity[c](i, j, k); });
  const auto force_at = [&](double time) {
    Field push = flow.field();
    for_inner_faces(flow.domain,
                    [&](int c, int i, int j, int k) { push[c](i, j, k) = (1 - 2 * time) * shape[c](i, j, k); });
    return push;
  };
  Field slope = flow.field();
  for_inner_faces(flow.domain, [&](int c, int i, int j, int k) { slope[c](i, j, k) = -2 * shape[c](i, j, k); });
  Field reference = flow.field();
  for (int n = 0; n < 1024; ++n)
    reference = flow.stages(n * end / 1024, end / 1024, &reference, force_at((n + 0.5) * end / 1024), slope);
  double errors[2];
  for (int halved = 0; halved < 2; ++halved) {
    const int steps = halved ? 16 : 8;
    const double dt = end / steps;
    ImplicitViscosity implicit;
    ASSERT_EQ(implicit.create(flow.domain, flow.sides, flow.least(), flow.largest(), 1e-10), 0);
    Field v = flow.field();
    for (int n = 0; n < steps; ++n) v = flow.step(&implicit, n * dt, dt, &v, force_at((n + 0.5) * dt), &slope);
    errors[halved] = difference(flow.domain, v, reference);
  }
  const double order = std::log2(errors[0] / errors[1]);
  EXPECT_GT(order, 1.7) << errors[0] << " " << errors[1];
  EXPECT_LT(errors[1], 1e-3 * std::sqrt(square(flow.domain, reference)));
}

// With the tolerance of the program, which leaves a part of the residual.
TEST(ImplicitViscosity, EnergyDecreasesInStepsOfAnyLength) {
  for (const bool flat : {false, true})
    for (const double contrast : {0.001, 0.2, 5.0, 100.0, 1e4})
      for (const double dt : {1e-3, 0.1, 10.0, 100.0, 1e3}) {
        Flow flow(flat, {false, true, true}, contrast);
        flow.stop_walls();
        ImplicitViscosity implicit;
        ASSERT_EQ(implicit.create(flow.domain, flow.sides, flow.least(), flow.largest(), Method().viscous_tolerance),
                  0);
        Field v = flow.field();
        for_inner_faces(flow.domain, [&](int c, int i, int j, int k) { v[c](i, j, k) = flow.velocity[c](i, j, k); });
        for (int n = 0; n < 4; ++n) {
          const double before = square(flow.domain, v);
          v = flow.step(&implicit, n * dt, dt, &v, flow.field(), nullptr);
          EXPECT_LT(square(flow.domain, v), before) << flat << " " << contrast << " " << dt << " " << n;
        }
      }
}

}  // namespace
}  // namespace eulastic::test
