#include "pressure/partition.hpp"

#include <algorithm>

namespace eulastic {
namespace {

// A point along one direction: its local index, the position of its owner among the ranks, and its local index there.
struct Point {
  int local, position, owner_local;
};

// The points of a box along d with all ghosts, except for those behind boundaries of the domain.
std::vector<Point> points_along(const Box &box, const Split &split, int d) {
  const int N = box.domain_cells()[d], begin = box.layout().begin[d], ghosts = box.layout().ghosts[d];
  std::vector<Point> points;
  for (int i = -ghosts; i < box.cells()[d] + ghosts; ++i) {
    if (box.is_wall(d) && (begin + i < 0 || begin + i > N)) continue;
    const int image = box.image(d, begin + i), position = split.position_along(d, image);
    points.push_back({i, position, image - split.starts[d][position]});
  }
  return points;
}

}  // namespace

Partition::Partition(const Domain &domain, const ZeroSides &zero)
    : comm_(domain.comm()), rank_(domain.rank()), ranks_(domain.ranks()), split_(domain.split()), box_(domain) {
  if (zero == domain.domain_shape().open) return;
  DomainShape shape = domain.domain_shape();
  shape.open = zero;
  set_box(shape, shape.cells);
}

void Partition::set_box(DomainShape shape, const Int3 &cells) {
  shape.cells = cells;
  box_ = split_.box_of(rank_, shape, box_.layout().ghosts[0]);
}

Partition Partition::coarse(const Int3 &cells) const {
  Partition result = *this;
  for (int d = 0; d < 3; ++d) {
    if (cells[d] == box_.domain_cells()[d]) continue;
    std::vector<int> &starts = result.split_.starts[d];
    for (int &start : starts) start = std::min(cells[d], (start + 1) / 2);
    starts.back() = cells[d];
  }
  result.set_box(box_.domain_shape(), cells);
  return result;
}

Partition Partition::joined(const std::array<bool, 3> &along) const {
  Partition result = *this;
  for (int d = 0; d < 3; ++d) {
    if (!along[d]) continue;
    std::vector<int> &starts = result.split_.starts[d], holders;
    for (int p = 0; p < split_.parts(d); ++p)
      if (split_.cells_along(d, p) > 0) holders.push_back(p);
    std::vector<bool> stays(split_.parts(d), false);
    for (std::size_t m = 0; m + 1 < holders.size(); m += 2) stays[holders[m]] = true;
    for (int p = split_.parts(d) - 1; p >= 0; --p)
      if (!stays[p]) starts[p] = starts[p + 1];
  }
  result.set_box(box_.domain_shape(), box_.domain_cells());
  return result;
}

Partition Partition::everywhere() const {
  Partition result = *this;
  result.comm_ = PETSC_COMM_SELF;
  result.rank_ = 0;
  result.ranks_ = 1;
  for (int d = 0; d < 3; ++d) result.split_.starts[d] = {0, box_.domain_cells()[d]};
  result.set_box(box_.domain_shape(), box_.domain_cells());
  return result;
}

std::vector<Ghost> Partition::ghosts() const {
  std::vector<Ghost> ghosts;
  if (box_.cell_count() == 0) return ghosts;
  const Int3 &n = box_.cells();
  const std::vector<Point> x = points_along(box_, split_, 0), y = points_along(box_, split_, 1),
                           z = points_along(box_, split_, 2);
  for (const Point &k : z)
    for (const Point &j : y)
      for (const Point &i : x) {
        const Int3 at{i.local, j.local, k.local};
        if (at[0] >= 0 && at[0] < n[0] && at[1] >= 0 && at[1] < n[1] && at[2] >= 0 && at[2] < n[2]) continue;
        const int owner = split_.rank_at({i.position, j.position, k.position});
        const Box box = split_.box_of(owner, box_.domain_shape(), box_.layout().ghosts[0]);
        // The point N of a direction with boundaries is its own owner's.
        if (owner == rank_ && at == Int3{i.owner_local, j.owner_local, k.owner_local}) continue;
        const Layout &theirs = box.layout();
        ghosts.push_back({at, owner, static_cast<PetscInt>(theirs.offset(i.owner_local, j.owner_local, k.owner_local)),
                          static_cast<PetscInt>(theirs.size)});
      }
  return ghosts;
}

}  // namespace eulastic
