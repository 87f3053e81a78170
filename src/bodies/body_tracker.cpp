// BodyTracker: which bodies there are, and the cells that follow them.
#include "base/deliver.hpp"
#include "bodies/measures.hpp"
#include "bodies/unwrap.hpp"
#include "grid/domain.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {

void BodyTracker::add_phase(const Domain &domain, const Places &places) {
  const BodyRange own = BodyRange::of(places.count, domain.rank(), domain.ranks());
  for (const NumberedPlace &place : places.known) {
    if (!own.has(place.index)) continue;
    Int3 cell{};
    for (int d = 0; d < domain.dimension(); ++d) {
      const int at = static_cast<int>(std::floor(place.centre[d] / domain.spacing()[d]));
      cell[d] = std::clamp(at, 0, domain.domain_cells()[d] - 1);
    }
    placed_.push_back({first_.back() + place.index, cell, 0});
  }
  first_.push_back(first_.back() + places.count);
}

// Who owns which bodies changes with their number.
PetscErrorCode BodyTracker::give_to_owners(const Domain &domain, std::vector<Known> known) {
  std::vector<int> owners;
  PetscFunctionBeginUser;
  for (const Known &one : known) owners.push_back(BodyRange::owner(one.body, bodies(), domain.ranks()));
  PetscCall(deliver(domain.comm(), owners, &known));
  std::sort(known.begin(), known.end(), [](const Known &a, const Known &b) { return a.body < b.body; });
  references_.clear();
  for (const Known &one : known) references_.push_back(one.reference);
  if (settled_) first_volumes_.clear();
  for (const Known &one : known)
    if (settled_) first_volumes_.push_back(one.first_volume);
  PetscFunctionReturn(0);
}

PetscErrorCode BodyTracker::settle(const Domain &domain) {
  PetscFunctionBeginUser;
  if (settled_) PetscFunctionReturn(0);
  PetscCall(give_to_owners(domain, std::move(placed_)));
  settled_ = true;
  PetscFunctionReturn(0);
}

PetscErrorCode BodyTracker::add_like(const Domain &domain, int label, const Int3 &shift) {
  PetscFunctionBeginUser;
  PetscCall(settle(domain));
  const BodyRange own = BodyRange::of(bodies(), domain.rank(), domain.ranks());
  std::vector<Known> known;
  first_volumes_.resize(references_.size());
  for (int b = own.begin; b < own.end; ++b)
    known.push_back({b, references_[b - own.begin], first_volumes_[b - own.begin]});
  if (own.has(label - 1)) {
    Known copy = known[label - 1 - own.begin];
    copy.body = bodies();
    for (int d = 0; d < 3; ++d) copy.reference[d] += shift[d];
    copy.reference = within_box(domain, {copy.reference})[0];
    known.push_back(copy);
  }
  like_.push_back(label > first_.back() ? like_[label - first_.back() - 1] : label);
  PetscCall(give_to_owners(domain, std::move(known)));
  PetscFunctionReturn(0);
}

void BodyTracker::set_like(const std::vector<long> &like) {
  like_.clear();
  for (const long label : like)
    like_.push_back(label > first_.back() ? like_[label - first_.back() - 1] : static_cast<int>(label));
}

int BodyTracker::species(int label) const {
  const int placed = label > first_.back() ? like_[label - first_.back() - 1] : label;
  return static_cast<int>(std::lower_bound(first_.begin(), first_.end(), placed) - first_.begin()) - 1;
}

PetscErrorCode BodyTracker::connect(const Domain &domain, const std::vector<Phase> &phases,
                                    const std::vector<int> &more, BodyOwners *owners, std::vector<Int3> *references) {
  std::vector<int> here;
  PetscFunctionBeginUser;
  const auto see = [&](int label) {
    if (label > 0 && label <= bodies() && (here.empty() || here.back() != label - 1)) here.push_back(label - 1);
  };
  for (const int label : more) see(label);
  for (const Phase &phase : phases)
    for (const Segment &whole : phase.label ? domain.rows() : std::vector<Segment>()) {
      const Segment row = phase.rows.within(whole, phase.label[0]);
      for (int i = row.i_begin; i < row.i_end; ++i) see(static_cast<int>(phase.label[0](i, row.j, row.k)));
    }
  std::sort(here.begin(), here.end());
  here.erase(std::unique(here.begin(), here.end()), here.end());
  PetscCall(owners->connect(domain.comm(), bodies(), std::move(here)));
  PetscCall(settle(domain));
  std::vector<double> owned, brought(3 * owners->here().size());
  for (const Int3 &cell : within_box(domain, references_)) owned.insert(owned.end(), cell.begin(), cell.end());
  PetscCall(owners->bring(3, owned, &brought));
  references->resize(owners->here().size());
  for (std::size_t n = 0; n < brought.size(); ++n) (*references)[n / 3][n % 3] = static_cast<int>(brought[n]);
  PetscFunctionReturn(0);
}

PetscErrorCode BodyTracker::set_last_references(const Domain &domain, const std::vector<std::pair<int, Int3>> &last) {
  std::vector<Known> known;
  std::vector<int> owners;
  PetscFunctionBeginUser;
  PetscCall(settle(domain));
  for (const auto &[label, cell] : last) {
    known.push_back({label - 1, cell, 0});
    owners.push_back(BodyRange::owner(label - 1, bodies(), domain.ranks()));
  }
  PetscCall(deliver(domain.comm(), owners, &known));
  const int first = BodyRange::of(bodies(), domain.rank(), domain.ranks()).begin;
  for (const Known &one : known) references_[one.body - first] = one.reference;
  PetscFunctionReturn(0);
}

PetscErrorCode BodyTracker::owned_references(const Domain &domain, std::vector<Int3> *references) {
  PetscFunctionBeginUser;
  PetscCall(settle(domain));
  *references = references_;
  PetscFunctionReturn(0);
}

void BodyTracker::wrap(const Box &box) {
  for (Int3 &cell : references_)
    for (int d = 0; d < 3; ++d)
      cell[d] = (cell[d] % box.domain_cells()[d] + box.domain_cells()[d]) % box.domain_cells()[d];
}

PetscErrorCode BodyTracker::known(const Domain &domain, std::vector<Int3> *references,
                                  std::vector<double> *first_volumes) {
  PetscFunctionBeginUser;
  PetscCall(settle(domain));
  std::vector<double> volumes = first_volumes_;
  volumes.resize(references_.size());
  PetscCall(gather_bodies(domain.comm(), bodies(), bodies(), references_, references));
  PetscCall(gather_bodies(domain.comm(), bodies(), bodies(), volumes, first_volumes));
  PetscFunctionReturn(0);
}

void BodyTracker::set_known(std::vector<Int3> owned_references, std::vector<double> owned_first_volumes) {
  references_ = std::move(owned_references);
  first_volumes_ = std::move(owned_first_volumes);
  placed_.clear();
  settled_ = true;
}

}  // namespace eulastic
