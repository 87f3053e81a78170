#include "grid/occupied_rows.hpp"

#include "grid/threads.hpp"

#include <cstdint>
#include <cstring>

namespace eulastic {
namespace {

bool skip_nothing = false;

}  // namespace

void set_skip_nothing(bool nothing) noexcept { skip_nothing = nothing; }
bool skips_nothing() noexcept { return skip_nothing; }

// Tests bits without the sign bit, because the compiler vectorises integer operations.
bool OccupiedRows::any(const double *row, int begin, int end) noexcept {
  std::uint64_t found = 0;
  for (int i = begin; i < end; ++i) {
    std::uint64_t bits;
    std::memcpy(&bits, row + i, sizeof bits);
    found |= bits << 1;
  }
  return found != 0;
}

namespace {

using Span = OccupiedRows::Span;

// Returns the part of the row from the first to the last piece of 16 cells with a nonzero value.
Span occupied(const double *row, Span within) {
  constexpr int piece = 16;
  while (within.begin < within.end && !OccupiedRows::any(row, within.begin, std::min(within.begin + piece, within.end)))
    within.begin += piece;
  while (within.begin < within.end && !OccupiedRows::any(row, std::max(within.end - piece, within.begin), within.end))
    within.end -= piece;
  return within;
}

// Prefetches the ends of a row that occupied() reads. Hardware prefetchers do not detect these short, distant accesses.
void prefetch_ends(const double *row, Span s) {
  constexpr int line = 8;
  for (int i = 0; i < 3 * line; i += line) {
    __builtin_prefetch(row + s.begin + i);
    __builtin_prefetch(row + s.end - 1 - i);
  }
}

bool is_empty(const Span &s) { return s.begin >= s.end; }

void add(const Span &more, Span *sum) {
  if (is_empty(more)) return;
  *sum = is_empty(*sum) ? more : Span{std::min(sum->begin, more.begin), std::max(sum->end, more.end)};
}

}  // namespace

PetscErrorCode OccupiedRows::find(const Domain &domain, ConstView value) {
  PetscFunctionBeginUser;
  *this = {};
  PetscCall(update(domain, {{this, value}}));
  PetscFunctionReturn(0);
}

PetscErrorCode OccupiedRows::update(const Domain &domain, const std::vector<Transported> &moved) {
  PetscFunctionBeginUser;
  if (moved.empty()) PetscFunctionReturn(0);
  std::vector<int> all_inside;  // one flag for each field
  for (const Transported &one : moved) {
    const OccupiedRows before = std::move(*one.rows);
    one.rows->read(domain, one.value, before, {domain.layout().ghosts[0] + beyond_ghosts, false});
    all_inside.push_back(one.rows->inside_);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, all_inside.data(), static_cast<int>(all_inside.size()), MPI_INT, MPI_LAND,
                             domain.comm()));
  for (std::size_t n = 0; n < moved.size(); ++n) moved[n].rows->inside_ = all_inside[n] != 0;
  PetscFunctionReturn(0);
}

void OccupiedRows::find_in_box(const Box &box, ConstView value, int reach) {
  *this = {};
  update_in_box(box, value, reach);
}

void OccupiedRows::update_in_box(const Box &box, ConstView value, int reach) {
  const OccupiedRows before = std::move(*this);
  read(box, value, before, {reach, true});
}

