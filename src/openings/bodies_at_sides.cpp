#include "openings/bodies_at_sides.hpp"

#include "bodies/labels.hpp"
#include "openings/body_copy.hpp"
#include "openings/leaving.hpp"

#include <algorithm>

namespace eulastic {
namespace {

// What stays where it is, or cannot be followed.
bool is_held(const Phase &phase) { return !phase.label || phase.material.anchored || phase.material.is_rigid(); }

}  // namespace

// Bodies flow out through open sides, or leave whole when they come there. At the start they may not be there.
PetscErrorCode BodiesAtSides::check_sides(bool start) {
  // What is held and where, whether any leave whole, whether any flow out; of bodies in boxes, whether any leave.
  int found[4] = {-1, 0, 0, 0};
  std::vector<std::size_t> leaving;
  // Phase, direction and side in one number, as ranks have to agree on one of several places in one reduction.
  const auto hold = [&](int phase, int d, bool high) { found[0] = std::max(found[0], phase * 6 + 2 * d + high); };
  PetscFunctionBeginUser;
  const std::vector<BodyInBox> boxed = boxed_.bodies().list();
  for (std::size_t b = 0; b < boxed.size(); ++b) {
    const BodyInBox &body = boxed[b];
    for (const auto [d, high] : flow_.domain.sides())
      if (const BoundaryKind kind = flow_.spec.sides[d][high].kind; fluid_crosses(kind) && (start || !is_open(kind)))
        if (has_solid(*body.box, body.phase->fraction[0], d, high, free_layers, BodyCells::threshold))
          hold(body.species, d, high);
    if (!start && leaves_box(body)) leaving.push_back(b);
  }
  found[3] = !leaving.empty();
  for (int p = 0; p < static_cast<int>(flow_.now.phases.size()); ++p)
    for (const auto [d, high] : flow_.domain.sides()) {
      const BoundaryKind kind = flow_.spec.sides[d][high].kind;
      if (flow_.now.phases[p].material.is_rigid() || flow_.now.phases[p].boxed || !fluid_crosses(kind)) continue;
      const bool stops = start || !is_open(kind) || is_held(flow_.now.phases[p]);
      if (!has_solid(flow_.domain, flow_.now.phases[p].fraction[0], d, high, free_layers,
                     stops ? BodyCells::threshold : 0))
        continue;
      if (stops)
        hold(p, d, high);
      else
        found[leaves_whole(flow_.now.phases[p].material) ? 1 : 2] = 1;
    }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, found, 4, MPI_INT, MPI_MAX, flow_.domain.comm()));
  const int held = found[0];
  if (held >= 0)
    flow_.stop_reason = "-species " + flow_.now.phases[held / 6].species + ": a body is within " +
                        std::to_string(free_layers) + " cells of the open boundary " +
                        side_name(held % 6 / 2, held % 2 != 0) +
                        "; accepted: bodies that stay further inside, or a longer box";
  if (held < 0 && found[3] > 0) PetscCall(remove_boxed_bodies(leaving));
  if (held < 0 && found[1] > 0) PetscCall(remove_bodies(true));
  if (held < 0 && found[2] > 0 && flow_.now.travel_since_labels == 0)
    PetscCall(remove_bodies(false));  // labels are new
  PetscFunctionReturn(0);
}

// Bodies of this rank in boxes, by their places in the list. They are last known where they are now.
PetscErrorCode BodiesAtSides::remove_boxed_bodies(const std::vector<std::size_t> &leaving) {
  std::vector<std::pair<int, Int3>> last;
  PetscFunctionBeginUser;
  const std::vector<BodyInBox> all = boxed_.bodies().list();
  for (const std::size_t b : leaving) {
    Int3 middle = all[b].phase->extent(*all[b].box).middle();
    for (int d = 0; d < 3; ++d) middle[d] += all[b].box->layout().begin[d];
    last.emplace_back(all[b].number, middle);
  }
  boxed_.bodies().remove(leaving);
  PetscCall(boxed_.refit());
  PetscCall(flow_.bodies.set_last_references(flow_.domain, last));
  PetscFunctionReturn(0);
}

