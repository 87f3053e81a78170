#include "output/saved_state.hpp"

#include "adhesion/adhesion.hpp"
#include "base/send_to_ranks.hpp"
#include "boxes/boxed_bodies.hpp"
#include "diagnostics/state_hash.hpp"
#include "grid/domain.hpp"
#include "io/checksum.hpp"
#include "io/fail_together.hpp"
#include "io/option_values.hpp"
#include "membranes/membrane_transport.hpp"
#include "openings/inlet_generators.hpp"
#include "output/checkpoint_range.hpp"
#include "parts/state.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace eulastic {
namespace {

std::uint64_t hash_name(const std::string &name) { return mix_bits(checksum(name.data(), name.size(), 0)); }

// Bodies in boxes of their own: their heads (FreeBodies::packed), and what follows them, one body after the other.
// With adhesion how many receptors each has.
constexpr const char *heads_name = "bodies_in_boxes", *values_name = "values_in_boxes",
                     *receptors_name = "receptors_in_boxes";

std::vector<CheckpointRecords> boxes_of(const Solver &solver) {
  CheckpointRecords heads{heads_name, FreeBodies::head, {}}, values{values_name, 1, {}},
      receptors{receptors_name, 1, {}};
  const FreeBodies &boxed = solver.boxed().bodies();
  for (std::size_t b = 0; b < boxed.bodies().size(); ++b) {
    const std::vector<double> packed = boxed.packed(b);
    heads.values.insert(heads.values.end(), packed.begin(), packed.begin() + FreeBodies::head);
    values.values.insert(values.values.end(), packed.begin() + FreeBodies::head, packed.end());
    receptors.values.push_back(double(boxed.bodies()[b].receptors.size()));
  }
  if (!solver.part<Adhesion>()) return {heads, values};
  return {heads, values, receptors};
}

// The values of what is carried.
CheckpointNumbers numbers_of(const CarriedState &state) {
  CheckpointNumbers numbers;
  for (const auto &[name, places] : state.reals)
    for (const double *place : places) numbers.reals[name].push_back(*place);
  for (const auto &[name, places] : state.integers)
    for (const std::int64_t *place : places) numbers.integers[name].push_back(static_cast<long>(*place));
  return numbers;
}

void take_numbers(const CheckpointNumbers &numbers, const CarriedState &state) {
  for (const auto &[name, places] : state.reals)
    for (std::size_t n = 0; n < places.size(); ++n) *places[n] = numbers.reals.at(name)[n];
  for (const auto &[name, places] : state.integers)
    for (std::size_t n = 0; n < places.size(); ++n) *places[n] = numbers.integers.at(name)[n];
}

constexpr const char *largest_name = "energy_largest";

// What a run carries beside the solver.
void add_position(bool has_bonds, RunPosition *position, CarriedState *state) {
  OutputsPosition &o = position->outputs;
  state->reals["time_step"].push_back(&position->dt);
  state->reals["wall_seconds"] = {&position->wall_seconds, &position->wall_seconds_total};
  state->reals["output_times"] = {&o.series_time, &o.snapshot_time, &o.profile_time};
  state->reals["mach_max"] = {&o.mach_max};
  state->reals["energy_budget"] = o.energy.numbers();
  state->reals["energy_made"] = o.energy.generated_numbers();
  state->reals[largest_name] = {o.energy.largest_held()};
  state->integers["stages_and_sweeps"] = {&position->stages, &position->sweeps};
  state->integers["output_rows"] = {&o.series_rows, &o.bodies_rows, &o.snapshots};
  if (has_bonds) state->integers["bond_rows"] = {&o.bonds.bonds, &o.bonds.events};
}

template <class T>
std::uint64_t hash_arrays(const std::map<std::string, std::vector<T>> &arrays) {
  std::uint64_t sum = 0;
  for (const auto &[name, values] : arrays)
    sum += mix_bits(hash_name(name) ^ checksum(values.data(), values.size(), 0));
  return sum;
}

// The array that has not the length it is expected to have, or nothing.
std::string wrong_length(const CheckpointNumbers &expected, const CheckpointNumbers &found) {
  for (const auto &[name, values] : expected.reals)
    if (found.reals.at(name).size() != values.size()) return name;
  for (const auto &[name, values] : expected.integers)
    if (found.integers.at(name).size() != values.size()) return name;
  return {};
}

// Numbers of all bodies on rank 0, from their owners and from inlet generators.
PetscErrorCode gather_numbers(Solver &solver, CheckpointNumbers *numbers) {
  std::vector<Int3> references;
  std::vector<double> first_volumes;
  PetscFunctionBeginUser;
  BodyTracker &bodies = solver.bodies();
  PetscCall(bodies.known(solver.domain(), &references, &first_volumes));
  if (bodies.bodies() == 0) PetscFunctionReturn(0);
  std::vector<long> &cells = numbers->integers["bodies.references"];  // "body_" begins the labels of a species
  for (const Int3 &cell : references) cells.insert(cells.end(), cell.begin(), cell.end());
  numbers->reals["bodies.first_volumes"] = std::move(first_volumes);
  const InletGenerators *generators = solver.part<InletGenerators>();
  if (!generators) PetscFunctionReturn(0);
  if (!bodies.like().empty()) numbers->integers["bodies_like"].assign(bodies.like().begin(), bodies.like().end());
  std::vector<long> &inside = numbers->integers["bodies_in_feeders"];
  if (solver.domain().rank() > 0) PetscFunctionReturn(0);
  inside.assign(bodies.bodies(), 0);
  for (const auto &[label, stretch] : generators->inside()) inside[label - 1] = stretch + 1;
  PetscFunctionReturn(0);
}

PetscErrorCode require_range(const Domain &domain, const std::string &path, const std::string &absurd) {
  return fail_together(domain.comm(), absurd.empty() ? absurd : path + ": " + absurd);
}

PetscErrorCode load_bodies(CheckpointFile *file, const std::string &path, const Domain &domain, BodyTracker *bodies,
                           InletGenerators *generators) {
  const BodyRange own = BodyRange::of(bodies->bodies(), domain.rank(), domain.ranks());
  std::vector<long> cells(3 * own.size());
  std::vector<double> first_volumes(own.size());
  std::vector<Int3> references(own.size());
  PetscFunctionBeginUser;
  if (bodies->bodies() == 0) PetscFunctionReturn(0);
  PetscCall(file->read_own("bodies.references", &cells));
  PetscCall(file->read_own("bodies.first_volumes", &first_volumes));
  PetscCall(require_range(domain, path, find_invalid("the cell of a body", cells, {-1e9, 1e9, "-1e9 ... 1e9"})));
  PetscCall(require_range(domain, path,
                          find_invalid("the first volume of a body", first_volumes,
                                       {{0, std::numeric_limits<double>::max(), "a finite number >= 0"}})));
  for (std::size_t n = 0; n < cells.size(); ++n) references[n / 3][n % 3] = static_cast<int>(cells[n]);
  bodies->set_known(std::move(references), std::move(first_volumes));
  if (!generators) PetscFunctionReturn(0);
  std::vector<long> stretches(own.size());
  std::map<int, int> inside;
  PetscCall(file->read_own("bodies_in_feeders", &stretches));
  const double count = generators->count();
  PetscCall(
      require_range(domain, path, find_invalid("bodies_in_feeders", stretches, {0, count, "0 ... " + to_text(count)})));
  for (int b = 0; b < own.size(); ++b)
    if (stretches[b] > 0) inside[own.begin + b + 1] = static_cast<int>(stretches[b]) - 1;
  PetscCall(generators->set_inside(inside));
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
  PetscCall(send_to_ranks(domain.comm(), owners, &numbers));
  std::sort(numbers.begin(), numbers.end());
  const auto twice = std::adjacent_find(numbers.begin(), numbers.end());
  std::string wrong;
  if (twice != numbers.end())
    wrong = std::string(heads_name) + " holds body " + std::to_string(*twice) + " twice; accepted: every body once";
  PetscCall(require_range(domain, path, wrong));
  PetscFunctionReturn(0);
}

int pairs_of(const Solver &solver) {
  const auto *adhesion = solver.part<Adhesion>();
  return adhesion ? static_cast<int>(adhesion->pairs().size()) : 0;
}

// Reads the bodies in boxes, a part of them on each rank.
PetscErrorCode load_boxes(CheckpointFile *file, const std::string &path, Solver *solver) {
  const Domain &domain = solver->domain();
  CheckpointRecords heads{heads_name, FreeBodies::head, {}};
  PetscFunctionBeginUser;
  if (!solver->boxed().exist()) PetscFunctionReturn(0);
  PetscCall(file->read_records(&heads));
  const std::vector<Phase> &phases = solver->state().phases;
  PetscCall(require_range(domain, path, find_invalid_box(heads.values, domain, solver->bodies(), phases)));
  PetscCall(require_different(domain, path, solver->bodies().bodies(), heads.values));
  CheckpointRecords receptors{receptors_name, 1, {}};
  if (file->has(receptors_name)) PetscCall(file->read_records(&receptors));
  receptors.values.resize(heads.values.size() / FreeBodies::head);
  PetscCall(require_range(domain, path,
                          find_invalid(receptors_name, receptors.values, {{0, 1e9, "whole numbers from 0 on", true}})));
  std::vector<std::size_t> sizes;
  for (std::size_t b = 0; b < receptors.values.size(); ++b) {
    const double *head = &heads.values[b * FreeBodies::head];
    sizes.push_back(
        FreeBodies::packed_values(domain.domain_shape(), phases[static_cast<int>(head[1])].tensor.centred, head) +
        static_cast<std::size_t>(receptors.values[b]) * Receptor::numbers);
  }
  std::vector<double> values(std::accumulate(sizes.begin(), sizes.end(), std::size_t{0}));
  if (file->has(values_name)) PetscCall(file->read_own(values_name, &values));
  solver->boxed().bodies().clear();
  std::vector<std::vector<double>> all;
  std::string wrong;
  const double *next = values.data();
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
    const double *first = next - static_cast<int>(receptors.values[b]) * Receptor::numbers;
    const std::vector<double> markers(first - static_cast<int>(head[8]) * SurfaceMarker::numbers, first);
    if (wrong.empty())
      wrong = find_invalid_marker(markers, block, solver->bodies().bodies(), static_cast<int>(phases.size()));
    if (wrong.empty()) wrong = find_invalid_receptor({first, next}, solver->bodies().bodies(), pairs_of(*solver));
    if (!solver->part<Adhesion>()) packed.resize(packed.size() - (next - first));
  }
  PetscCall(require_range(domain, path, wrong));
  for (const std::vector<double> &packed : all) PetscCall(solver->boxed().add_packed(packed));
  PetscFunctionReturn(0);
}

