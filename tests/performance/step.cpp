// The whole step in 3-D: pure flow, red blood cells as dense as in the paper, and a solid everywhere (ten fields
// advected everywhere).
#include "box.hpp"

using namespace eulastic;
using performance::Filling;

namespace {

Method classic(PressureKind pressure = PressureKind::acm) {
  Method method = method_preset(MethodKind::classic);
  method.pressure = pressure;
  return method;
}

void step(benchmark::State &state, Filling filling, const Method &method) {
  performance::FilledBox *box = performance::box(performance::cells_of(state), filling, method);
  if (!box) return state.SkipWithError("no scene");
  const double count = box->scene.domain.domain_cell_count();
  performance::measure(state, {count}, [&] { return box->scene.solver.step(box->dt); });
  if (filling != Filling::none)
    state.counters["solid_share"] =
        performance::sum_over_ranks(box->scene.solver.state().phases[0].tensor.evolving.points()) / count;
}

#define EULASTIC_STEP(name, filling, method)                                   \
  BENCHMARK_CAPTURE(step, name, filling, method)->Apply(performance::cube_64); \
  BENCHMARK_CAPTURE(step, name, filling, method)->Apply(performance::cube_128)

#define EULASTIC_LONG_STEP(name, filling, method) \
  EULASTIC_STEP(name, filling, method);           \
  BENCHMARK_CAPTURE(step, name, filling, method)->Apply(performance::long_box)

EULASTIC_LONG_STEP(red_cells, Filling::cells, classic());
EULASTIC_LONG_STEP(pure_flow, Filling::none, classic());
EULASTIC_STEP(ten_fields, Filling::all, classic());
EULASTIC_STEP(pure_flow_smac, Filling::none, classic(PressureKind::smac));
EULASTIC_STEP(fast_red_cells, Filling::cells, method_preset(MethodKind::fast));
EULASTIC_STEP(fast_pure_flow, Filling::none, method_preset(MethodKind::fast));

}  // namespace
