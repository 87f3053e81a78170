#include "field/box_exchange.hpp"

#include "base/events.hpp"

#include <algorithm>
#include <set>

namespace eulastic {
namespace {

// Adding 0 would make +0 of -0: no value is touched where a box has nothing to add, whoever owns it.
void add_values(const double *values, int count, double *to) {
  for (int m = 0; m < count; ++m) to[m] = values[m] == 0 ? to[m] : to[m] + values[m];
}

}  // namespace

// work(first point, count) for the pieces of a run that lie in segments.
template <class Work>
void BoxExchange::for_pieces(const Run &run, const ActiveSegments &segments, const Work &work) {
  for (const Segment &s : segments.row(run.j, run.k)) {
    const int first = std::max(s.i_begin, run.i), last = std::min(s.i_end, run.i + run.count);
    if (first < last) work(first, last - first);
  }
}

PetscErrorCode BoxExchange::connect(const std::vector<NumberedBox> &boxes) {
  PetscFunctionBeginUser;
  std::vector<PetscSFNode> roots, all;
  places_.clear();
  buffer_size_ = 0;
  for (const NumberedBox &numbered : boxes) {
    Place &place = places_.emplace_back();
    place.number = numbered.number;
    PetscCall(list_runs(*numbered.box, &place, &roots));
  }
  const Split &split = domain_->split();
  std::map<PetscInt, PetscInt> field_size;
  for (const PetscSFNode &root : roots) field_size[root.rank] = 0;
  for (auto &[rank, size] : field_size)
    PetscCall(PetscIntCast(split.box_of(static_cast<int>(rank), domain_->spec(), domain_->spec().ghosts).layout().size,
                           &size));
  for (int f = 0; f < components_; ++f)
    for (const PetscSFNode &root : roots) all.push_back({root.rank, f * field_size.at(root.rank) + root.index});
  PetscInt values;
  PetscCall(PetscIntCast(components_ * domain_->layout().size, &values));
  PetscCall(PetscSFCreate(domain_->comm(), sf_.put()));
  PetscCall(PetscSFSetFromOptions(sf_.get()));
  PetscCall(PetscSFSetGraph(sf_.get(), values, static_cast<PetscInt>(all.size()), nullptr, PETSC_OWN_POINTER,
                            all.data(), PETSC_COPY_VALUES));
  PetscCall(PetscSFSetUp(sf_.get()));
  buffer_.resize(components_ * buffer_size_);
  PetscCall(sort_received());
  PetscFunctionReturn(0);
}

// Who owns the points of a box, row by row. `roots`: of those that others own, in the first component.
PetscErrorCode BoxExchange::list_runs(const Box &box, Place *place, std::vector<PetscSFNode> *roots) {
  PetscFunctionBeginUser;
  const Split &split = domain_->split();
  const Int3 &begin = box.layout().begin, &cells = domain_->domain_cells();
  for (int d = 0; d < domain_->dimension(); ++d)
    PetscCheck(box.cells()[d] <= cells[d], PETSC_COMM_SELF, PETSC_ERR_ARG_SIZ,
               "a box of %d cells is longer than the domain, %d", box.cells()[d], cells[d]);
  std::map<int, Layout> layouts;
  for (int k = 0; k < box.points_end(2, true); ++k)
    for (int j = 0; j < box.points_end(1, true); ++j) {
      const int y = box.image(1, begin[1] + j), z = box.image(2, begin[2] + k);
      const int py = split.position_along(1, y), pz = split.position_along(2, z);
      const int end = box.points_end(0, true);
      for (int i = 0, count = 0; i < end; i += count) {
        const int x = box.image(0, begin[0] + i), px = split.position_along(0, x);
        const int rank = split.rank_at({px, py, pz});
        const bool last = box.is_wall(0) && px == split.parts(0) - 1;  // it owns the high face as well
        count = std::min(end - i, split.starts[0][px + 1] + last - x);
        auto found = layouts.find(rank);
        if (found == layouts.end())
          found = layouts.emplace(rank, split.box_of(rank, domain_->spec(), domain_->spec().ghosts).layout()).first;
        const Layout &theirs = found->second;
        const std::ptrdiff_t offset = theirs.offset(x - theirs.begin[0], y - theirs.begin[1], z - theirs.begin[2]);
        if (rank == domain_->rank()) {
          place->own.push_back({i, j, k, count, offset});
          continue;
        }
        place->remote.push_back({i, j, k, count, buffer_size_});
        buffer_size_ += count;
        for (int m = 0; m < count; ++m) roots->push_back({rank, static_cast<PetscInt>(offset + m)});
      }
    }
  PetscFunctionReturn(0);
}

// PetscSFGather delivers the values of all leaves of a root one after the other. Finds out which boxes they are from.
PetscErrorCode BoxExchange::sort_received() {
  const PetscInt *degree;
  PetscFunctionBeginUser;
  std::vector<PetscInt> numbers;
  for (int f = 0; f < components_; ++f)
    for (const Place &place : places_)
      for (const Run &run : place.remote) numbers.insert(numbers.end(), run.count, place.number);
  PetscCall(PetscSFComputeDegreeBegin(sf_.get(), &degree));
  PetscCall(PetscSFComputeDegreeEnd(sf_.get(), &degree));
  std::vector<PetscInt> offsets;
  for (PetscInt root = 0; root < components_ * static_cast<PetscInt>(domain_->layout().size); ++root)
    offsets.insert(offsets.end(), degree[root], root);
  std::vector<PetscInt> number_of(offsets.size());
  PetscCall(PetscSFGatherBegin(sf_.get(), MPIU_INT, numbers.data(), number_of.data()));
  PetscCall(PetscSFGatherEnd(sf_.get(), MPIU_INT, numbers.data(), number_of.data()));
  received_.resize(offsets.size());
  parcels_.clear();
  Parcel *parcel = nullptr;
  for (std::size_t slot = 0; slot < offsets.size(); ++slot) {
    if (slot == 0 || number_of[slot] != number_of[slot - 1]) parcel = &parcels_[static_cast<int>(number_of[slot])];
    parcel->slots.push_back(static_cast<PetscInt>(slot));
    parcel->offsets.push_back(offsets[slot]);
  }
  PetscFunctionReturn(0);
}

PetscErrorCode BoxExchange::fetch(const Field &grid) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::exchange);
  PetscCall(PetscSFBcastBegin(sf_.get(), MPIU_REAL, grid.data(), buffer_.data(), MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(sf_.get(), MPIU_REAL, grid.data(), buffer_.data(), MPI_REPLACE));
  PetscFunctionReturn(0);
}

