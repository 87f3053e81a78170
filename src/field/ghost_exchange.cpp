#include "field/ghost_exchange.hpp"

#include "base/events.hpp"
#include "grid/domain.hpp"
#include "grid/threads.hpp"

#include <algorithm>

namespace eulastic {
namespace {

// Offset in a field of the first point in memory, where its first row begins.
std::ptrdiff_t first_offset(const Layout &own) { return own.offset(-own.ghosts[0], -own.ghosts[1], -own.ghosts[2]); }

// Whether no value has to come from elsewhere.
bool is_inside(const WantedGhosts &wanted) { return wanted.rows && wanted.rows->inside(); }

}  // namespace

PetscErrorCode GhostExchange::Unit::make(std::ptrdiff_t values) {
  PetscFunctionBeginUser;
  if (type != MPI_DATATYPE_NULL) PetscFunctionReturn(0);
  PetscCallMPI(MPI_Type_contiguous(static_cast<int>(values), MPIU_REAL, &type));
  PetscCallMPI(MPI_Type_commit(&type));
  PetscFunctionReturn(0);
}

namespace {

// The point that a local point is, or copies.
struct Source {
  PetscInt rank = -1;   // none: behind a side of the domain
  PetscInt offset = 0;  // in the memory there
};

// Memory of a field on another rank.
struct Shape {
  PetscInt size, sy, sz;
};

class SourceFinder {
public:
  explicit SourceFinder(const Domain &domain) : domain_(domain), sources_(domain.layout().size) {}
  PetscErrorCode find() {
    PetscFunctionBeginUser;
    PetscCall(find_near());
    PetscCall(find_shapes());
    if (width_ < domain_.layout().ghosts[0]) {
      PetscCall(find_far());
      PetscCall(find_shapes());
    }
    PetscFunctionReturn(0);
  }
  const Source &at(const Int3 &point) const { return sources_[offset(point)]; }
  /// Of the ranks that sources lie on.
  const std::map<PetscInt, Shape> &shapes() const { return shapes_; }
  bool is_owned(const Int3 &point) const {
    for (int d = 0; d < 3; ++d)
      if (point[d] < 0 || point[d] >= points_[d]) return false;
    return true;
  }
  /// visit(point) for all points in memory: those of the box, and all ghosts.
  template <class Visit>
  void for_all(const Visit &visit) const {
    const Int3 &g = domain_.layout().ghosts;
    for (int k = -g[2]; k < points_[2] + g[2]; ++k)
      for (int j = -g[1]; j < points_[1] + g[1]; ++j)
        for (int i = -g[0]; i < points_[0] + g[0]; ++i) visit({i, j, k});
  }

private:
  PetscInt offset(const Int3 &p) const { return static_cast<PetscInt>(domain_.layout().offset(p[0], p[1], p[2])); }

  // Within the stencil of the DMDA: its scatter from owned to local points brings where the owned ones lie in memory.
  PetscErrorCode find_near() {
    PetscInt first[3], count[3], ghost[3], width[3], roots, leaves;
    VecScatter scatter;
    const PetscInt *places;
    const PetscSFNode *nodes;
    PetscFunctionBeginUser;
    PetscCall(DMDAGetCorners(domain_.dm(), &first[0], &first[1], &first[2], &count[0], &count[1], &count[2]));
    PetscCall(DMDAGetGhostCorners(domain_.dm(), &ghost[0], &ghost[1], &ghost[2], &width[0], &width[1], &width[2]));
    PetscCall(DMDAGetStencilWidth(domain_.dm(), &width_));
    PetscCall(DMDAGetScatter(domain_.dm(), &scatter, nullptr));
    PetscCall(PetscSFGetGraph(scatter, &roots, &leaves, &places, &nodes));
    for (int d = 0; d < 3; ++d) points_[d] = static_cast<int>(count[d]);
    std::vector<PetscInt> mine, found(static_cast<std::size_t>(width[0]) * width[1] * width[2]);
    mine.reserve(roots);
    for (int k = 0; k < points_[2]; ++k)
      for (int j = 0; j < points_[1]; ++j)
        for (int i = 0; i < points_[0]; ++i) mine.push_back(offset({i, j, k}));
    PetscCall(PetscSFBcastBegin(scatter, MPIU_INT, mine.data(), found.data(), MPI_REPLACE));
    PetscCall(PetscSFBcastEnd(scatter, MPIU_INT, mine.data(), found.data(), MPI_REPLACE));
    for (PetscInt l = 0; l < leaves; ++l) {
      const PetscInt place = places ? places[l] : l, row = place / width[0];
      const PetscInt local[3] = {place % width[0], row % width[1], row / width[1]};
      Int3 point;
      for (int d = 0; d < 3; ++d) point[d] = static_cast<int>(ghost[d] + local[d] - first[d]);
      sources_[offset(point)] = {nodes[l].rank, found[place]};
    }
    PetscFunctionReturn(0);
  }

