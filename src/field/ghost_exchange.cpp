#include "field/ghost_exchange.hpp"

#include "base/events.hpp"
#include "grid/domain.hpp"
#include "grid/threads.hpp"

#include <algorithm>

namespace eulastic {
namespace {

// A point along one direction: its local index here, and at the place among the ranks that owns it.
struct Point {
  int here, place, there;
};

// The points of this rank along d with `ghosts` layers, but those behind walls.
std::vector<Point> points_along(const Domain &domain, int d, int ghosts) {
  const int n = domain.domain_cells()[d], begin = domain.layout().begin[d], cells = domain.cells()[d];
  std::vector<Point> points;
  for (int i = -ghosts; i < cells + ghosts; ++i) {
    if (domain.is_wall(d) && (begin + i < 0 || begin + i > n)) continue;
    const int image = domain.image(d, begin + i), place = domain.owner_along(d, image);
    points.push_back({i, place, image - domain.first_cell(d, place)});
  }
  return points;
}

// Offset in a field of the first point in memory, where its first row begins.
std::ptrdiff_t first_offset(const Layout &own) { return own.offset(-own.ghosts[0], -own.ghosts[1], -own.ghosts[2]); }

// Whether there is nothing to bring.
bool is_inside(const WantedGhosts &wanted) { return wanted.rows && wanted.rows->inside(); }

}  // namespace

PetscErrorCode GhostExchange::Unit::make(std::ptrdiff_t values) {
  PetscFunctionBeginUser;
  if (type != MPI_DATATYPE_NULL) PetscFunctionReturn(0);
  PetscCallMPI(MPI_Type_contiguous(static_cast<int>(values), MPIU_REAL, &type));
  PetscCallMPI(MPI_Type_commit(&type));
  PetscFunctionReturn(0);
}

PetscErrorCode GhostExchange::make_forest(int width, int fields, const GhostPieces *pieces, PetscSF *sf) {
  PetscFunctionBeginUser;
  const Layout &own = domain_->layout();
  const std::ptrdiff_t unit = pieces ? GhostPieces::cells : by_rows() ? own.sy : 1;
  std::vector<Point> points[3];
  for (int d = 0; d < 3; ++d) points[d] = points_along(*domain_, d, std::min(width, own.ghosts[d]));
  if (pieces) {
    points[0].clear();
    for (int m = 0; m < pieces->count(); ++m) points[0].push_back({GhostPieces::cells * m, 0, GhostPieces::cells * m});
  } else if (by_rows()) {
    points[0] = {{-own.ghosts[0], 0, -own.ghosts[0]}};
  }
  if (domain_->cell_count() == 0) points[2].clear();  // nothing is around no cells
  std::vector<PetscInt> leaves;
  std::vector<PetscSFNode> roots;
  const auto place_in = [&](const Layout &layout, int f, const Int3 &point) {
    const std::ptrdiff_t offset = layout.offset(point[0], point[1], point[2]) - (pieces ? 0 : first_offset(layout));
    return static_cast<PetscInt>((f * static_cast<std::ptrdiff_t>(layout.size) + offset) / unit);
  };
  for (int f = 0; f < fields; ++f)
    for (const Point &z : points[2])
      for (const Point &y : points[1])
        for (const Point &x : points[0]) {
          const int rank = domain_->rank_at({x.place, y.place, z.place});
          const PetscInt leaf = place_in(own, f, {x.here, y.here, z.here}),
                         root = place_in(domain_->layout_of(rank), f, {x.there, y.there, z.there});
          if (rank == domain_->rank() && root == leaf) continue;  // owned
          if (pieces && !pieces->holds(y.here, z.here, x.here / GhostPieces::cells)) continue;
          leaves.push_back(leaf);
          roots.push_back({rank, root});
        }
  PetscCall(PetscSFCreate(domain_->comm(), sf));
  PetscCall(PetscSFSetFromOptions(*sf));
  PetscInt count;
  PetscCall(PetscIntCast(static_cast<PetscInt64>(fields) * own.size / unit, &count));  // an error where it has no room
  PetscCall(PetscSFSetGraph(*sf, count, static_cast<PetscInt>(leaves.size()), leaves.data(), PETSC_COPY_VALUES,
                            roots.data(), PETSC_COPY_VALUES));
  PetscCall(PetscSFSetUp(*sf));
  PetscCall((pieces ? piece_ : unit_).make(unit));
  PetscFunctionReturn(0);
}

PetscErrorCode GhostExchange::bring(const WantedGhosts &wanted,
                                    PetscErrorCode (*bcast)(PetscSF, MPI_Datatype, const void *, void *, MPI_Op)) {
  PetscFunctionBeginUser;
  FieldBlock &block = *wanted.block;
  const GhostPieces *pieces = wanted.pieces();
  SfHandle &forest = (pieces ? pieces->forests : forests_)[{wanted.width, block.count()}];
  if (!forest) PetscCall(make_forest(wanted.width, block.count(), pieces, forest.put()));
  double *first = block.data() + (pieces ? 0 : first_offset(block.layout()));
  PetscCall(bcast(forest.get(), (pieces ? piece_ : unit_).type, first, first, MPI_REPLACE));
  PetscFunctionReturn(0);
}

PetscErrorCode GhostExchange::begin(const WantedGhosts &wanted) {
  PetscFunctionBeginUser;
  if (is_inside(wanted)) PetscFunctionReturn(0);
  VerbScope scope(Verb::exchange);
  PetscCall(bring(wanted, PetscSFBcastBegin));
  PetscFunctionReturn(0);
}

PetscErrorCode GhostExchange::end(const WantedGhosts &wanted) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::exchange);
  if (!is_inside(wanted)) {
    VerbScope wait(Verb::wait);
    PetscCall(bring(wanted, PetscSFBcastEnd));
  }
  wrap_rows(wanted);
  PetscFunctionReturn(0);
}

