// Verbs and the whole classic step in 3-D: pure flow, red blood cells as dense as in options/channel_rbc.opts, and a
// solid everywhere (ten fields advected everywhere).
#include "../support/scene.hpp"
#include "../support/verbs.hpp"
#include "bodies/fill_phase.hpp"
#include "machine.hpp"
#include "pressure/acm.hpp"

using namespace eulastic;

namespace {

enum class Filling { none, cells, all };

struct Box {
  test::Scene scene;
  double dt = 0;

  PetscErrorCode create(int n, Filling filling, PressureKind pressure) {
    PetscFunctionBeginUser;
    constexpr double length = 21.12;
    GridSpec grid;
    grid.cells = {n, n, n};
    grid.length = {length, length, length};
    grid.boundary[1] = Boundary::wall;
    SolverSpec spec;
    spec.pressure = pressure;
    spec.fluid.body_force.force = {2e-4, 0, 0};
    PetscCall(scene.create(PETSC_COMM_SELF, grid, spec));
    State &state = scene.solver.state();
    for (int a = 0; a < 3; ++a)
      test::set(scene.grid, state.velocity[a], at_face[a], [=](double x, double y, double z) {
        return 0.01 * std::sin(6.283185307179586 / length * std::array<double, 3>{x, y, z}[(a + 1) % 3]);
      });
    if (filling == Filling::all) scene.add_phase(0.02, [](double, double, double) { return 1.0; });
    if (filling == Filling::cells) {
      SpeciesSpec species;
      species.name = "rbc";
      species.shape = Shape::biconcave;
      species.radius = 4;
      species.shear_modulus = 0.02;
      species.placement = Placement::lattice;
      species.count = {2, 4, 2};
      std::vector<BodyPlace> places;
      const std::string problem = place_bodies(species, grid, &places);
      PetscCheck(problem.empty(), PETSC_COMM_SELF, PETSC_ERR_USER, "%s", problem.c_str());
      Phase phase;
      PetscCall(fill_phase(scene.grid, species, places, 1, &phase));
      state.phases.push_back(std::move(phase));
      scene.solver.bodies().add_phase(scene.grid, places);
    }
    PetscCall(scene.solver.prepare());
    FlowExtremes extremes;
    PetscCall(scene.solver.measure(&extremes));
    dt = 0.5 * scene.solver.limits(extremes).combined;
    PetscFunctionReturn(0);
  }
};

void step(benchmark::State &state, Filling filling, PressureKind pressure) {
  Box box;
  if (box.create(static_cast<int>(state.range(0)), filling, pressure) != 0) return state.SkipWithError("no scene");
  performance::measure(state, box.scene.grid.cell_count(), 0, 0, [&] { return box.scene.solver.step(box.dt); });
  if (filling != Filling::none)
    state.counters["solid_share"] = box.scene.solver.state().phases[0].solid.points() / box.scene.grid.cell_count();
}

BENCHMARK_CAPTURE(step, ten_fields, Filling::all, PressureKind::acm)->Arg(64)->Arg(128)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(step, red_cells, Filling::cells, PressureKind::acm)->Arg(64)->Arg(128)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(step, pure_flow, Filling::none, PressureKind::acm)->Arg(64)->Arg(128)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(step, pure_flow_smac, Filling::none, PressureKind::smac)->Arg(64)->Unit(benchmark::kMillisecond);

// One verb on the state of a solid everywhere. `values`: doubles per cell that must be read or written.
template <class Work>
void verb(benchmark::State &state, double values, Work work) {
  Box box;
  if (box.create(static_cast<int>(state.range(0)), Filling::all, PressureKind::acm) != 0)
    return state.SkipWithError("no scene");
  const Grid &grid = box.scene.grid;
  State &now = box.scene.solver.state();
  FieldBlock velocity(grid, 3), tensor(grid, 6), scalar(grid, 1), increment(grid, 1);
  AcmSolver acm(grid);
  performance::measure(state, grid.cell_count(), values, 0,
                       [&] { return work(box, grid, now, velocity, tensor, scalar, increment, acm); });
}

#define EULASTIC_VERB(name, values, expression)                                                                      \
  void name(benchmark::State &state) {                                                                               \
    verb(state, values,                                                                                              \
         [](Box &box, const Grid &grid, State &now, FieldBlock &velocity, FieldBlock &tensor, FieldBlock &scalar,    \
            FieldBlock &increment, AcmSolver &acm) -> PetscErrorCode {                                               \
           (void)box, (void)grid, (void)now, (void)velocity, (void)tensor, (void)scalar, (void)increment, (void)acm; \
           return expression;                                                                                        \
         });                                                                                                         \
  }                                                                                                                  \
  BENCHMARK(name)->Arg(64)->Arg(128)->Unit(benchmark::kMillisecond)

EULASTIC_VERB(predict_fluid, 7,
              test::predict(grid, box.scene.solver.spec().fluid, 0, box.dt, now.velocity, now.pressure, {}, velocity));
EULASTIC_VERB(predict_solid, 14,
              test::predict(grid, box.scene.solver.spec().fluid, 0, box.dt, now.velocity, now.pressure, now.phases,
                            velocity));
EULASTIC_VERB(divergence, 4, compute_divergence(grid, 1, now.velocity, scalar));
EULASTIC_VERB(acm_pressure, 5, acm.solve(box.dt, now.phases[0].fraction, now.pressure, increment));
EULASTIC_VERB(correction, 9,
              correct_velocity(grid, 1, box.dt, 0, increment, now.phases[0].fraction, velocity, now.pressure));
EULASTIC_VERB(fraction, 5, advect_fraction(grid, box.dt, now.velocity, now.phases[0].fraction, scalar));
EULASTIC_VERB(segments, 1, find_solid(grid, reset_below_one_per_cent, now.phases[0]));
EULASTIC_VERB(left_cauchy_green, 16, test::transport(grid, box.dt, now.velocity, now.phases[0], tensor));
EULASTIC_VERB(exchange_velocity, 0, box.scene.solver.exchange().update(velocity, 3));
EULASTIC_VERB(exchange_tensor, 0, box.scene.solver.exchange().update(tensor, 3));

}  // namespace
