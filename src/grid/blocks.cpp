#include "grid/blocks.hpp"
#include "grid/box.hpp"

namespace eulastic {

HaloOverlap::HaloOverlap(const Box &box) : wraps_x(box.wraps_x()), cells_x(box.cells()[0]) {
  for (int d = 0; d < 3; ++d) {
    wall[d][0] = box.touches_low(d);
    wall[d][1] = box.touches_high(d);
    unextended[d] = d >= box.dimension() || (d == 0 && wraps_x);
  }
}

int StagePass::depth(const Box &box, const Split &split, int least, int most) {
  const HaloOverlap sides(box);
  int depth = least;
  for (int more = least + 1; more <= std::min(most, box.layout().ghosts[0]); ++more) {
    double share = 1;
    for (int d = 0; d < box.dimension(); ++d)
      if (!sides.unextended[d] && (split.parts(d) > 1 || box.boundary(d) == Boundary::periodic))
        share *= 1 + 2.0 * (more - 1) * split.parts(d) / box.domain_cells()[d];
    if (share < 1.25) depth = more;
  }
  return depth;
}

// Every thread needs at least as many slices as the stages leave out at both ends of its part.
int StagePass::threads_of_pass() const {
  const int slices = box_.cells()[box_.dimension() - 1];
  return std::max(1, std::min(row_parts(box_), slices / (2 * depth_)));
}

std::vector<StagePass::Task> StagePass::tasks(int team) const {
  std::vector<Task> tasks;
  for (int f = 0; f < fields_; ++f)
    for (int t = 0; t < team; ++t) {
      const Piece piece(box_.cells()[box_.dimension() - 1], t, team);
      tasks.push_back({t, f, static_cast<int>(piece.begin), static_cast<int>(piece.end), t == 0, t == team - 1});
    }
  return tasks;
}

// Tasks of one stage: the slices that the threads left out between their parts. In 3-D the threads share their rows.
std::vector<StagePass::Task> StagePass::tasks_between(int team, int stage) const {
  const bool flat = box_.dimension() == 2;
  const int layers = first_layers_ - stage, shares = flat ? 1 : team;
  const int first = -sides_.low(1, layers), rows = box_.cells()[1] + sides_.high(1, layers) - first;
  std::vector<Task> tasks;
  for (const Task &lower : this->tasks(team))
    for (int share = 0; share < shares && !lower.high; ++share) {
      const Piece piece(rows, share, shares);
      tasks.push_back({static_cast<int>(tasks.size()) % team, lower.field, lower.end - stage, lower.end + stage, false,
                       false, stage, first + static_cast<int>(piece.begin), first + static_cast<int>(piece.end)});
    }
  return tasks;
}

}  // namespace eulastic