// Removes the leaving bodies: those that are removed whole, or the others once all their solid lies beside a boundary.
PetscErrorCode BodiesAtSides::remove_bodies(bool whole) {
  std::map<int, Leaving> leaves;
  BodyOwners owners;
  std::vector<Int3> references;
  const auto concerned = [&](const Phase &phase) { return !is_held(phase) && leaves_whole(phase.material) == whole; };
  // All ranks with cells of a body agree on the largest value of Leaving that any of them found.
  const auto agree = [&] {
    std::vector<double> here, owned(static_cast<std::size_t>(owners.owned().size()), 0);
    PetscFunctionBeginUser;
    for (const int body : owners.here()) here.push_back(leaves.count(body + 1) ? double(leaves[body + 1]) : 0);
    PetscCall(owners.reduce(1, MPI_MAX, here, &owned));
    PetscCall(owners.bring(1, owned, &here));
    for (std::size_t n = 0; n < here.size(); ++n)
      if (here[n] > 0) leaves[owners.here()[n] + 1] = static_cast<Leaving>(static_cast<int>(here[n]));
    PetscFunctionReturn(0);
  };
  PetscFunctionBeginUser;
  for (Phase &phase : flow_.now.phases) {
    if (!concerned(phase)) continue;
    if (whole) PetscCall(carry_labels(flow_.domain, flow_.exchange, &phase));
    for (const auto [d, high] : flow_.domain.sides())
      if (flow_.domain.is_open(d, high)) mark_leaving(flow_.domain, d, high, free_layers, whole, &phase, &leaves);
  }
  PetscCall(flow_.bodies.connect(flow_.domain, flow_.now.phases, {}, &owners, &references));
  PetscCall(agree());
  if (!whole) {
    for (const Phase &phase : flow_.now.phases)
      if (concerned(phase)) mark_staying(flow_.domain, free_layers, phase, &leaves);
    PetscCall(agree());
    int any = std::any_of(leaves.begin(), leaves.end(), [](const auto &of) { return of.second == Leaving::leaves; });
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, flow_.domain.comm()));
    if (!any) PetscFunctionReturn(0);
  }
  for (Phase &phase : flow_.now.phases) {
    if (!concerned(phase)) continue;
    remove_leaving(flow_.domain, leaves, &phase);
    PetscCall(flow_.rebuild_derived_fields(&phase));
  }
  if (!whole) PetscFunctionReturn(0);
  for (FlowPart *part : flow_.parts) PetscCall(part->observe_removed_bodies());
  PetscFunctionReturn(0);
}

namespace {

// In a cell at the surfaces of two bodies that touch fractions may add up to more than 1.
constexpr double full = 1.5;

bool lies_in_domain(const Box &block) {
  bool inside = true;
  for (int d = 0; d < block.dimension(); ++d) {
    const int begin = block.layout().begin[d], end = begin + block.cells()[d];
    inside = inside && (!block.is_wall(d) || (begin >= 0 && end <= block.domain_cells()[d]));
  }
  return inside;
}

}  // namespace

// Solid fraction of all bodies together, on the grid.
PetscErrorCode BodiesAtSides::sum_fractions(Field *sum) {
  std::map<int, Phase> shown;
  PetscFunctionBeginUser;
  *sum = Field(flow_.domain, 1);
  PetscCall(boxed_.find_all_fractions(&shown));
  for (std::size_t p = 0; p < flow_.now.phases.size(); ++p) {
    const Phase &phase = flow_.now.phases[p].boxed ? shown[static_cast<int>(p)] : flow_.now.phases[p];
    const ConstView phi = phase.fraction[0];
    for_points(flow_.domain.rows(), [&, to = (*sum)[0]](int i, int j, int k) { to(i, j, k) += phi(i, j, k); });
  }
  PetscFunctionReturn(0);
}