  // Further out, where a rank is narrower than the layers of ghosts: the owner of the outermost point that is known
  // knows those beyond it.
  PetscErrorCode find_far() {
    std::vector<PetscInt> leaves;
    std::vector<PetscSFNode> roots;
    PetscFunctionBeginUser;
    for_all([&](const Int3 &point) {
      Int3 near, beyond;
      for (int d = 0; d < 3; ++d) {
        near[d] = std::clamp<int>(point[d], -width_, points_[d] + width_ - 1);
        beyond[d] = point[d] - near[d];
      }
      const Source &source = at(near);
      if (beyond == Int3{} || source.rank < 0) return;
      const Shape &shape = shapes_.at(source.rank);
      leaves.push_back(offset(point));
      roots.push_back({source.rank, source.offset + beyond[0] + beyond[1] * shape.sy + beyond[2] * shape.sz});
    });
    PetscCall(
        broadcast(MPIU_2INT, static_cast<PetscInt>(sources_.size()), leaves, roots, sources_.data(), sources_.data()));
    PetscFunctionReturn(0);
  }

  PetscErrorCode find_shapes() {
    const Layout &own = domain_.layout();
    const Shape mine{static_cast<PetscInt>(own.size), static_cast<PetscInt>(own.sy), static_cast<PetscInt>(own.sz)};
    std::vector<PetscInt> leaves;
    std::vector<PetscSFNode> roots;
    MPI_Datatype type;
    PetscFunctionBeginUser;
    for (const Source &source : sources_)
      if (source.rank >= 0) shapes_[source.rank] = {};
    for (const auto &[rank, shape] : shapes_) {
      leaves.push_back(static_cast<PetscInt>(leaves.size()));
      roots.push_back({rank, 0});
    }
    std::vector<Shape> found(leaves.size());
    PetscCallMPI(MPI_Type_contiguous(sizeof(Shape) / sizeof(PetscInt), MPIU_INT, &type));
    PetscCallMPI(MPI_Type_commit(&type));
    PetscCall(broadcast(type, 1, leaves, roots, &mine, found.data()));
    PetscCallMPI(MPI_Type_free(&type));
    std::size_t n = 0;
    for (auto &[rank, shape] : shapes_) shape = found[n++];
    PetscFunctionReturn(0);
  }

  PetscErrorCode broadcast(MPI_Datatype type, PetscInt count, std::vector<PetscInt> leaves,
                           std::vector<PetscSFNode> roots, const void *from, void *to) const {
    SfHandle sf;
    PetscFunctionBeginUser;
    PetscCall(PetscSFCreate(domain_.comm(), sf.put()));
    PetscCall(PetscSFSetGraph(sf.get(), count, static_cast<PetscInt>(leaves.size()), leaves.data(), PETSC_COPY_VALUES,
                              roots.data(), PETSC_COPY_VALUES));
    PetscCall(PetscSFBcastBegin(sf.get(), type, from, to, MPI_REPLACE));
    PetscCall(PetscSFBcastEnd(sf.get(), type, from, to, MPI_REPLACE));
    PetscFunctionReturn(0);
  }

