#include "field/ghost_exchange.hpp"

#include "base/events.hpp"
#include "grid/threads.hpp"

#include <algorithm>
#include <cstring>

namespace eulastic {
namespace {

// Periodic image of global index g, or -1 where nothing lives there (behind a wall).
int image(const Grid &grid, int d, int g) {
  const int n = grid.cells()[d];
  if (d >= grid.dimension()) return g;
  if (grid.boundary(d) == Boundary::periodic) return ((g % n) + n) % n;
  return g >= 0 && g <= n ? g : -1;
}

}  // namespace

// Rows begin on a line of the cache, in every block. PETSc compares types at every exchange, which takes a microsecond:
// runs are for boxes whose tables are large.
PetscErrorCode GhostExchange::make_run() {
  PetscFunctionBeginUser;
  if (run_.length > 0) PetscFunctionReturn(0);
  const bool large = grid_->dimension() == 3 && grid_->cell_count() >= 32768.0 * grid_->ranks();
  int length = grid_->wraps_x() && large ? 8 : 1;
  while (grid_->cells()[0] % length != 0) length /= 2;
  run_.type = MPIU_REAL;
  if (length > 1) {
    PetscCallMPI(MPI_Type_contiguous(length, MPIU_REAL, &run_.type));
    PetscCallMPI(MPI_Type_commit(&run_.type));
  }
  run_.length = length;
  PetscFunctionReturn(0);
}

PetscErrorCode GhostExchange::forest(const Key &key, PetscSF *sf) {
  PetscFunctionBeginUser;
  SfHandle &handle = forests_[key];
  if (!handle) {
    PetscCall(make_run());
    const int run = run_.length;
    const Layout &own = grid_->layout();
    Int3 low{}, high{};
    for (int d = 0; d < 3; ++d) {
      const int width = std::min(key.width, own.ghosts[d]);
      low[d] = -width;
      high[d] = own.cells[d] + width;
    }
    for (int d = 0; d < 3; ++d)
      if (is_copied(d)) {
        low[d] = 0;
        high[d] = own.cells[d];
      }
    std::vector<PetscInt> leaves;
    std::vector<PetscSFNode> roots;
    for (int k = low[2]; k < high[2]; ++k)
      for (int j = low[1]; j < high[1]; ++j)
        for (int i = low[0]; i < high[0]; i += run) {
          const Int3 local{i, j, k};
          Int3 global{};
          bool inside = true, exists = true;
          for (int d = 0; d < 3; ++d) {
            global[d] = image(*grid_, d, own.begin[d] + local[d]);
            exists &= global[d] >= 0;
            inside &= local[d] >= 0 && local[d] < grid_->points_end(d, true);
          }
          if (inside || !exists) continue;
          const int owner = grid_->owner(global[0], global[1], global[2]);
          const Layout theirs = grid_->layout_of(owner);
          const std::ptrdiff_t from =
              theirs.offset(global[0] - theirs.begin[0], global[1] - theirs.begin[1], global[2] - theirs.begin[2]);
          for (int f = 0; f < key.fields; ++f) {
            leaves.push_back(static_cast<PetscInt>((own.offset(i, j, k) + f * own.size) / run));
            roots.push_back({owner, static_cast<PetscInt>((from + f * theirs.size) / run)});
          }
        }
    PetscCall(PetscSFCreate(grid_->comm(), handle.put()));
    PetscCall(PetscSFSetGraph(handle.get(), static_cast<PetscInt>(own.size * key.fields / run),
                              static_cast<PetscInt>(leaves.size()), leaves.data(), PETSC_COPY_VALUES, roots.data(),
                              PETSC_COPY_VALUES));
    PetscCall(PetscSFSetUp(handle.get()));
  }
  *sf = handle.get();
  PetscFunctionReturn(0);
}

PetscErrorCode GhostExchange::begin(FieldBlock &block, int width, const OccupiedRows *rows) {
  PetscSF sf;
  PetscFunctionBeginUser;
  if (rows && rows->inside()) PetscFunctionReturn(0);
  if (grid_->ranks() == 1) PetscFunctionReturn(0);
  VerbScope scope(Verb::exchange);
  PetscCall(forest({block.count(), width}, &sf));
  PetscCall(PetscSFBcastBegin(sf, run_.type, block.data(), block.data(), MPI_REPLACE));
  PetscFunctionReturn(0);
}

PetscErrorCode GhostExchange::end_rows(FieldBlock &block, int width, const OccupiedRows *rows) {
  PetscSF sf;
  PetscFunctionBeginUser;
  if (rows && rows->inside()) PetscFunctionReturn(0);
  VerbScope scope(Verb::exchange);
  if (grid_->ranks() > 1) {
    PetscCall(forest({block.count(), width}, &sf));
    PetscCall(PetscSFBcastEnd(sf, run_.type, block.data(), block.data(), MPI_REPLACE));
  }
  copy_rows(block, width);
  PetscFunctionReturn(0);
}

bool GhostExchange::is_copied(int d) const {
  return d < grid_->dimension() && grid_->boundary(d) == Boundary::periodic && grid_->processors(d) == 1;
}

// Points along d that exist, `width` ghosts included where there are any.
GhostExchange::Range GhostExchange::reach(int d, int width) const {
  const Layout &own = grid_->layout();
  const int ghosts = std::min(width, own.ghosts[d]);
  Range range{-ghosts, own.cells[d] + ghosts};
  if (grid_->is_wall(d))
    range = {std::max(range.begin, -own.begin[d]), std::min(range.end, grid_->cells()[d] + 1 - own.begin[d])};
  return range;
}

// Ghost rows across a periodic y and z that are not split: y first, in the planes that z takes its own from.
void GhostExchange::copy_rows(FieldBlock &block, int width) const {
  const Int3 &n = block.layout().cells;
  const Range x = is_copied(0) ? Range{0, n[0]} : reach(0, width), y = reach(1, width);
  const Range z = is_copied(2) ? Range{0, n[2]} : reach(2, width);
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
  const auto copy_all = [&](int d, const Range &lines) {
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
  const Range y = reach(1, width), z = reach(2, width);
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