constexpr const char *markers_name = "membrane_markers";

CheckpointRecords markers_of(const State &state) {
  CheckpointRecords records{markers_name, SurfaceMarker::numbers, {}};
  for (const SurfaceMarker &marker : state.markers) {
    const auto values = marker.packed();
    records.values.insert(records.values.end(), values.begin(), values.end());
  }
  return records;
}

PetscErrorCode load_markers(CheckpointFile *file, const std::string &path, Solver *solver) {
  const Domain &domain = solver->domain();
  CheckpointRecords records = markers_of({});
  std::vector<SurfaceMarker> markers;
  PetscFunctionBeginUser;
  PetscCall(file->read_records(&records));
  const Extent whole{{0, 0, 0}, domain.domain_cells()};
  const int bodies = solver->bodies().bodies(), species = static_cast<int>(solver->state().phases.size());
  PetscCall(require_range(domain, path, find_invalid_marker(records.values, whole, bodies, species)));
  for (std::size_t n = 0; n < records.values.size(); n += SurfaceMarker::numbers)
    markers.push_back(SurfaceMarker::unpacked(&records.values[n]));
  solver->state().markers.clear();
  if (auto *membranes = solver->part<MembraneTransport>()) PetscCall(membranes->set_markers(markers));
  PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode state_hash(Solver *solver, std::uint64_t *hash) {
  const Domain &domain = solver->domain();
  CarriedState state;
  std::uint64_t sum = 0;
  PetscFunctionBeginUser;
  PetscCall(solver->carry(&state));
  CheckpointNumbers numbers = numbers_of(state);
  PetscCall(gather_numbers(*solver, &numbers));
  if (domain.rank() == 0) sum = hash_arrays(numbers.reals) + hash_arrays(numbers.integers);
  for (const CheckpointField &field : state.fields)
    sum += hash_points(domain, field.view, field.staggering, hash_name(field.name));
  for (const SurfaceMarker &marker : solver->state().markers) sum += hash_values(marker.packed());
  for (const BodyInBox &body : solver->boxed().bodies().list()) sum += hash_body(body);
  for (const FreeBodies::Body &body : solver->boxed().bodies().bodies())
    for (const Receptor &receptor : body.receptors)
      sum += mix_bits(hash_values(receptor.packed()) ^ static_cast<std::uint64_t>(body.number));
  PetscCallMPI(MPI_Allreduce(&sum, hash, 1, MPI_UINT64_T, MPI_SUM, domain.comm()));
  PetscFunctionReturn(0);
}

PetscErrorCode save_state(Solver *solver, const RunPosition &run_position, const std::string &options,
                          const std::string &path) {
  RunPosition position = run_position;
  position.stages = solver->stages();
  position.sweeps = solver->sweeps();
  CarriedState state;
  PetscFunctionBeginUser;
  PetscCall(solver->carry(&state));
  add_position(solver->part<Adhesion>() != nullptr, &position, &state);
  CheckpointNumbers numbers = numbers_of(state);
  PetscCall(gather_numbers(*solver, &numbers));
  std::vector<CheckpointRecords> records = boxes_of(*solver);
  records.push_back(markers_of(solver->state()));
  PetscCall(write_checkpoint(solver->domain(), path, options, numbers, state.fields, records));
  PetscFunctionReturn(0);
}

PetscErrorCode load_state(CheckpointFile *file, const std::string &path, Solver *solver, RunPosition *position) {
  const Domain &domain = solver->domain();
  InletGenerators *generators = solver->part<InletGenerators>();
  std::vector<long> forgotten, like;
  PetscFunctionBeginUser;
  if (file->has("forgotten")) PetscCall(file->read_array("forgotten", &forgotten));
  if (generators) {
    if (file->has("bodies_like")) PetscCall(file->read_array("bodies_like", &like));
    solver->bodies().set_like({});
    PetscCall(require_range(domain, path, find_invalid_link(like, solver->bodies().bodies())));
    solver->bodies().set_like(like);
  }
  PetscCall(require_range(domain, path, find_invalid("forgotten", forgotten, any_count)));
  solver->state().forgotten = forgotten.empty() ? 0 : forgotten[0];
  const bool has_largest = file->has(largest_name);  // else it begins with the energy held at the next row
  CarriedState state;
  PetscCall(solver->carry(&state));
  add_position(solver->part<Adhesion>() != nullptr, position, &state);
  if (!has_largest) state.reals.erase(largest_name);
  const CheckpointNumbers expected = numbers_of(state);
  CheckpointNumbers numbers = expected;
  PetscCall(file->read_numbers(&numbers));
  const std::string wrong = wrong_length(expected, numbers);
  PetscCall(require_range(domain, path, wrong.empty() ? wrong : wrong + " belongs to another case"));
  PetscCall(require_range(domain, path, find_invalid_number(numbers)));
  PetscCall(load_bodies(file, path, domain, &solver->bodies(), generators));
  solver->clear_pressure_memory();  // the file may know of fewer increments
  for (Phase &phase : solver->state().phases) phase.empty(domain, bool(phase.label));  // of the scene's start
  PetscCall(load_boxes(file, path, solver));
  state = {};
  PetscCall(solver->carry(&state));  // the phases lie elsewhere now
  PetscCall(file->read_fields(domain, state.fields));
  add_position(solver->part<Adhesion>() != nullptr, position, &state);
  if (!has_largest) state.reals.erase(largest_name);
  take_numbers(numbers, state);
  PetscCall(load_markers(file, path, solver));
  PetscCall(solver->resume(position->stages, position->sweeps));
  if (!file->has(markers_name)) {  // they follow from the strain that membranes have
    if (auto *membranes = solver->part<MembraneTransport>()) PetscCall(membranes->place_markers());
    PetscCall(solver->boxed().bodies().place_markers());
  }
  if (auto *adhesion = solver->part<Adhesion>(); adhesion && !file->has(receptors_name))
    PetscCall(adhesion->place_on_bodies());
  PetscFunctionReturn(0);
}

}  // namespace eulastic
