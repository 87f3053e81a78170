#include "boxes/box_exchange.hpp"

#include "base/events.hpp"
#include "grid/threads.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <set>
#include <utility>

namespace eulastic {
namespace {

// Adding 0 would turn -0 into +0. Values to which a box adds nothing are therefore not changed, on any rank.
void add_values(const double *values, int count, double factor, double *to) {
  for (int m = 0; m < count; ++m) to[m] = values[m] == 0 ? to[m] : to[m] + factor * values[m];
}

/// Offsets, in a component of a field, of the rows of one thread.
struct OffsetRange {
  std::ptrdiff_t begin, end;
  bool has(std::ptrdiff_t offset) const { return offset >= begin && offset < end; }
};

OffsetRange offsets_of(const Box &box, int part, int parts) {
  const Layout &layout = box.layout();
  const auto start = [&](int p) {
    const RowPart rows = row_part(box, p, parts);
    return box.dimension() == 2 ? layout.offset(-layout.ghosts[0], rows.j_begin, 0)
                                : layout.offset(-layout.ghosts[0], -layout.ghosts[1], rows.k_begin);
  };
  return {part == 0 ? 0 : start(part), part == parts - 1 ? layout.size : start(part + 1)};
}

}  // namespace

void SegmentValues::take(const Field &field, const ActiveSegments &segments) {
  starts_.clear();
  size_ = 0;
  for (const Segment &s : segments.all()) {
    starts_.push_back(size_);
    size_ += s.size();
  }
  values_.resize(field.count() * size_);
  for (int f = 0; f < field.count(); ++f) {
    double *next = values_.data() + f * size_;
    for (const Segment &s : segments.all()) next = std::copy_n(field[f].row(s.j, s.k) + s.i_begin, s.size(), next);
  }
}

// work(first point, values, count) for the pieces of a run that lie in segments.
template <class Work>
void BoxExchange::for_pieces(const Run &run, const Contribution &contribution, int component, const Work &work) {
  if (!contribution.segments) return;
  const Segment *all = contribution.segments->all().data();
  for (const Segment &s : contribution.segments->row(run.j, run.k)) {
    const int first = std::max(s.i_begin, run.i), last = std::min(s.i_end, run.i + run.count);
    if (first < last) work(first, contribution.values->of(component, &s - all) + (first - s.i_begin), last - first);
  }
}

PetscErrorCode BoxExchange::connect(const std::vector<NumberedBox> &boxes, bool fetches_only) {
  PetscFunctionBeginUser;
  std::vector<PetscSFNode> roots, all;
  places_.clear();
  buffer_size_ = 0;
  for (const NumberedBox &numbered : boxes) {
    Place &place = places_.emplace_back();
    place.number = numbered.number;
    PetscCall(list_runs(*numbered.box, &place, &roots));
  }
  if (domain_->ranks() == 1) PetscFunctionReturn(0);  // nothing is remote
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
  if (!fetches_only) PetscCall(sort_received());
  PetscFunctionReturn(0);
}

// Who owns the points of a box, row by row. `roots`: of those that others own, in the first component.
PetscErrorCode BoxExchange::list_runs(const Box &box, Place *place, std::vector<PetscSFNode> *roots) {
  PetscFunctionBeginUser;
  const Split &split = domain_->split();
  const Int3 &begin = box.layout().begin;
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

// PetscSFGather delivers the values of all leaves of a root one after the other, in an order of its own. Finds out
// which boxes and which of their points they are from.
PetscErrorCode BoxExchange::sort_received() {
  const PetscInt *degree;
  PetscFunctionBeginUser;
  std::vector<std::array<PetscInt, 2>> sent;
  for (int f = 0; f < components_; ++f)
    for (const Place &place : places_)
      for (const Run &run : place.remote)
        for (int m = 0; m < run.count; ++m) sent.push_back({place.number, static_cast<PetscInt>(sent.size())});
  PetscCall(PetscSFComputeDegreeBegin(sf_.get(), &degree));
  PetscCall(PetscSFComputeDegreeEnd(sf_.get(), &degree));
  std::vector<PetscInt> offsets;
  for (PetscInt root = 0; root < components_ * static_cast<PetscInt>(domain_->layout().size); ++root)
    if (degree[root] > 0) offsets.insert(offsets.end(), degree[root], root);
  std::vector<std::array<PetscInt, 2>> received(offsets.size());
  PetscCall(PetscSFGatherBegin(sf_.get(), MPIU_2INT, sent.data(), received.data()));
  PetscCall(PetscSFGatherEnd(sf_.get(), MPIU_2INT, sent.data(), received.data()));
  received_.resize(offsets.size());
  parcels_.clear();
  std::vector<PetscInt> slots(offsets.size());
  std::iota(slots.begin(), slots.end(), 0);
  // A body that overlaps itself across a periodic side has several points for one root.
  for (std::size_t first = 0, last; first < slots.size(); first = last) {
    for (last = first + 1; last < slots.size() && offsets[last] == offsets[first];) ++last;
    if (last > first + 1)
      std::sort(slots.begin() + first, slots.begin() + last,
                [&](PetscInt one, PetscInt other) { return received[one] < received[other]; });
  }
  Parcel *parcel = nullptr;
  PetscInt number = -1;
  for (std::size_t n = 0; n < slots.size(); ++n) {
    const PetscInt slot = slots[n];
    if (std::exchange(number, received[slot][0]) != received[slot][0]) parcel = &parcels_[static_cast<int>(number)];
    parcel->slots.push_back(slot);
    parcel->offsets.push_back(offsets[slot]);
  }
  PetscFunctionReturn(0);
}

void BoxExchange::mark_rows(std::vector<char> *rows) const {
  const Layout &layout = domain_->layout();
  const auto mark = [&](std::ptrdiff_t offset) {
    const std::ptrdiff_t at = offset - layout.origin, k = at / layout.sz, j = at % layout.sz / layout.sy;
    // Faces of a high side belong to no row of cells.
    if (j < layout.cells[1] && k < layout.cells[2]) (*rows)[j + std::size_t(layout.cells[1]) * k] = 1;
  };
  for (const Place &place : places_)
    for (const Run &run : place.own) mark(run.elsewhere);
  for (const auto &[number, parcel] : parcels_)
    for (const PetscInt offset : parcel.offsets) mark(offset % layout.size);
}

std::size_t BoxExchange::bytes() const {
  std::size_t sum = (buffer_.size() + received_.size()) * sizeof(double);
  for (const Place &place : places_) sum += (place.own.size() + place.remote.size()) * sizeof(Run);
  for (const auto &[number, parcel] : parcels_) sum += 2 * parcel.slots.size() * sizeof(PetscInt);
  return sum;
}

PetscErrorCode BoxExchange::fetch(const Field &grid) {
  PetscFunctionBeginUser;
  EventScope scope(Event::exchange);
  if (domain_->ranks() == 1) PetscFunctionReturn(0);
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

// Sends the buffers to the ranks that own their points.
PetscErrorCode BoxExchange::gather() {
  PetscFunctionBeginUser;
  if (domain_->ranks() == 1) PetscFunctionReturn(0);
  PetscCall(PetscSFGatherBegin(sf_.get(), MPIU_REAL, buffer_.data(), received_.data()));
  PetscCall(PetscSFGatherEnd(sf_.get(), MPIU_REAL, buffer_.data(), received_.data()));
  PetscFunctionReturn(0);
}

PetscErrorCode BoxExchange::add(const std::vector<Contribution> &contributions,
                                const std::vector<WeightedTarget> &targets) {
  PetscFunctionBeginUser;
  EventScope scope(Event::exchange);
  const std::ptrdiff_t size = domain_->layout().size;
  for (std::size_t b = 0; b < places_.size(); ++b)
    for (int f = 0; f < components_; ++f)
      for (const Run &run : places_[b].remote) {
        double *to = buffer_.data() + f * buffer_size_ + run.elsewhere;
        std::fill_n(to, run.count, 0.0);
        for_pieces(run, contributions[b], f, [&](int first, const double *values, int count) {
          std::copy_n(values, count, to + (first - run.i));
        });
      }
  PetscCall(gather());
  // Each thread adds what all boxes have for the rows of its own.
  const int parts = row_parts(*domain_);
  in_parallel(parts, parts, [&](int part) {
    const OffsetRange own = offsets_of(*domain_, part, parts);
    const auto add_own = [&](std::size_t b) {
      for (const Run &run : places_[b].own)
        for (int f = 0; own.has(run.elsewhere) && f < components_; ++f)
          for_pieces(run, contributions[b], f, [&](int first, const double *values, int count) {
            const std::ptrdiff_t at = f * size + run.elsewhere + (first - run.i);
            for (const WeightedTarget &target : targets)
              add_values(values, count, target.factor, target.field->data() + at);
          });
    };
    in_order(add_own, [&](int, const Parcel &parcel) {
      const auto place_of = [&](std::ptrdiff_t offset) {  // offsets ascend
        return std::lower_bound(parcel.offsets.begin(), parcel.offsets.end(), offset) - parcel.offsets.begin();
      };
      for (int f = 0; f < components_; ++f)
        for (auto n = place_of(f * size + own.begin), end = place_of(f * size + own.end); n < end; ++n)
          for (const WeightedTarget &target : targets)
            add_values(&received_[parcel.slots[n]], 1, target.factor, target.field->data() + parcel.offsets[n]);
    });
  });
  PetscFunctionReturn(0);
}

template <class VisitOwn, class VisitReceived>
void BoxExchange::in_order(const VisitOwn &visit_own, const VisitReceived &visit_received) const {
  std::map<int, std::size_t> own;
  for (std::size_t b = 0; b < places_.size(); ++b) own[places_[b].number] = b;
  std::set<int> numbers;
  for (const auto &[number, b] : own) numbers.insert(number);
  for (const auto &[number, parcel] : parcels_) numbers.insert(number);
  for (const int number : numbers) {
    if (const auto at = own.find(number); at != own.end()) visit_own(at->second);
    if (const auto parcel = parcels_.find(number); parcel != parcels_.end()) visit_received(number, parcel->second);
  }
}

PetscErrorCode BoxExchange::collect(const FieldOf &field_of, const Visit &visit) {
  PetscFunctionBeginUser;
  EventScope scope(Event::exchange);
  for (std::size_t b = 0; b < places_.size(); ++b) {
    if (places_[b].remote.empty()) continue;
    const Field &field = field_of(b);
    for (int f = 0; f < components_; ++f)
      for (const Run &run : places_[b].remote)
        std::copy_n(field[f].row(run.j, run.k) + run.i, run.count, buffer_.data() + f * buffer_size_ + run.elsewhere);
  }
  PetscCall(gather());
  std::vector<const double *> values(components_);
  const auto visit_own = [&](std::size_t b) {
    if (places_[b].own.empty()) return;
    const Field &field = field_of(b);
    for (const Run &run : places_[b].own) {
      for (int f = 0; f < components_; ++f) values[f] = field[f].row(run.j, run.k) + run.i;
      visit(places_[b].number, run.elsewhere, run.count, values.data());
    }
  };
  std::vector<double> row;
  in_order(visit_own, [&](int number, const Parcel &parcel) {
    const std::size_t points = parcel.slots.size() / components_;  // component after component
    for (std::size_t n = 0, count; n < points; n += count) {
      for (count = 1; n + count < points && parcel.offsets[n + count] == parcel.offsets[n] + static_cast<int>(count);)
        ++count;
      row.resize(components_ * count);
      for (int f = 0; f < components_; ++f) {
        values[f] = row.data() + f * count;
        for (std::size_t m = 0; m < count; ++m) row[f * count + m] = received_[parcel.slots[n + m + f * points]];
      }
      visit(number, parcel.offsets[n], static_cast<int>(count), values.data());
    }
  });
  PetscFunctionReturn(0);
}

}  // namespace eulastic