  const Domain &domain_;
  std::vector<Source> sources_;  // of all points in memory
  std::map<PetscInt, Shape> shapes_;
  Int3 points_{};       // owned
  PetscInt width_ = 0;  // of the DMDA's stencil
};

}  // namespace

PetscErrorCode GhostList::read(const Domain &domain) {
  SourceFinder finder(domain);
  PetscFunctionBeginUser;
  PetscCall(finder.find());
  finder.for_all([&](const Int3 &point) {
    const Source &source = finder.at(point);
    if (finder.is_owned(point) || source.rank < 0) return;
    ghosts.push_back({point, static_cast<int>(source.rank), source.offset});
  });
  for (const auto &[rank, shape] : finder.shapes()) field_size[static_cast<int>(rank)] = shape.size;
  PetscFunctionReturn(0);
}

// Leaves and roots are the values of all components of a field, or whole rows where x is not split.
PetscErrorCode GhostExchange::build_scatter(int width, int fields, PetscSF *sf) {
  PetscFunctionBeginUser;
  if (!list_) {
    list_ = std::make_unique<GhostList>();
    PetscCall(find_(list_.get()));
  }
  const Layout &own = box_->layout();
  const bool whole_rows = box_->whole_rows();
  const std::ptrdiff_t unit = whole_rows ? own.sy : 1;
  const auto wanted = [&](const Int3 &at) {
    for (int d = whole_rows ? 1 : 0; d < 3; ++d)
      if (at[d] < -width || at[d] >= own.cells[d] + width) return false;
    return !whole_rows || at[0] == 0;
  };
  std::vector<PetscInt> leaves;
  std::vector<PetscSFNode> roots;
  // The unit with the point at an offset of field f. Fields are whole rows, and all ranks have rows of one length where
  // units are rows.
  const auto unit_of = [&](std::ptrdiff_t field_size, int f, std::ptrdiff_t offset) {
    return static_cast<PetscInt>((f * field_size + offset - first_offset(own)) / unit);
  };
  for (int f = 0; f < fields; ++f)
    for (const GhostList::Ghost &ghost : list_->ghosts)
      if (wanted(ghost.at)) {
        leaves.push_back(unit_of(own.size, f, own.offset(ghost.at[0], ghost.at[1], ghost.at[2])));
        roots.push_back({ghost.owner, unit_of(list_->field_size.at(ghost.owner), f, ghost.there)});
      }
  PetscCall(PetscSFCreate(comm_, sf));
  PetscCall(PetscSFSetFromOptions(*sf));
  PetscInt count;
  PetscCall(PetscIntCast(static_cast<PetscInt64>(fields) * own.size / unit, &count));  // an error where it has no room
  PetscCall(PetscSFSetGraph(*sf, count, static_cast<PetscInt>(leaves.size()), leaves.data(), PETSC_COPY_VALUES,
                            roots.data(), PETSC_COPY_VALUES));
  PetscCall(PetscSFSetUp(*sf));
  PetscCall(unit_.make(unit));
  PetscFunctionReturn(0);
}

PetscErrorCode GhostExchange::broadcast(const WantedGhosts &wanted,
                                        PetscErrorCode (*bcast)(PetscSF, MPI_Datatype, const void *, void *, MPI_Op)) {
  PetscFunctionBeginUser;
  Field &field = *wanted.field;
  SfHandle &scatter = scatters_[{wanted.width, field.count()}];
  if (!scatter) PetscCall(build_scatter(wanted.width, field.count(), scatter.put()));
  double *first = field.data() + first_offset(field.layout());
  PetscCall(bcast(scatter.get(), unit_.type, first, first, MPI_REPLACE));
  PetscFunctionReturn(0);
}

PetscErrorCode GhostExchange::begin_update(const WantedGhosts &wanted) {
  PetscFunctionBeginUser;
  if (is_inside(wanted)) PetscFunctionReturn(0);
  VerbScope scope(Verb::exchange);
  PetscCall(broadcast(wanted, PetscSFBcastBegin));
  PetscFunctionReturn(0);
}

PetscErrorCode GhostExchange::end_update(const WantedGhosts &wanted) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::exchange);
  if (!is_inside(wanted)) {
    VerbScope wait(Verb::wait);
    PetscCall(broadcast(wanted, PetscSFBcastEnd));
  }
  wrap_rows(wanted);
  PetscFunctionReturn(0);
}

PetscErrorCode GhostExchange::update_ghosts(const std::vector<WantedGhosts> &wanted) {
  PetscFunctionBeginUser;
  constexpr int most = 6;  // fields: each of them that is under way has buffers of its own, for good
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

// Both ends of rows whose x wraps around. Rows behind walls are left alone: what is there must not depend on whether x
// is split.
void GhostExchange::wrap_rows(const WantedGhosts &wanted) const {
  constexpr int ahead = 8;  // rows: their ends are too far apart for processors to foresee them
  if (!box_->wraps_x() || !wanted.row_ends) return;
  Field &field = *wanted.field;
  const Layout &own = field.layout();
  const int n = own.cells[0], width = std::min(wanted.width, own.ghosts[0]), parts = row_parts(*box_);
  const int layers = is_inside(wanted) ? 0 : width;
  const Box::Range y = box_->points_near(1, true, layers), z = box_->points_near(2, true, layers);
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