void BoxExchange::copy_to_box(std::size_t b, const Field &grid, Field &to) const {
  const std::ptrdiff_t size = domain_->layout().size;
  for (int f = 0; f < components_; ++f) {
    const View box = to[f];
    for (const Run &run : places_[b].own)
      std::copy_n(grid.data() + f * size + run.elsewhere, run.count, box.row(run.j, run.k) + run.i);
    for (const Run &run : places_[b].remote)
      std::copy_n(buffer_.data() + f * buffer_size_ + run.elsewhere, run.count, box.row(run.j, run.k) + run.i);
  }
}

PetscErrorCode BoxExchange::add(const std::vector<Contribution> &contributions, Field &grid) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::exchange);
  const std::ptrdiff_t size = domain_->layout().size;
  for (std::size_t b = 0; b < places_.size(); ++b)
    for (int f = 0; f < components_; ++f)
      for (const Run &run : places_[b].remote) {
        double *values = buffer_.data() + f * buffer_size_ + run.elsewhere;
        std::fill_n(values, run.count, 0.0);
        for_pieces(run, *contributions[b].segments, [&](int first, int count) {
          std::copy_n((*contributions[b].field)[f].row(run.j, run.k) + first, count, values + (first - run.i));
        });
      }
  PetscCall(PetscSFGatherBegin(sf_.get(), MPIU_REAL, buffer_.data(), received_.data()));
  PetscCall(PetscSFGatherEnd(sf_.get(), MPIU_REAL, buffer_.data(), received_.data()));
  const auto add_own = [&](std::size_t b) {
    for (int f = 0; f < components_; ++f)
      for (const Run &run : places_[b].own)
        for_pieces(run, *contributions[b].segments, [&](int first, int count) {
          add_values((*contributions[b].field)[f].row(run.j, run.k) + first, count,
                     grid.data() + f * size + run.elsewhere + (first - run.i));
        });
  };
  std::map<int, std::size_t> own;
  for (std::size_t b = 0; b < places_.size(); ++b) own[places_[b].number] = b;
  std::set<int> numbers;
  for (const auto &[number, b] : own) numbers.insert(number);
  for (const auto &[number, parcel] : parcels_) numbers.insert(number);
  for (const int number : numbers) {
    if (const auto at = own.find(number); at != own.end()) add_own(at->second);
    const auto parcel = parcels_.find(number);
    if (parcel == parcels_.end()) continue;
    for (std::size_t n = 0; n < parcel->second.slots.size(); ++n)
      add_values(&received_[parcel->second.slots[n]], 1, grid.data() + parcel->second.offsets[n]);
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
