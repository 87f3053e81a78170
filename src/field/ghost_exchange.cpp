#include "field/ghost_exchange.hpp"

#include "base/events.hpp"
#include "grid/threads.hpp"

#include <algorithm>
#include <cstring>

namespace eulastic {
namespace {

constexpr std::ptrdiff_t least_piece = 4096;  // values of a plane: two copies of them take longer than another message

}  // namespace

std::size_t GhostExchange::Box::points() const {
  std::size_t count = 1;
  for (int d = 0; d < 3; ++d) count *= end[d] - begin[d];
  return count;
}

/// Points along one direction that follow each other here and where they come from.
struct GhostExchange::Stretch {
  int owner;       ///< its place
  int here, from;  ///< first index here, and there
  int length;
  bool owned;  ///< not ghosts
};

// What the ranks at a place along d hold there.
std::vector<GhostExchange::Stretch> GhostExchange::stretches(int d, int place, int width) const {
  const int n = grid_->cells()[d], begin = grid_->first_cell(d, place), cells = grid_->first_cell(d, place + 1) - begin;
  const bool wall = grid_->is_wall(d), high_wall = wall && begin + cells == n && cells > 0;
  const int owned = cells + high_wall, ghosts = is_copied(d) ? 0 : std::min(width, grid_->layout().ghosts[d]);
  std::vector<Stretch> found;
  if (owned > 0) found.push_back({place, 0, 0, owned, true});
  for (int i = -ghosts; i < cells + ghosts; ++i) {
    if (i >= 0 && i < owned) continue;
    const int global = begin + i;
    if (wall && (global < 0 || global > n)) continue;  // behind it
    const int image = wall ? global : (global % n + n) % n;
    const int owner = grid_->owner_along(d, image), from = image - grid_->first_cell(d, owner);
    const Stretch *last = found.empty() ? nullptr : &found.back();
    if (last && !last->owned && last->owner == owner && last->here + last->length == i &&
        last->from + last->length == from)
      ++found.back().length;
    else
      found.push_back({owner, i, from, 1, false});
  }
  return found;
}

const GhostExchange::Plan &GhostExchange::plan(int width) {
  const auto [at, made] = plans_.try_emplace(width);
  Plan &plan = at->second;
  if (!made) return plan;
  struct Part : Stretch {
    int other;  // the place of whom it comes from or goes to
  };
  // Between two ranks messages are in the order of the stretches of whom they go to, here and there.
  std::vector<Part> received[3], sent[3];
  const Int3 here = grid_->place_of(grid_->rank());
  for (int d = 0; d < 3; ++d)
    for (int place = 0; place < grid_->processors(d); ++place)
      for (const Stretch &s : stretches(d, place, width)) {
        if (place == here[d]) received[d].push_back({s, s.owner});
        if (s.owner == here[d]) sent[d].push_back({s, place});
      }
  const auto make = [&](const std::vector<Part>(&parts)[3], bool there) {
    std::vector<Message> messages;
    for (const Part &z : parts[2])
      for (const Part &y : parts[1])
        for (const Part &x : parts[0]) {
          if (x.owned && y.owned && z.owned) continue;
          Message m{grid_->rank_at({x.other, y.other, z.other}), {}, 0};
          m.box.begin = there ? Int3{x.from, y.from, z.from} : Int3{x.here, y.here, z.here};
          m.box.end = {m.box.begin[0] + x.length, m.box.begin[1] + y.length, m.box.begin[2] + z.length};
          const std::ptrdiff_t piece = (y.length - 1) * grid_->layout().sy + x.length;
          if (grid_->processors(0) == 1 && piece >= least_piece) m.piece = static_cast<int>(piece);
          messages.push_back(m);
        }
    return messages;
  };
  plan.received = make(received, false);
  plan.sent = make(sent, true);
  return plan;
}

std::size_t GhostExchange::copied_values(int fields, const std::vector<Message> &messages) {
  std::size_t count = 0;
  for (const Message &m : messages)
    if (m.piece == 0) count += fields * m.box.points();
  return count;
}

// post(values, count, message) for all that goes or comes by itself.
template <class Post>
PetscErrorCode GhostExchange::post_all(FieldBlock &block, const std::vector<Message> &messages, double *copies,
                                       const Post &post) const {
  PetscFunctionBeginUser;
  for (const Message &m : messages) {
    const Int3 &begin = m.box.begin;
    if (m.piece == 0) {
      const int count = static_cast<int>(m.box.points()) * block.count();
      PetscCallMPI(post(copies, count, m));
      copies += count;
      continue;
    }
    for (int f = 0; f < block.count(); ++f)
      for (int k = begin[2]; k < m.box.end[2]; ++k) PetscCallMPI(post(&block[f](begin[0], begin[1], k), m.piece, m));
  }
  PetscFunctionReturn(0);
}

// copy(row in the block, row in the copies, length) for all rows that are copied.
template <class Copy>
void GhostExchange::for_rows(FieldBlock &block, const std::vector<Message> &messages, double *copies,
                             const Copy &copy) const {
  const int parts = row_parts(*grid_);
  for (const Message &m : messages) {
    if (m.piece > 0) continue;
    const Int3 &begin = m.box.begin;
    const std::size_t nx = m.box.end[0] - begin[0], ny = m.box.end[1] - begin[1], nz = m.box.end[2] - begin[2];
    in_parallel(parts, parts, [&](int part) {
      const Piece planes(nz * block.count(), part, parts);
      for (std::size_t p = planes.begin; p < planes.end; ++p)
        for (std::size_t j = 0; j < ny; ++j)
          copy(&block[int(p / nz)](begin[0], begin[1] + int(j), begin[2] + int(p % nz)), copies + (p * ny + j) * nx,
               nx * sizeof(double));
    });
    copies += m.box.points() * block.count();
  }
}

PetscErrorCode GhostExchange::begin(FieldBlock &block, int width, const OccupiedRows *rows) {
  PetscFunctionBeginUser;
  if (rows && rows->inside()) PetscFunctionReturn(0);
  if (grid_->ranks() == 1) PetscFunctionReturn(0);
  VerbScope scope(Verb::exchange);
  if (comm_.comm == MPI_COMM_NULL) PetscCallMPI(MPI_Comm_dup(grid_->comm(), &comm_.comm));
  const Plan &plan = this->plan(width);
  UnderWay &way = under_way(nullptr);
  way.block = block.data();
  way.received.resize(copied_values(block.count(), plan.received));
  way.sent.resize(copied_values(block.count(), plan.sent));
  way.requests.clear();
  const auto request = [&way] { return &way.requests.emplace_back(); };
  PetscCall(post_all(block, plan.received, way.received.data(), [&](double *values, int count, const Message &m) {
    return MPI_Irecv(values, count, MPI_DOUBLE, m.rank, 0, comm_.comm, request());
  }));
  for_rows(block, plan.sent, way.sent.data(),
           [](const double *row, double *copy, std::size_t bytes) { std::memcpy(copy, row, bytes); });
  PetscCall(post_all(block, plan.sent, way.sent.data(), [&](const double *values, int count, const Message &m) {
    return MPI_Isend(values, count, MPI_DOUBLE, m.rank, 0, comm_.comm, request());
  }));
  PetscFunctionReturn(0);
}

PetscErrorCode GhostExchange::end_rows(FieldBlock &block, int width, const OccupiedRows *rows) {
  PetscFunctionBeginUser;
  if (rows && rows->inside()) PetscFunctionReturn(0);
  VerbScope scope(Verb::exchange);
  if (grid_->ranks() > 1) {
    UnderWay &way = under_way(block.data());
    {
      VerbScope wait(Verb::wait);
      PetscCallMPI(MPI_Waitall(static_cast<int>(way.requests.size()), way.requests.data(), MPI_STATUSES_IGNORE));
    }
    for_rows(block, plan(width).received, way.received.data(),
             [](double *row, const double *copy, std::size_t bytes) { std::memcpy(row, copy, bytes); });
    way.block = nullptr;
  }
  copy_rows(block, width);
  PetscFunctionReturn(0);
}

// That of a block; of null a free one.
GhostExchange::UnderWay &GhostExchange::under_way(const double *block) {
  for (const auto &way : under_way_)
    if (way->block == block) return *way;
  under_way_.push_back(std::make_unique<UnderWay>());
  return *under_way_.back();
}

bool GhostExchange::is_copied(int d) const {
  return d < grid_->dimension() && grid_->boundary(d) == Boundary::periodic && grid_->processors(d) == 1;
}

// Ghost rows across a periodic y and z that are not split: y first, in the planes that z takes its own from.
void GhostExchange::copy_rows(FieldBlock &block, int width) const {
  const Int3 &n = block.layout().cells;
  const Grid::Range x = is_copied(0) ? Grid::Range{0, n[0]} : grid_->points_near(0, true, width),
                    y = grid_->points_near(1, true, width);
  const Grid::Range z = is_copied(2) ? Grid::Range{0, n[2]} : grid_->points_near(2, true, width);
  const std::size_t bytes = sizeof(double) * (x.end - x.begin);
  const int parts = row_parts(*grid_);
  const auto copy = [&](int d, View q, int j, int k) {  // from one end of the line of rows to the other, layer by layer
    double *low = q.row(j, k) + x.begin;
    const std::ptrdiff_t s = q.stride(d), last = (n[d] - 1) * s;
    for (int m = 1; m <= std::min(width, block.layout().ghosts[d]); ++m) {
      std::memcpy(low - m * s, low + last - (m - 1) * s, bytes);
      std::memcpy(low + last + m * s, low + (m - 1) * s, bytes);
    }
  };
  const auto copy_all = [&](int d, const Grid::Range &lines) {
    in_parallel(parts, parts, [&](int part) {
      const Piece piece(lines.end - lines.begin, part, parts);
      for (int f = 0; f < block.count(); ++f)
        for (std::size_t line = piece.begin; line < piece.end; ++line) {
          const int at = lines.begin + static_cast<int>(line);
          copy(d, block[f], d == 1 ? 0 : at, d == 1 ? at : 0);
        }
    });
  };
  if (is_copied(1)) copy_all(1, z);
  if (is_copied(2)) copy_all(2, y);
}

// Wraps the rows (j, k) of all fields for which not skip(j, k). Rows behind walls are left alone: what is there must
// not depend on whether x is split.
template <class Skip>
void GhostExchange::wrap_rows(FieldBlock &block, int width, Skip skip) const {
  constexpr int ahead = 8;  // rows: their ends are too far apart for processors to foresee them
  if (!grid_->wraps_x()) return;
  const Layout &own = block.layout();
  const Grid::Range y = grid_->points_near(1, true, width), z = grid_->points_near(2, true, width);
  const int n = own.cells[0];
  const int parts = row_parts(*grid_);
  in_parallel(parts, parts, [&](int part) {
    const Piece planes(z.end - z.begin, part, parts);
    for (int f = 0; f < block.count(); ++f)
      for (int k = z.begin + int(planes.begin); k < z.begin + int(planes.end); ++k)
        for (int j = y.begin; j < y.end; ++j) {
          if (skip(j, k)) continue;
          double *row = block[f].row(j, k);
          const double *later = row + ahead * own.sy;
          for (const int i : {-1, 0, n - 1, n}) __builtin_prefetch(later + i, 1);
          grid_->wrap_row(row, width);
        }
  });
}

PetscErrorCode GhostExchange::end(FieldBlock &block, int width, const OccupiedRows *rows) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::exchange);
  PetscCall(end_rows(block, width, rows));
  wrap_rows(block, width, [rows](int j, int k) { return rows && rows->idle(j, k); });
  PetscFunctionReturn(0);
}

