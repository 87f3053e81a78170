#include "field/ghost_exchange.hpp"

#include "base/events.hpp"
#include "grid/threads.hpp"

#include <algorithm>
#include <set>

namespace eulastic {
namespace {

// Position of a point in the memory of its owner.
struct Source {
  PetscInt rank = -1;  // -1: no owner, the point is behind a boundary of the domain
  PetscInt offset = 0;
};

// Of a rank's memory layout.
struct Strides {
  PetscInt size, sy, sz;
};

// `Data` consists of PetscInts.
template <class Data>
PetscErrorCode broadcast_all(PetscSF scatter, const Data *roots, Data *leaves) {
  MpiType type;
  PetscFunctionBeginUser;
  PetscCall(type.create(sizeof(Data) / sizeof(PetscInt), MPIU_INT));
  PetscCall(PetscSFBcastBegin(scatter, type.get(), roots, leaves, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(scatter, type.get(), roots, leaves, MPI_REPLACE));
  PetscFunctionReturn(0);
}

// Broadcasts the positions of the `n` owned points to all points of the DMDA, which are those from near_begin to
// near_end.
PetscErrorCode find_sources(const Domain &domain, PetscSF scatter, const Int3 &n, const Int3 &near_begin,
                            const Int3 &near_end, std::vector<Source> *sources) {
  const Layout &layout = domain.layout();
  std::vector<Source> owned, near;
  PetscFunctionBeginUser;
  owned.reserve(std::size_t(n[0]) * n[1] * n[2]);
  for_points({{0, 0, 0}, n}, [&](int i, int j, int k) {
    owned.push_back({static_cast<PetscInt>(domain.rank()), static_cast<PetscInt>(layout.offset(i, j, k))});
  });
  near.resize(std::size_t(near_end[0] - near_begin[0]) * (near_end[1] - near_begin[1]) * (near_end[2] - near_begin[2]));
  PetscCall(broadcast_all(scatter, owned.data(), near.data()));
  auto next = near.begin();
  for_points({near_begin, near_end}, [&](int i, int j, int k) { (*sources)[layout.offset(i, j, k)] = *next++; });
  PetscFunctionReturn(0);
}

// Asks the owners of `sources` for the strides of their memory.
PetscErrorCode find_strides(const Domain &domain, const std::vector<Source> &sources,
                            std::map<PetscInt, Strides> *strides_of_rank) {
  const Layout &layout = domain.layout();
  const Strides own{static_cast<PetscInt>(layout.size), static_cast<PetscInt>(layout.sy),
                    static_cast<PetscInt>(layout.sz)};
  std::set<PetscInt> ranks;
  std::vector<PetscSFNode> roots;
  SfHandle neighbors;
  PetscFunctionBeginUser;
  for (const Source &source : sources)
    if (source.rank >= 0) ranks.insert(source.rank);
  for (const PetscInt rank : ranks) roots.push_back({rank, 0});
  std::vector<Strides> found(roots.size());
  PetscCall(PetscSFCreate(domain.comm(), neighbors.put()));
  PetscCall(PetscSFSetGraph(neighbors.get(), 1, static_cast<PetscInt>(roots.size()), nullptr, PETSC_COPY_VALUES,
                            roots.data(), PETSC_COPY_VALUES));
  PetscCall(broadcast_all(neighbors.get(), &own, found.data()));
  for (std::size_t n = 0; n < roots.size(); ++n) strides_of_rank->emplace(roots[n].rank, found[n]);
  PetscFunctionReturn(0);
}

// Offset of the first point in the memory of a field, where its first row begins.
std::ptrdiff_t first_offset(const Layout &layout) {
  return layout.offset(-layout.ghosts[0], -layout.ghosts[1], -layout.ghosts[2]);
}

// Whether no ghost has to be received.
bool is_inside(const GhostUpdate &wanted) { return wanted.rows && wanted.rows->inside(); }

}  // namespace

// Broadcasts the memory positions of owned points through the scatter of the DMDA. Where a rank is narrower than the
// ghost width, so is the stencil of the DMDA. Then the owner of the outermost ghost inside the stencil provides the
// positions of the ghosts beyond it, by a second broadcast.
PetscErrorCode find_ghosts(const Domain &domain, std::vector<Ghost> *ghosts) {
  PetscInt first[3], points[3], near_first[3], near_points[3], width;
  VecScatter scatter;
  PetscFunctionBeginUser;
  PetscCall(DMDAGetCorners(domain.dm(), &first[0], &first[1], &first[2], &points[0], &points[1], &points[2]));
  PetscCall(DMDAGetGhostCorners(domain.dm(), &near_first[0], &near_first[1], &near_first[2], &near_points[0],
                                &near_points[1], &near_points[2]));
  PetscCall(DMDAGetStencilWidth(domain.dm(), &width));
  PetscCall(DMDAGetScatter(domain.dm(), &scatter, nullptr));
  const Layout &layout = domain.layout();
  const auto offset = [&layout](const Int3 &p) { return static_cast<PetscInt>(layout.offset(p[0], p[1], p[2])); };
  Int3 n, near_begin, near_end, begin, end;  // of owned points, of points of the DMDA, and of all points in memory
  for (int d = 0; d < 3; ++d) {
    n[d] = static_cast<int>(points[d]);
    near_begin[d] = static_cast<int>(near_first[d] - first[d]);
    near_end[d] = near_begin[d] + static_cast<int>(near_points[d]);
    begin[d] = -layout.ghosts[d];
    end[d] = n[d] + layout.ghosts[d];
  }
  std::vector<Source> sources(layout.size);
  PetscCall(find_sources(domain, scatter, n, near_begin, near_end, &sources));
  std::map<PetscInt, Strides> strides_of_rank;
  PetscCall(find_strides(domain, sources, &strides_of_rank));

  std::vector<PetscInt> leaves;
  std::vector<PetscSFNode> roots;
  for_points({begin, end}, [&](int i, int j, int k) {
    const Int3 p{i, j, k};
    Int3 inner_point;
    for (int d = 0; d < 3; ++d) inner_point[d] = std::clamp<int>(p[d], -width, n[d] + width - 1);
    const Source &source = sources[offset(inner_point)];
    if (inner_point == p || source.rank < 0) return;
    const Strides &strides = strides_of_rank.at(source.rank);
    leaves.push_back(offset(p));
    roots.push_back({source.rank, source.offset + (p[0] - inner_point[0]) + (p[1] - inner_point[1]) * strides.sy +
                                      (p[2] - inner_point[2]) * strides.sz});
  });
  SfHandle outer_ghosts;
  PetscCall(PetscSFCreate(domain.comm(), outer_ghosts.put()));
  PetscCall(PetscSFSetGraph(outer_ghosts.get(), static_cast<PetscInt>(layout.size),
                            static_cast<PetscInt>(leaves.size()), leaves.data(), PETSC_COPY_VALUES, roots.data(),
                            PETSC_COPY_VALUES));
  PetscCall(broadcast_all(outer_ghosts.get(), sources.data(), sources.data()));
  PetscCall(find_strides(domain, sources, &strides_of_rank));  // of the owners that are new

  for_points({begin, end}, [&](int i, int j, int k) {
    const Int3 p{i, j, k};
    const Source &source = sources[offset(p)];
    const bool is_owned = p[0] >= 0 && p[0] < n[0] && p[1] >= 0 && p[1] < n[1] && p[2] >= 0 && p[2] < n[2];
    if (!is_owned && source.rank >= 0)
      ghosts->push_back({p, source.rank, source.offset, strides_of_rank.at(source.rank).size});
  });
  PetscFunctionReturn(0);
}

// Leaves and roots are single values of all components of a field, or whole rows where x is not split.
PetscErrorCode GhostExchange::build_scatter(int width, int fields, PetscSF *sf) {
  PetscFunctionBeginUser;
  if (!ghosts_) PetscCall(find_(&ghosts_.emplace()));
  const Layout &layout = box_->layout();
  const bool whole_rows = box_->whole_rows();
  const std::ptrdiff_t unit = whole_rows ? layout.sy : 1;
  const auto wanted = [&](const Int3 &at) {
    for (int d = whole_rows ? 1 : 0; d < 3; ++d)
      if (at[d] < -width || at[d] >= layout.cells[d] + width) return false;
    return !whole_rows || at[0] == 0;
  };
  std::vector<PetscInt> leaves;
  std::vector<PetscSFNode> roots;
  // Returns the unit that contains the point at an offset of component f. Fields consist of whole rows, and where units
  // are rows, these have the same length on all ranks.
  const auto unit_of = [&](std::ptrdiff_t field_size, int f, std::ptrdiff_t offset) {
    return static_cast<PetscInt>((f * field_size + offset - first_offset(layout)) / unit);
  };
  for (int f = 0; f < fields; ++f)
    for (const Ghost &ghost : *ghosts_)
      if (wanted(ghost.at)) {
        leaves.push_back(unit_of(layout.size, f, layout.offset(ghost.at[0], ghost.at[1], ghost.at[2])));
        roots.push_back({ghost.owner, unit_of(ghost.size, f, ghost.offset)});
      }
  PetscCall(PetscSFCreate(comm_, sf));
  PetscCall(PetscSFSetFromOptions(*sf));
  PetscInt count;
  // an error if the number exceeds PetscInt
  PetscCall(PetscIntCast(static_cast<PetscInt64>(fields) * layout.size / unit, &count));
  PetscCall(PetscSFSetGraph(*sf, count, static_cast<PetscInt>(leaves.size()), leaves.data(), PETSC_COPY_VALUES,
                            roots.data(), PETSC_COPY_VALUES));
  PetscCall(PetscSFSetUp(*sf));
  if (!unit_) PetscCall(unit_.create(unit, MPIU_REAL));
  PetscFunctionReturn(0);
}

PetscErrorCode GhostExchange::broadcast(const GhostUpdate &wanted,
                                        PetscErrorCode (*bcast)(PetscSF, MPI_Datatype, const void *, void *, MPI_Op)) {
  PetscFunctionBeginUser;
  Field &field = *wanted.field;
  SfHandle &scatter = scatters_[{wanted.width, field.count()}];
  if (!scatter) PetscCall(build_scatter(wanted.width, field.count(), scatter.put()));
  double *first = field.data() + first_offset(field.layout());
  PetscCall(bcast(scatter.get(), unit_.get(), first, first, MPI_REPLACE));
  PetscFunctionReturn(0);
}

PetscErrorCode GhostExchange::begin_update(const GhostUpdate &wanted) {
  PetscFunctionBeginUser;
  if (is_inside(wanted)) PetscFunctionReturn(0);
  EventScope scope(Event::exchange);
  PetscCall(broadcast(wanted, PetscSFBcastBegin));
  PetscFunctionReturn(0);
}

PetscErrorCode GhostExchange::end_update(const GhostUpdate &wanted) {
  PetscFunctionBeginUser;
  EventScope scope(Event::exchange);
  if (!is_inside(wanted)) {
    EventScope wait(Event::wait);
    PetscCall(broadcast(wanted, PetscSFBcastEnd));
  }
  wrap_rows(wanted);
  PetscFunctionReturn(0);
}

PetscErrorCode GhostExchange::update_ghosts(const std::vector<GhostUpdate> &wanted) {
  PetscFunctionBeginUser;
  constexpr int most = 6;  // components: every field under way keeps buffers of its own for the rest of the run
  for (auto first = wanted.begin(), last = first; first != wanted.end();) {
    for (int fields = 0; last != wanted.end() && (fields == 0 || fields + last->field->count() <= most); ++last) {
      fields += last->field->count();
      PetscCall(begin_update(*last));
    }
    for (; first != last; ++first) PetscCall(end_update(*first));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode GhostExchange::update_ghosts(Field &field, int width, const OccupiedRows *rows) {
  PetscFunctionBeginUser;
  PetscCall(begin_update({&field, width, rows}));
  PetscCall(end_update({&field, width, rows}));
  PetscFunctionReturn(0);
}

// Fills both ends of rows if x is periodic and not split. Rows behind walls are not changed: their values must not
// depend on whether x is split.
void GhostExchange::wrap_rows(const GhostUpdate &wanted) const {
  constexpr int ahead = 8;  // rows: hardware prefetchers do not detect accesses to the ends of rows
  if (!box_->wraps_x() || !wanted.row_ends) return;
  Field &field = *wanted.field;
  const Layout &layout = field.layout();
  const int n = layout.cells[0], width = std::min(wanted.width, layout.ghosts[0]), parts = row_parts(*box_);
  const int layers = is_inside(wanted) ? 0 : width;
  const Box::Range y = box_->points_with_ghosts(1, true, layers), z = box_->points_with_ghosts(2, true, layers);
  in_parallel(parts, parts, [&](int part) {
    const Piece planes(z.end - z.begin, part, parts);
    for (int f = 0; f < field.count(); ++f)
      for (int k = z.begin + int(planes.begin); k < z.begin + int(planes.end); ++k)
        for (int j = y.begin; j < y.end; ++j) {
          if (wanted.rows) {
            const OccupiedRows::Span span = wanted.rows->span(j, k);
            if (span.begin >= span.end || (span.begin >= width && span.end <= n - width)) continue;
          }
          double *row = field[f].row(j, k);
          const double *later = row + ahead * layout.sy;
          for (const int i : {-1, 0, n - 1, n}) __builtin_prefetch(later + i, 1);
          for (int m = 1; m <= width; ++m) {
            row[-m] = row[n - m];
            row[n - 1 + m] = row[m - 1];
          }
        }
  });
}

}  // namespace eulastic