// All bodies are compared with the same fractions, so that bodies of one stretch keep their distances when they enter.
PetscErrorCode BodiesAtSides::find_coming(const std::vector<int> &labels, std::vector<Coming> *states) {
  Field fractions;
  PetscFunctionBeginUser;
  PetscCall(sum_fractions(&fractions));
  struct Candidate {
    std::size_t which;  // of the labels
    BodyInBox body;
    Box block;  // where it would be
  };
  std::vector<Candidate> candidates;
  states->assign(labels.size(), Coming::has_left);
  for (const BodyInBox &body : boxed_.bodies().list()) {
    const auto found = std::find(labels.begin(), labels.end(), body.number);
    if (found == labels.end()) continue;
    const std::size_t n = found - labels.begin();
    const Box here = body.phase->block(*body.box, 0, 0);
    Int3 begin = here.layout().begin;
    for (int d = 0; d < 3; ++d) begin[d] += generators_->shift_of(body.number)[d];
    const Box block(flow_.domain.domain_shape(), begin, here.cells(), 0);
    (*states)[n] = Coming::waits;
    if (lies_in_domain(block)) candidates.push_back({n, body, block});
  }
  std::vector<BoxExchange::NumberedBox> numbered;
  for (const Candidate &one : candidates) numbered.push_back({&one.block, one.body.number});
  BoxExchange exchange(flow_.domain, 1);
  PetscCall(exchange.connect(numbered));
  PetscCall(exchange.fetch(fractions));
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    const auto &[n, body, block] = candidates[c];
    const Int3 first = body.phase->extent(*body.box).begin;
    const ConstView own = body.phase->fraction[0];
    Field there(block, 1);
    exchange.copy_to_box(c, fractions, there);
    double fullest = 0;
    for_points(block.rows(), [&](int i, int j, int k) {
      const double phi = own(first[0] + i, first[1] + j, first[2] + k);
      if (phi > BodyCells::threshold) fullest = std::max(fullest, phi + there[0](i, j, k));
    });
    if (fullest <= full) (*states)[n] = Coming::comes_in;
  }
  PetscFunctionReturn(0);
}

PetscErrorCode BodiesAtSides::copy_boxed_from_inlets(const std::vector<int> &labels) {
  std::vector<Coming> own, states;
  PetscFunctionBeginUser;
  PetscCall(find_coming(labels, &own));
  states = own;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, states.data(), static_cast<int>(states.size()), MPI_INT, MPI_MAX,
                             flow_.domain.comm()));
  std::vector<std::pair<int, int>> copies;  // of this rank: label of the body, that of its copy
  std::map<int, Int3> shifts;
  for (std::size_t n = 0; n < labels.size(); ++n) {
    if (states[n] == Coming::waits) continue;
    if (states[n] == Coming::comes_in) {
      shifts[labels[n]] = generators_->shift_of(labels[n]);
      PetscCall(flow_.bodies.add_like(flow_.domain, labels[n], shifts[labels[n]]));
      generators_->let_in(labels[n], flow_.bodies.bodies());
      if (own[n] == Coming::comes_in) copies.emplace_back(labels[n], flow_.bodies.bodies());
    }
    generators_->forget(labels[n]);
  }
  PetscCall(boxed_.add_copies(copies, shifts));
  if (!shifts.empty()) PetscCall(boxed_.refit());
  PetscFunctionReturn(0);
}

// A body that has left its inlet generator comes in behind; where others fill its place it waits.
PetscErrorCode BodiesAtSides::update_after_labels() {
  std::vector<int> all, passed, boxed;
  std::vector<BodyCopy> copies;
  PetscFunctionBeginUser;
  if (!generators_) PetscFunctionReturn(0);
  PetscCall(generators_->find_passed(&all));
  for (const int label : all) (flow_.now.phases[flow_.bodies.species(label)].boxed ? boxed : passed).push_back(label);
  if (!boxed.empty()) PetscCall(copy_boxed_from_inlets(boxed));
  if (passed.empty()) PetscFunctionReturn(0);
  PetscCall(copy_bodies(flow_.domain, flow_.exchange, passed, &flow_.now.phases, &copies));
  for (const BodyCopy &copy : copies) {
    if (copy.phase < 0) {  // it has left
      generators_->forget(copy.label);
      continue;
    }
    const Int3 shift = generators_->shift_of(copy.label);
    Field fractions;
    double fullest = 0;
    PetscCall(sum_fractions(&fractions));
    PetscCall(find_fullest(flow_.domain, copy, shift, fractions[0], &fullest));
    if (fullest > full) continue;
    PetscCall(flow_.bodies.add_like(flow_.domain, copy.label, shift));
    generators_->let_in(copy.label, flow_.bodies.bodies());
    generators_->forget(copy.label);
    Phase &phase = flow_.now.phases[copy.phase];
    insert_body(flow_.domain, copy, shift, flow_.bodies.bodies(), &phase);
    PetscCall(flow_.rebuild_derived_fields(&phase));
    for (FlowPart *part : flow_.parts) PetscCall(part->observe_new_body(phase, copy.phase, flow_.bodies.bodies()));
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