PetscErrorCode GhostExchange::update_wrapped(FieldBlock &block, int width, const OccupiedRows *rows) {
  PetscFunctionBeginUser;
  if (rows && rows->inside()) PetscFunctionReturn(0);
  VerbScope scope(Verb::exchange);
  PetscCall(update_rows(block, width));
  const Int3 &n = block.layout().cells;
  wrap_rows(block, width, [&n](int j, int k) { return j >= 0 && j < n[1] && k >= 0 && k < n[2]; });
  PetscFunctionReturn(0);
}

PetscErrorCode GhostExchange::update_rows(FieldBlock &block, int width) {
  PetscFunctionBeginUser;
  PetscCall(begin(block, width));
  PetscCall(end_rows(block, width, nullptr));
  PetscFunctionReturn(0);
}

PetscErrorCode GhostExchange::update_rows(FieldBlock &first, int first_width, FieldBlock &second, int second_width) {
  PetscFunctionBeginUser;
  PetscCall(begin(first, first_width));
  PetscCall(begin(second, second_width));
  PetscCall(end_rows(first, first_width, nullptr));
  PetscCall(end_rows(second, second_width, nullptr));
  PetscFunctionReturn(0);
}

PetscErrorCode GhostExchange::update(FieldBlock &block, int width, const OccupiedRows *rows) {
  PetscFunctionBeginUser;
  PetscCall(begin(block, width, rows));
  PetscCall(end(block, width, rows));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
