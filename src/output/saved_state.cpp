#include "output/saved_state.hpp"

#include "base/deliver.hpp"
#include "diagnostics/state_hash.hpp"
#include "grid/domain.hpp"
#include "io/checksum.hpp"
#include "io/fail_together.hpp"
#include "output/checkpoint_range.hpp"

#include <algorithm>
#include <numeric>

namespace eulastic {
namespace {

std::uint64_t hash_name(const std::string &name) { return mix_bits(checksum(name.data(), name.size(), 0)); }

// Every field that is carried on; of 2-D tensors the components that are there.
std::vector<CheckpointField> fields_of(Solver &solver) {
  State &state = solver.state();
  std::vector<CheckpointField> fields;
  for (int d = 0; d < state.velocity.count(); ++d)
    fields.push_back({std::string("velocity_") + "xyz"[d], at_face[d], state.velocity[d]});
  fields.push_back({"pressure", at_centre, state.pressure[0]});
  if (state.pressure_before) fields.push_back({"pressure_before", at_centre, state.pressure_before[0]});
  for (int d = 0; d < state.advection.count(); ++d)
    fields.push_back({std::string("advection_") + "xyz"[d], at_face[d], state.advection[d]});
  for (Phase &phase : state.phases) {
    if (phase.boxed) continue;
    const std::string species = "_" + phase.species;
    fields.push_back({"solid_fraction" + species, at_centre, phase.fraction[0]});
    for (int c = 0; c < phase.tensor.field.count(); ++c) {
      const TensorComponent &component = phase.tensor.components()[c];
      fields.push_back({"left_cauchy_green_" + component.name() + species, component.at, phase.tensor.field[c]});
    }
    if (phase.label) fields.push_back({"body" + species, at_centre, phase.label[0], Stored::int32});
  }
  // May be missing: the pressure solver can be changed at a restart.
  if (Field *memory = solver.pressure_memory())
    for (int f = 0; f < memory->count(); ++f)
      fields.push_back({"pressure_increment_" + std::to_string(f), at_centre, (*memory)[f], Stored::float64, true});
  return fields;
}

CheckpointRecords markers_of(const State &state) {
  CheckpointRecords records{"membrane_markers", SurfaceMarker::numbers, {}};
  for (const SurfaceMarker &marker : state.markers) {
    const auto values = marker.packed();
    records.values.insert(records.values.end(), values.begin(), values.end());
  }
  return records;
}

// Bodies in boxes of their own: their heads (FreeBodies::packed), and what follows them, one body after the other.
constexpr const char *heads_name = "bodies_in_boxes", *values_name = "values_in_boxes";

std::vector<CheckpointRecords> boxes_of(const Solver &solver) {
  CheckpointRecords heads{heads_name, FreeBodies::head, {}}, values{values_name, 1, {}};
  for (std::size_t b = 0; b < solver.boxed_bodies().size(); ++b) {
    const std::vector<double> packed = solver.boxed().packed(b);
    heads.values.insert(heads.values.end(), packed.begin(), packed.begin() + FreeBodies::head);
    values.values.insert(values.values.end(), packed.begin() + FreeBodies::head, packed.end());
  }
  return {heads, values};
}

// Everything else of the solver that its future depends on, but for what belongs to bodies.
CheckpointNumbers numbers_of(Solver &solver) {
  const State &s = solver.state();
  CheckpointNumbers numbers;
  auto &reals = numbers.reals;
  auto &integers = numbers.integers;
  reals["time"] = {s.time};
  reals["time_step"] = {s.dt};
  reals["flow_scales"] = {s.speed_scale, s.crossing_rate, s.travel};
  integers["step"] = {static_cast<long>(s.step)};
  if (OutletLoads *loads = solver.loads()) reals["outlet_loads"] = loads->numbers();
  if (s.pressure_before) reals["pressure_interval"] = {s.pressure_interval};
  if (s.forgotten > 0) integers["forgotten"] = {static_cast<long>(s.forgotten)};
  return numbers;
}

// With those that a run has beside the solver, and the solver's counts.
CheckpointNumbers numbers_of(Solver &solver, const RunPosition &position) {
  const OutputsPosition &o = position.outputs;
  CheckpointNumbers numbers = numbers_of(solver);
  auto &reals = numbers.reals;
  auto &integers = numbers.integers;
  reals["time_step"].push_back(position.dt);
  reals["wall_seconds"] = {position.wall_seconds, position.wall_seconds_total};
  reals["output_times"] = {o.series_time, o.snapshot_time, o.profile_time};
  reals["energy_budget"] = o.energy.numbers();
  reals["energy_made"] = o.energy.made_numbers();
  reals["mach_max"] = {o.mach_max};
  integers["stages_and_sweeps"] = {solver.stages(), solver.sweeps()};
  integers["output_rows"] = {o.series_rows, o.bodies_rows, o.snapshots};
  return numbers;
}

// Of every body: force, torque, power.
std::vector<double> numbers_of(const std::vector<RigidLoad> &loads) {
  std::vector<double> numbers;
  for (const RigidLoad &load : loads) {
    numbers.insert(numbers.end(), load.force.begin(), load.force.end());
    numbers.insert(numbers.end(), load.torque.begin(), load.torque.end());
    numbers.push_back(load.power);
  }
  return numbers;
}

std::vector<RigidLoad> loads_of(const std::vector<double> &numbers) {
  std::vector<RigidLoad> loads(numbers.size() / 7);
  for (std::size_t b = 0; b < loads.size(); ++b) {
    const double *from = &numbers[7 * b];
    std::copy_n(from, 3, loads[b].force.begin());
    std::copy_n(from + 3, 3, loads[b].torque.begin());
    loads[b].power = from[6];
  }
  return loads;
}

template <class T>
std::uint64_t hash_arrays(const std::map<std::string, std::vector<T>> &arrays) {
  std::uint64_t sum = 0;
  for (const auto &[name, values] : arrays)
    sum += mix_bits(hash_name(name) ^ checksum(values.data(), values.size(), 0));
  return sum;
}

// Null, or the array that has not the length it is expected to have.
const char *wrong_length(const CheckpointNumbers &expected, const CheckpointNumbers &found) {
  for (const auto &[name, values] : expected.reals)
    if (found.reals.at(name).size() != values.size()) return name.c_str();
  for (const auto &[name, values] : expected.integers)
    if (found.integers.at(name).size() != values.size()) return name.c_str();
  return nullptr;
}

void take_numbers(CheckpointNumbers &numbers, Solver *solver, RunPosition *position) {
  State &s = solver->state();
  OutputsPosition &o = position->outputs;
  auto &reals = numbers.reals;
  auto &integers = numbers.integers;
  s.time = reals["time"][0];
  s.dt = reals["time_step"][0];
  position->dt = reals["time_step"][1];
  s.speed_scale = reals["flow_scales"][0];
  s.crossing_rate = reals["flow_scales"][1];
  s.travel = reals["flow_scales"][2];
  position->wall_seconds = reals["wall_seconds"][0];
  position->wall_seconds_total = reals["wall_seconds"][1];
  o.series_time = reals["output_times"][0];
  o.snapshot_time = reals["output_times"][1];
  o.profile_time = reals["output_times"][2];
  o.energy.set_numbers(reals["energy_budget"]);
  o.energy.set_made_numbers(reals["energy_made"]);
  o.mach_max = reals["mach_max"][0];
  if (OutletLoads *loads = solver->loads()) loads->set_numbers(reals["outlet_loads"]);
  if (reals.count("pressure_interval") > 0) s.pressure_interval = reals["pressure_interval"][0];
  s.step = integers["step"][0];
  if (const auto loads = reals.find("rigid_loads"); loads != reals.end())
    solver->set_rigid_loads(loads_of(loads->second));
  o.series_rows = integers["output_rows"][0];
  o.bodies_rows = integers["output_rows"][1];
  o.snapshots = integers["output_rows"][2];
}

// Of all bodies, on rank 0: what owners know of them, and what feeders do.
PetscErrorCode gather_numbers(Solver &solver, CheckpointNumbers *numbers) {
  std::vector<Int3> references;
  std::vector<double> first_volumes;
  PetscFunctionBeginUser;
  if (solver.keeps_rigid_loads()) {
    std::vector<RigidLoad> loads;
    PetscCall(solver.rigid_loads(&loads));
    numbers->reals["rigid_loads"] = numbers_of(loads);
  }
  BodyTracker &bodies = solver.bodies();
  PetscCall(bodies.known(solver.domain(), &references, &first_volumes));
  if (bodies.bodies() == 0) PetscFunctionReturn(0);
  std::vector<long> &cells = numbers->integers["bodies.references"];  // "body_" begins the labels of a species
  for (const Int3 &cell : references) cells.insert(cells.end(), cell.begin(), cell.end());
  numbers->reals["bodies.first_volumes"] = std::move(first_volumes);
  const Feeders *feeders = solver.feeders();
  if (!feeders) PetscFunctionReturn(0);
  if (!bodies.like().empty()) numbers->integers["bodies_like"].assign(bodies.like().begin(), bodies.like().end());
  std::vector<long> &inside = numbers->integers["bodies_in_feeders"];
  if (solver.domain().rank() > 0) PetscFunctionReturn(0);
  inside.assign(bodies.bodies(), 0);
  for (const auto &[label, stretch] : feeders->inside()) inside[label - 1] = stretch + 1;
  PetscFunctionReturn(0);
}

PetscErrorCode require_range(const Domain &domain, const std::string &path, const std::string &absurd) {
  PetscFunctionBeginUser;
  PetscCall(fail_together(domain.comm(), absurd.empty() ? absurd : path + ": " + absurd));
  PetscFunctionReturn(0);
}

PetscErrorCode load_bodies(CheckpointFile *file, const std::string &path, const Domain &domain, BodyTracker *bodies,
                           Feeders *feeders) {
  const BodyRange own = BodyRange::of(bodies->bodies(), domain.rank(), domain.ranks());
  const hsize_t all = bodies->bodies(), begin = own.begin;
  std::vector<long> cells(3 * own.size());
  std::vector<double> first_volumes(own.size());
  std::vector<Int3> references(own.size());
  PetscFunctionBeginUser;
  if (all == 0) PetscFunctionReturn(0);
  PetscCall(file->read_share("bodies.references", 3 * all, 3 * begin, &cells));
  PetscCall(file->read_share("bodies.first_volumes", all, begin, &first_volumes));
  PetscCall(require_range(domain, path, find_absurd_body(cells, first_volumes)));
  for (std::size_t n = 0; n < cells.size(); ++n) references[n / 3][n % 3] = static_cast<int>(cells[n]);
  bodies->set_known(std::move(references), std::move(first_volumes));
  if (!feeders) PetscFunctionReturn(0);
  std::vector<long> stretches(own.size());
  std::map<int, int> inside;
  PetscCall(file->read_share("bodies_in_feeders", all, begin, &stretches));
  PetscCall(require_range(domain, path, find_absurd_feeder(stretches, feeders->count())));
  for (int b = 0; b < own.size(); ++b)
    if (stretches[b] > 0) inside[own.begin + b + 1] = static_cast<int>(stretches[b]) - 1;
  PetscCall(feeders->set_inside(inside));
  PetscFunctionReturn(0);
}

// Collective: whether no two of the bodies that ranks have read are the same.
PetscErrorCode require_different(const Domain &domain, const std::string &path, int bodies,
                                 const std::vector<double> &heads) {
  std::vector<int> numbers, owners;
  PetscFunctionBeginUser;
  for (std::size_t n = 0; n < heads.size(); n += FreeBodies::head) {
    numbers.push_back(static_cast<int>(heads[n]));
    owners.push_back(BodyRange::owner(numbers.back() - 1, bodies, domain.ranks()));
  }
  PetscCall(deliver(domain.comm(), owners, &numbers));
  std::sort(numbers.begin(), numbers.end());
  const auto twice = std::adjacent_find(numbers.begin(), numbers.end());
  PetscCall(require_range(domain, path,
                          twice == numbers.end() ? ""
                                                 : std::string(heads_name) + " holds body " + std::to_string(*twice) +
                                                       " twice; accepted: every body once"));
  PetscFunctionReturn(0);
}

// Some bodies in boxes for each rank, the same values whoever gets them.
PetscErrorCode load_boxes(CheckpointFile *file, const std::string &path, Solver *solver) {
  const Domain &domain = solver->domain();
  CheckpointRecords heads{heads_name, FreeBodies::head, {}}, values{values_name, 1, {}};
  PetscFunctionBeginUser;
  if (!solver->has_boxed()) PetscFunctionReturn(0);
  PetscCall(file->read_records(&heads));
  const std::vector<Phase> &phases = solver->state().phases;
  PetscCall(require_range(domain, path, find_absurd_box(heads.values, domain, solver->bodies(), phases)));
  PetscCall(require_different(domain, path, solver->bodies().bodies(), heads.values));
  std::vector<std::size_t> sizes;
  for (std::size_t n = 0; n < heads.values.size(); n += FreeBodies::head)
    sizes.push_back(FreeBodies::packed_values(
        domain.domain_shape(), phases[static_cast<int>(heads.values[n + 1])].tensor.centred, &heads.values[n]));
  values.values.resize(std::accumulate(sizes.begin(), sizes.end(), std::size_t{0}));
  PetscCall(file->read_own_records(&values));
  solver->clear_boxed_bodies();
  std::vector<std::vector<double>> all;
  std::string wrong;
  const double *next = values.values.data();
  for (std::size_t b = 0; b < sizes.size(); ++b) {
    const double *head = &heads.values[b * FreeBodies::head];
    std::vector<double> &packed = all.emplace_back(head, head + FreeBodies::head);
    packed.insert(packed.end(), next, next + sizes[b]);
    next += sizes[b];
    Extent block;  // and cells beside it that the surface may lie in
    for (int d = 0; d < 3; ++d) {
      block.begin[d] = static_cast<int>(head[2 + d]) - SurfaceCells::layers;
      block.end[d] = static_cast<int>(head[2 + d] + head[5 + d]) + SurfaceCells::layers;
    }
    const std::vector<double> markers(next - static_cast<int>(head[8]) * SurfaceMarker::numbers, next);
    if (wrong.empty())
      wrong = find_absurd_marker(markers, block, solver->bodies().bodies(), static_cast<int>(phases.size()));
  }
  PetscCall(require_range(domain, path, wrong));
  for (const std::vector<double> &packed : all) PetscCall(solver->add_packed_body(packed));
  PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode state_hash(Solver *solver, std::uint64_t *hash) {
  const Domain &domain = solver->domain();
  CheckpointNumbers numbers = numbers_of(*solver);
  std::uint64_t sum = 0;
  PetscFunctionBeginUser;
  PetscCall(gather_numbers(*solver, &numbers));
  if (domain.rank() == 0) sum = hash_arrays(numbers.reals) + hash_arrays(numbers.integers);
  for (const CheckpointField &field : fields_of(*solver))
    sum += hash_points(domain, field.view, field.staggering, hash_name(field.name));
  for (const SurfaceMarker &marker : solver->state().markers) {
    const auto values = marker.packed();
    sum += hash_values(values.data(), values.size());
  }
  for (const BodyInBox &body : solver->boxed_bodies()) sum += hash_body(body);
  PetscCallMPI(MPI_Allreduce(&sum, hash, 1, MPI_UINT64_T, MPI_SUM, domain.comm()));
  PetscFunctionReturn(0);
}

PetscErrorCode save_state(Solver *solver, const RunPosition &position, const std::string &options,
                          const std::string &path) {
  PetscFunctionBeginUser;
  CheckpointNumbers numbers = numbers_of(*solver, position);
  PetscCall(gather_numbers(*solver, &numbers));
  std::vector<CheckpointRecords> records = boxes_of(*solver);
  records.push_back(markers_of(solver->state()));
  PetscCall(write_checkpoint(solver->domain(), path, options, numbers, fields_of(*solver), records));
  PetscFunctionReturn(0);
}

PetscErrorCode load_state(CheckpointFile *file, const std::string &path, Solver *solver, RunPosition *position) {
  const Domain &domain = solver->domain();
  std::vector<long> forgotten, like;
  PetscFunctionBeginUser;
  PetscCall(file->read_if_there("forgotten", &forgotten));
  if (solver->feeders()) {
    PetscCall(file->read_if_there("bodies_like", &like));
    solver->bodies().set_like({});
    PetscCall(require_range(domain, path, find_absurd_link(like, solver->bodies().bodies())));
    solver->bodies().set_like(like);
  }
  PetscCall(require_range(domain, path, find_absurd_count("forgotten", forgotten)));
  CheckpointNumbers expected = numbers_of(*solver, *position);
  if (solver->keeps_rigid_loads()) expected.reals["rigid_loads"].resize(7 * solver->rigid()->count);
  CheckpointNumbers numbers = expected;
  PetscCall(file->read_numbers(&numbers));
  const char *wrong = wrong_length(expected, numbers);
  PetscCall(fail_together(domain.comm(), wrong ? path + ": " + wrong + " is of another scene" : std::string()));
  PetscCall(require_range(domain, path, find_absurd_number(numbers)));
  PetscCall(load_bodies(file, path, domain, &solver->bodies(), solver->feeders()));
  solver->clear_pressure_memory();  // the file may know of fewer increments
  for (Phase &phase : solver->state().phases) phase.empty(domain, bool(phase.label));  // of the scene's start
  PetscCall(load_boxes(file, path, solver));
  PetscCall(file->read_fields(domain, fields_of(*solver)));
  take_numbers(numbers, solver, position);
  CheckpointRecords records = markers_of({});
  PetscCall(file->read_records(&records));
  PetscCall(
      require_range(domain, path,
                    find_absurd_marker(records.values, {{0, 0, 0}, domain.domain_cells()}, solver->bodies().bodies(),
                                       static_cast<int>(solver->state().phases.size()))));
  std::vector<SurfaceMarker> markers;
  for (std::size_t n = 0; n < records.values.size(); n += SurfaceMarker::numbers)
    markers.push_back(SurfaceMarker::unpacked(&records.values[n]));
  solver->state().forgotten = forgotten.empty() ? 0 : forgotten[0];
  PetscCall(solver->set_markers(markers));
  PetscCall(solver->resume(numbers.integers["stages_and_sweeps"][0], numbers.integers["stages_and_sweeps"][1]));
  if (!file->has(records.name)) PetscCall(solver->place_markers());
  PetscFunctionReturn(0);
}

}  // namespace eulastic
