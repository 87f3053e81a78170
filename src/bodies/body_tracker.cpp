// BodyTracker: which bodies there are, and the cells that follow them.
#include "base/deliver.hpp"
#include "bodies/measures.hpp"
#include "bodies/unwrap.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {

void BodyTracker::add_phase(const Grid &grid, const std::vector<BodyPlace> &places) {
  for (const BodyPlace &place : places) {
    Int3 cell{};
    for (int d = 0; d < grid.dimension(); ++d) {
      const int at = static_cast<int>(std::floor(place.centre[d] / grid.spacing()[d]));
      cell[d] = std::clamp(at, 0, grid.cells()[d] - 1);
    }
    references_.push_back(cell);
    species_.push_back(phases_);
  }
  ++phases_;
}

// Who owns which bodies changes with their number.
PetscErrorCode BodyTracker::add_like(const Grid &grid, int label, const Int3 &shift) {
  struct Known {
    int body;
    Int3 reference;
    double first_volume;
  };
  PetscFunctionBeginUser;
  share(grid);
  const BodyRange own = BodyRange::of(bodies(), grid.rank(), grid.ranks());
  std::vector<Known> known;
  std::vector<int> owners;
  first_volumes_.resize(references_.size());
  for (int b = own.begin; b < own.end; ++b)
    known.push_back({b, references_[b - own.begin], first_volumes_[b - own.begin]});
  if (own.has(label - 1)) {
    Known copy = known[label - 1 - own.begin];
    copy.body = bodies();
    for (int d = 0; d < 3; ++d) copy.reference[d] += shift[d];
    copy.reference = within_box(grid, {copy.reference})[0];
    known.push_back(copy);
  }
  species_.push_back(species_[label - 1]);
  like_.push_back(label);
  for (const Known &one : known) owners.push_back(BodyRange::owner(one.body, bodies(), grid.ranks()));
  PetscCall(deliver(grid.comm(), owners, &known));
  std::sort(known.begin(), known.end(), [](const Known &a, const Known &b) { return a.body < b.body; });
  references_.clear();
  first_volumes_.clear();
  for (const Known &one : known) {
    references_.push_back(one.reference);
    first_volumes_.push_back(one.first_volume);
  }
  PetscFunctionReturn(0);
}

void BodyTracker::set_like(const std::vector<long> &like) {
  species_.resize(species_.size() - like_.size());
  like_.clear();
  for (const long label : like) {
    species_.push_back(species_[label - 1]);
    like_.push_back(static_cast<int>(label));
  }
}

PetscErrorCode BodyTracker::connect(const Grid &grid, const std::vector<Phase> &phases, const std::vector<int> &more,
                                    BodyOwners *owners, std::vector<Int3> *references) {
  std::vector<char> seen(static_cast<std::size_t>(bodies()), 0);
  std::vector<int> here;
  PetscFunctionBeginUser;
  for (const int label : more)
    if (label > 0 && label <= bodies()) seen[static_cast<std::size_t>(label - 1)] = 1;
  for (const Phase &phase : phases)
    for (const Segment &whole : grid.rows()) {
      const Segment row = phase.rows.within(whole, phase.label[0]);
      for (int i = row.i_begin; i < row.i_end; ++i) {
        const int body = static_cast<int>(phase.label[0](i, row.j, row.k)) - 1;
        if (body >= 0 && body < bodies()) seen[static_cast<std::size_t>(body)] = 1;
      }
    }
  for (int b = 0; b < bodies(); ++b)
    if (seen[static_cast<std::size_t>(b)]) here.push_back(b);
  PetscCall(owners->connect(grid.comm(), bodies(), std::move(here)));
  share(grid);
  std::vector<double> owned, brought(3 * owners->here().size());
  for (const Int3 &cell : within_box(grid, references_)) owned.insert(owned.end(), cell.begin(), cell.end());
  PetscCall(owners->bring(3, owned, &brought));
  references->resize(owners->here().size());
  for (std::size_t n = 0; n < brought.size(); ++n) (*references)[n / 3][n % 3] = static_cast<int>(brought[n]);
  PetscFunctionReturn(0);
}

void BodyTracker::share(const Grid &grid) {
  const BodyRange own = BodyRange::of(bodies(), grid.rank(), grid.ranks());
  if (!shared_) references_ = {references_.begin() + own.begin, references_.begin() + own.end};
  if (!shared_ && !first_volumes_.empty())
    first_volumes_ = {first_volumes_.begin() + own.begin, first_volumes_.begin() + own.end};
  shared_ = true;
}

void BodyTracker::wrap(const Grid &grid) {
  for (Int3 &cell : references_)
    for (int d = 0; d < 3; ++d) cell[d] = (cell[d] % grid.cells()[d] + grid.cells()[d]) % grid.cells()[d];
}

PetscErrorCode BodyTracker::known(MPI_Comm comm, std::vector<Int3> *references,
                                  std::vector<double> *first_volumes) const {
  PetscFunctionBeginUser;
  std::vector<double> volumes = first_volumes_;
  volumes.resize(references_.size());
  *references = references_;
  *first_volumes = volumes;
  if (!shared_) PetscFunctionReturn(0);
  PetscCall(gather_bodies(comm, bodies(), bodies(), references_, references));
  PetscCall(gather_bodies(comm, bodies(), bodies(), volumes, first_volumes));
  PetscFunctionReturn(0);
}

void BodyTracker::set_known(std::vector<Int3> owned_references, std::vector<double> owned_first_volumes) {
  references_ = std::move(owned_references);
  first_volumes_ = std::move(owned_first_volumes);
  shared_ = true;
}

}  // namespace eulastic