PetscErrorCode GhostExchange::update(const std::vector<WantedGhosts> &wanted) {
  PetscFunctionBeginUser;
  constexpr int most = 6;  // fields: each of them that is under way has buffers of its own, for good
  for (auto first = wanted.begin(), last = first; first != wanted.end();) {
    for (int fields = 0; last != wanted.end() && (fields == 0 || fields + last->block->count() <= most); ++last) {
      fields += last->block->count();
      PetscCall(begin(*last));
    }
    for (; first != last; ++first) PetscCall(end(*first));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode GhostExchange::update(FieldBlock &block, int width, const OccupiedRows *rows) {
  PetscFunctionBeginUser;
  PetscCall(begin({&block, width, rows}));
  PetscCall(end({&block, width, rows}));
  PetscFunctionReturn(0);
}

// Both ends of rows whose x wraps around. Rows behind walls are left alone: what is there must not depend on whether x
// is split.
void GhostExchange::wrap_rows(const WantedGhosts &wanted) const {
  constexpr int ahead = 8;  // rows: their ends are too far apart for processors to foresee them
  if (!domain_->wraps_x() || !wanted.row_ends) return;
  FieldBlock &block = *wanted.block;
  const Layout &own = block.layout();
  const int n = own.cells[0], width = std::min(wanted.width, own.ghosts[0]), parts = row_parts(*domain_);
  const int layers = is_inside(wanted) ? 0 : width;
  const GhostPieces *pieces = wanted.pieces();
  const Box::Range y = domain_->points_near(1, true, layers), z = domain_->points_near(2, true, layers);
  in_parallel(parts, parts, [&](int part) {
    const Piece planes(z.end - z.begin, part, parts);
    for (int f = 0; f < block.count(); ++f)
      for (int k = z.begin + int(planes.begin); k < z.begin + int(planes.end); ++k)
        for (int j = y.begin; j < y.end; ++j) {
          if (pieces) {
            if (!pieces->holds_ends(j, k)) continue;
          } else if (wanted.rows) {
            const OccupiedRows::Span span = wanted.rows->span(j, k);
            if (span.begin >= span.end || (span.begin >= width && span.end <= n - width)) continue;
          }
          double *row = block[f].row(j, k);
          const double *later = row + ahead * own.sy;
          for (const int i : {-1, 0, n - 1, n}) __builtin_prefetch(later + i, 1);
          for (int m = 1; m <= width; ++m) {
            row[-m] = row[n - m];
            row[n - 1 + m] = row[m - 1];
          }
        }
  });
}

}  // namespace eulastic
