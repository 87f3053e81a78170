// BodyTracker: which bodies there are, and the cells that follow them.
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

PetscErrorCode BodyTracker::add_like(const Grid &grid, int label, const Int3 &shift) {
  std::vector<Int3> all;
  PetscFunctionBeginUser;
  PetscCall(all_references(grid.comm(), &all));
  Int3 cell = all[label - 1];
  for (int d = 0; d < 3; ++d) cell[d] += shift[d];
  all.push_back(within_box(grid, {cell})[0]);
  set_references(std::move(all));
  species_.push_back(species_[label - 1]);
  like_.push_back(label);
  PetscFunctionReturn(0);
}

void BodyTracker::complete(std::vector<double> *known) const {
  const std::size_t scene = species_.size() - like_.size();
  for (std::size_t b = known->size(); b >= scene && b < species_.size(); ++b)
    known->push_back((*known)[like_[b - scene] - 1]);
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
  if (!shared_) {
    const BodyRange &own = owners->owned();
    references_ = {references_.begin() + own.begin, references_.begin() + own.end};
    shared_ = true;
  }
  std::vector<double> owned, brought(3 * owners->here().size());
  for (const Int3 &cell : within_box(grid, references_)) owned.insert(owned.end(), cell.begin(), cell.end());
  PetscCall(owners->bring(3, owned, &brought));
  references->resize(owners->here().size());
  for (std::size_t n = 0; n < brought.size(); ++n) (*references)[n / 3][n % 3] = static_cast<int>(brought[n]);
  PetscFunctionReturn(0);
}

PetscErrorCode BodyTracker::all_references(MPI_Comm comm, std::vector<Int3> *all) const {
  PetscFunctionBeginUser;
  if (shared_)
    PetscCall(gather_bodies(comm, bodies(), bodies(), references_, all));
  else
    *all = references_;
  PetscFunctionReturn(0);
}

}  // namespace eulastic
