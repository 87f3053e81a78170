#include "field/ghost_exchange.hpp"

#include "base/events.hpp"
#include "grid/threads.hpp"

#include <algorithm>

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
    if (grid_->wraps_x()) {
      low[0] = 0;
      high[0] = own.cells[0];
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
  PetscCall(forest({block.count(), width}, &sf));
  PetscCall(PetscSFBcastEnd(sf, run_.type, block.data(), block.data(), MPI_REPLACE));
  PetscFunctionReturn(0);
}

// Wraps the rows (j, k) of all fields for which not skip(j, k). Rows behind walls are left alone: what is there must
// not depend on whether x is split.
template <class Skip>
void GhostExchange::wrap_rows(FieldBlock &block, int width, Skip skip) const {
  constexpr int ahead = 8;  // rows: their ends are too far apart for processors to foresee them
  if (!grid_->wraps_x()) return;
  const Layout &own = block.layout();
  const auto first = [&](int d) { return grid_->touches_low(d) ? 0 : -std::min(width, own.ghosts[d]); };
  const auto last = [&](int d) {
    return grid_->touches_high(d) ? grid_->points_end(d, true) : own.cells[d] + std::min(width, own.ghosts[d]);
  };
  const int n = own.cells[0], j_begin = first(1), j_end = last(1), k_begin = first(2), k_end = last(2);
  const int parts = row_parts(*grid_);
  in_parallel(parts, parts, [&](int part) {
    const Piece planes(k_end - k_begin, part, parts);
    for (int f = 0; f < block.count(); ++f)
      for (int k = k_begin + int(planes.begin); k < k_begin + int(planes.end); ++k)
        for (int j = j_begin; j < j_end; ++j) {
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

PetscErrorCode GhostExchange::update(FieldBlock &block, int width, const OccupiedRows *rows) {
  PetscFunctionBeginUser;
  PetscCall(begin(block, width, rows));
  PetscCall(end(block, width, rows));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
