// Verbs on a solid everywhere: the bytes that each must move (every value from and to memory once a pass, a written
// one read before: write-allocate) and the flops it logs say how long it should take.
#include "../support/verbs.hpp"
#include "box.hpp"
#include "flow/correction.hpp"
#include "flow/projection.hpp"
#include "flow/super_time_stepping.hpp"
#include "pressure/acm.hpp"
#include "pressure/acm_iterations.hpp"

using namespace eulastic;
using performance::Filling;

namespace {

struct Scratch {
  performance::FilledBox &box;
  const Domain &domain;
  State &now;
  GhostExchange &exchange;
  Field velocity, tensor, scalar, increment;

  explicit Scratch(performance::FilledBox &b)
      : box(b),
        domain(b.scene.domain),
        now(b.scene.solver.state()),
        exchange(b.scene.solver.exchange()),
        velocity(domain, 3),
        tensor(domain, 6),
        scalar(domain, 1),
        increment(domain, 1) {}
  const Fluid &fluid() const { return box.scene.solver.spec().fluid; }
};

PetscErrorCode predict(Scratch &s, const std::vector<Phase> &phases) {
  return predict_velocity(s.domain, s.fluid(), {0, s.box.dt, 1, {}}, s.now.velocity, s.now.pressure, phases,
                          s.velocity);
}

// `work(scratch, bytes per cell and round)` gives the verb and how many rounds (stages, sweeps) a call has.
template <class Make>
void verb(benchmark::State &state, Filling filling, Make make) {
  const int n = int(state.range(0));
  performance::FilledBox *box = performance::box({n, n, n}, filling, method_preset(MethodKind::classic));
  if (!box) return state.SkipWithError("no scene");
  Scratch scratch(*box);
  make(scratch, [&](double bytes, int rounds, auto task) {
    performance::measure(state, {rounds * scratch.domain.domain_cell_count(), bytes}, task);
  });
}

#define EULASTIC_NAMED(name)                                                              \
  BENCHMARK(name)->Arg(64)->Iterations(16)->UseRealTime()->Unit(benchmark::kMillisecond); \
  BENCHMARK(name)->Arg(128)->Iterations(2)->UseRealTime()->Unit(benchmark::kMillisecond)

#define EULASTIC_VERB_IN(name, filling, bytes, expression)                                                 \
  void name(benchmark::State &state) {                                                                     \
    verb(state, filling, [](Scratch &s, auto measure) { measure(bytes, 1, [&] { return expression; }); }); \
  }                                                                                                        \
  EULASTIC_NAMED(name)
#define EULASTIC_VERB(name, bytes, expression) EULASTIC_VERB_IN(name, Filling::all, bytes, expression)

// v, p -> v*
EULASTIC_VERB(predict_fluid, 4 * 8 + 3 * 16, predict(s, {}));
// v, p, phi, B -> v*
EULASTIC_VERB(predict_solid, 11 * 8 + 3 * 16, predict(s, s.now.phases));
// v -> D
EULASTIC_VERB(divergence, 3 * 8 + 16, compute_divergence(s.domain, 1, s.now.velocity, s.scalar));
// D, p for the sums
EULASTIC_VERB(acm, 2 * 8, AcmSolver(s.domain).solve(s.box.dt, s.now.phases[0].fraction, s.now.pressure, s.increment));
// D -> v, p in place
EULASTIC_VERB(correction, 8 + 4 * 16,
              correct_velocity(s.domain, 1, s.box.dt, 0, kernels::AcmIncrement{0.1, 0.1, 1, 0}, s.scalar, s.velocity,
                               s.now.pressure));
// v, phi -> phi
EULASTIC_VERB(fraction, 4 * 8 + 16, advect_fraction(s.domain, s.box.dt, s.now.velocity, s.now.phases[0], {}, s.scalar));
// phi
EULASTIC_VERB(segments, 8, find_solid(s.domain, s.now.phases[0]));
// v, phi, B -> B
EULASTIC_VERB(left_cauchy_green, 10 * 8 + 6 * 16,
              test::transport(s.domain, s.box.dt, s.now.velocity, s.now.phases[0], s.tensor));

// The same among red blood cells; bytes are not counted.
EULASTIC_VERB_IN(cells_predict, Filling::cells, 0, predict(s, s.now.phases));
EULASTIC_VERB_IN(cells_fraction, Filling::cells, 0,
                 advect_fraction(s.domain, s.box.dt, s.now.velocity, s.now.phases[0], {}, s.scalar));
// As in a step: B is set to I only where it was not.
PetscErrorCode transport_in_cells(Scratch &s) {
  const Phase &phase = s.now.phases[0];
  return transport_tensor(s.domain, {s.box.dt, false, &phase.tensor.strained}, s.now.velocity, phase,
                          phase.tensor.field, s.tensor);
}
EULASTIC_VERB_IN(cells_left_cauchy_green, Filling::cells, 0, transport_in_cells(s));

// A ghost is read and written; three layers, none behind walls (y).
double exchanged(const Domain &domain, int fields) {
  const Int3 n = domain.cells();
  return 24. * fields * ((n[0] + 6.) * (n[2] + 6.) / (double(n[0]) * n[2]) - 1);
}
EULASTIC_VERB(exchange_velocity, exchanged(s.domain, 3), s.exchange.update_ghosts(s.velocity, 3));
EULASTIC_VERB(exchange_tensor, exchanged(s.domain, 6), s.exchange.update_ghosts(s.tensor, 3));

// A stage of a velocity component by itself: W_j-1, W_j-2 in place, the rate. (Several share a pass, so that less goes
// through memory.) Before: rate -> W_1 and W_0 = 0; after: v, W -> v*.
void rkl_stage(benchmark::State &state) {
  verb(state, Filling::all, [](Scratch &s, auto measure) {
    constexpr int stages = 41;
    constexpr double stage = 8 + 16 + 8, ends = (8 + 16) + 16 + (8 + 8 + 16);
    SuperTimeStepping work{Field(s.domain, 3), {}, Field(s.domain, 3), Field(s.domain, 3)};
    measure(3 * (stage + ends / (stages - 1)), stages - 1, [&] {
      const ViscousStep step{s.box.scene.solver.spec().sides, 0, 100 * s.box.dt, stages, s.now.velocity, 1};
      return super_time_step(s.domain, s.exchange, step, work, s.velocity);
    });
  });
}
EULASTIC_NAMED(rkl_stage);

// A sweep: sums of D, the D before and a direction; they and d, in place: new D, new d and every second time the
// increment. Without V-cycle D is the direction. The first sweep has no D before to sum, the last leaves D and d alone;
// before them D is copied.
constexpr int sweeps = 6;
constexpr double sweeps_bytes(bool multigrid) {
  const double direction = multigrid ? 8 : 0, sums = 2 * 8 + direction, step = 8 + direction + 2 * 16 + 16 / 2;
  return ((8 + 16) + sweeps * (sums + step) - 8 - (direction + 16 + 8)) / sweeps;
}
// D -> half the cells; them, D -> q; two relaxations, by themselves (they share a pass, so that less goes through
// memory). Below an eighth of the cells each: one relaxation more, the right-hand side is written, the solution read.
constexpr double cycle_finest = 8 + (8 + 16) + 2 * (8 + 8 + 16);
constexpr double cycle_bytes = cycle_finest + (cycle_finest + (8 + 8 + 16) + 16 + 8) / 7;

void sweep(benchmark::State &state, bool multigrid) {
  verb(state, Filling::all, [&](Scratch &s, auto measure) {
    AcmIterativeSolver solver;
    WorkSpace work(s.domain);
    if (solver.create(s.domain, s.exchange, {sweeps, 0, multigrid}, work) != 0) return state.SkipWithError("no solver");
    test::set(s.domain, s.scalar[0], at_centre,
              [](double x, double y, double z) { return std::sin(x) * std::cos(2 * y) + std::sin(3 * z); });
    solver.set_target(0);
    measure(sweeps_bytes(multigrid) + (multigrid ? cycle_bytes : 0), sweeps,
            [&] { return solver.solve(s.box.dt, s.scalar, s.now.pressure, s.increment); });
  });
}
void acm_sweep(benchmark::State &state) { sweep(state, false); }
void acm_sweep_and_cycle(benchmark::State &state) { sweep(state, true); }
EULASTIC_NAMED(acm_sweep);
EULASTIC_NAMED(acm_sweep_and_cycle);

}  // namespace