void OccupiedRows::read(const Box &box, ConstView value, const OccupiedRows &before, const Reading &reading) {
  const Int3 &n = box.cells(), &ghosts = box.layout().ghosts;
  const bool complete = reading.complete;
  const int reach = reading.reach, reach_z = ghosts[2] > 0 ? reach : 0;
  constexpr int ahead = 8;  // rows
  const bool split_x = !box.spans(0) && !complete;
  const Span whole{-ghosts[0], n[0] + ghosts[0]};
  cells_of_box_ = n;
  unknown_ = whole;
  low_y_ = complete ? -ghosts[1] : 0;
  low_z_ = complete ? -ghosts[2] : 0;
  rows_y_ = n[1] - 2 * low_y_;
  rows_z_ = n[2] - 2 * low_z_;
  const std::size_t rows = rows_y_;
  spans_.assign(rows * rows_z_, {0, 0});
  std::vector<Span> along_y(rows * (n[2] + 2 * ghosts[2]), {0, 0});  // cells within reach in x and y, for every plane
  const auto read_plane = [&](int k) {
    for (int j = -ghosts[1]; j < n[1] + ghosts[1]; ++j) {
      const bool owned = j >= 0 && j < n[1] && k >= 0 && k < n[2];
      if ((complete || before.inside_) && !owned) continue;  // the body cannot have reached ghosts
      const bool was_idle = before.idle(j, k);
      if (was_idle && !split_x) continue;
      const double *row = value.row(j, k);
      const Span next = before.span(j + ahead, k);
      prefetch_ends(value.row(j + ahead, k), {std::max(next.begin, whole.begin), std::min(next.end, whole.end)});
      const Span old = before.span(j, k);
      Span found = was_idle ? old : occupied(row, {std::max(old.begin, 0), std::min(old.end, n[0])});
      if (!complete) {
        add(occupied(row, {whole.begin, 0}), &found);  // values that came from other ranks
        add(occupied(row, {n[0], whole.end}), &found);
      }
      if (is_empty(found)) continue;
      found = {std::max(found.begin - reach, whole.begin), std::min(found.end + reach, whole.end)};
      for (int y = std::max(j - reach, low_y_); y < std::min(j + reach + 1, low_y_ + rows_y_); ++y)
        add(found, &along_y[y - low_y_ + rows * (k + ghosts[2])]);
    }
  };
  const int planes = n[2] + 2 * ghosts[2], parts = row_parts(box);
  in_parallel(parts, parts, [&](int part) {
    const Piece own(planes, part, parts);
    for (std::size_t k = own.begin; k < own.end; ++k) read_plane(int(k) - ghosts[2]);
  });
  for (int k = -ghosts[2]; k < n[2] + ghosts[2]; ++k)
    for (int z = std::max(k - reach_z, low_z_); z < std::min(k + reach_z + 1, low_z_ + rows_z_); ++z)
      for (int y = 0; y < rows_y_; ++y) add(along_y[y + rows * (k + ghosts[2])], &spans_[y + rows * (z - low_z_)]);
  if (skips_nothing()) spans_.assign(spans_.size(), whole);
  inside_ = true;
  const bool along_x = complete ? box.is_wall(0) : split_x;
  // A box that is complete on this rank has ghosts with data only behind boundaries of the domain.
  const auto inner = [&](int d, int begin, int end) {
    const bool low = !complete || box.touches_low(d), high = !complete || box.touches_high(d);
    return !(low && begin < ghosts[d]) && !(high && end > n[d] - ghosts[d]);
  };
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j) {
      const Span s = span(j, k);
      if (is_empty(s)) continue;
      inside_ = inside_ && (!along_x || inner(0, s.begin, s.end)) && inner(1, j, j + 1) && inner(2, k, k + 1);
    }
  count();
}

Segment OccupiedRows::within(const Segment &row, ConstView value) const noexcept {
  const Segment all = within(row);
  const Span found = occupied(value.row(row.j, row.k), {all.i_begin, all.i_end});
  if (is_empty(found)) return {all.i_begin, all.i_begin, row.j, row.k};
  return {found.begin, found.end, row.j, row.k};
}

void OccupiedRows::count() noexcept {
  const Int3 &n = cells_of_box_;
  cells_ = 0;
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j) {
      const Span s = span(j, k);
      cells_ += std::max(0, std::min(s.end, n[0]) - std::max(s.begin, 0));
    }
}

void OccupiedRows::join(const OccupiedRows &other) {
  for (std::size_t r = 0; r < spans_.size(); ++r) add(other.spans_[r], &spans_[r]);
  inside_ = inside_ && other.inside_;
  count();
}

}  // namespace eulastic
