#include "pressure/multigrid_level.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

// Half the number of cells. The last cell stays between half and twice as wide as the others, and the number is even if
// possible. Beside an open boundary the last cell is never narrow: its coupling to the boundary would be too stiff for
// the relaxation steps.
int halved(int cells, bool last_is_narrow, bool open_high) {
  const int rounded_up = (cells + 1) / 2;
  if (cells % 2 == 0 || cells == 1) return rounded_up;
  return rounded_up % 2 == 0 && !last_is_narrow && !open_high ? rounded_up : cells / 2;
}

int parent_of(int cell, int stride, int coarse_cells) { return std::min(cell / stride, coarse_cells - 1); }

constexpr int reach = LineOf<int>::layers;

// Periodic image of global cell g.
int image(int g, int cells) { return (g % cells + cells) % cells; }

// Directions shared by several ranks in which one of them would have fewer than two cells of the coarse level.
std::array<bool, 3> thin_directions(const Split &fine, const Split &coarse) {
  std::array<bool, 3> thin{};
  for (int d = 0; d < 3; ++d) {
    int holders = 0, least = coarse.starts[d].back();
    for (int p = 0; p < fine.parts(d); ++p) {
      if (fine.cells_along(d, p) == 0) continue;
      ++holders;
      least = std::min(least, coarse.cells_along(d, p));
    }
    thin[d] = holders > 1 && least < 2;
  }
  return thin;
}

std::vector<double> centres(const std::vector<double> &widths) {
  std::vector<double> centre;
  double edge = 0;
  for (const double w : widths) {
    centre.push_back(edge + w / 2);
    edge += w;
  }
  return centre;
}

}  // namespace

MultigridLevel::MultigridLevel(const Partition &partition, const Widths &widths, const Real3 &finest_spacing)
    : partition_(partition),
      exchange_(box(), partition_.comm(),
                [this](std::vector<Ghost> *ghosts) {
                  *ghosts = partition_.ghosts();
                  return PetscErrorCode(0);
                }),
      widths_(widths),
      finest_spacing_(finest_spacing) {
  for (int d = 0; d < 3; ++d) {
    const std::vector<double> &w = widths_[d];
    const int cells = box().domain_cells()[d], begin = box().layout().begin[d];
    const double h = finest_spacing[d];
    for (int local = -reach; local < box().cells()[d] + reach; ++local) {
      const int g = image(begin + local, cells), below = image(g - 1, cells), above = image(g + 1, cells);
      const bool low_wall = box().boundary(d) == Boundary::wall && g == 0;
      const bool high_wall = box().boundary(d) == Boundary::wall && g == cells - 1;
      const auto coupling = [&](bool side, bool open, int other) {
        if (side && open) return 2 / (h * h * w[g] * w[g]);  // to the value 0 on the boundary
        return cells == 1 || side ? 0 : 2 / (h * h * w[g] * (w[g] + w[other]));
      };
      low_[d].push_back(coupling(low_wall, box().is_open(d, false), below));
      high_[d].push_back(coupling(high_wall, box().is_open(d, true), above));
    }
    if (cells > 1)
      diagonal_ += 2 / (h * h * w[0] * w[0]);
    else
      diagonal_ += low_[d][0] + high_[d][0];
  }
  set_shift(0);
}

void MultigridLevel::set_shift(double shift) {
  shift_ = shift;
  step_ = diagonal_ + shift > 0 ? -1 / (diagonal_ + shift) : 0;
}

std::unique_ptr<MultigridLevel> MultigridLevel::coarser() const {
  // Beyond this ratio of spacings the stiffer direction is halved first, because relaxation hardly smooths along the
  // other.
  constexpr double about_equal = 1.25;
  Int3 cells = box().domain_cells();
  Widths widths;
  double smallest = HUGE_VAL;
  for (int d = 0; d < 3; ++d)
    if (cells[d] > 1) smallest = std::min(smallest, widths_[d][0] * finest_spacing_[d]);
  for (int d = 0; d < 3; ++d) {
    const bool halve = cells[d] > 1 && widths_[d][0] * finest_spacing_[d] <= about_equal * smallest;
    if (halve) cells[d] = halved(cells[d], widths_[d].back() < widths_[d][0], box().is_open(d, true));
    widths[d].assign(cells[d], 0.0);
    for (int i = 0; i < box().domain_cells()[d]; ++i) widths[d][parent_of(i, halve ? 2 : 1, cells[d])] += widths_[d][i];
  }
  return std::make_unique<MultigridLevel>(partition_.coarse(cells), widths, finest_spacing_);
}

std::unique_ptr<MultigridLevel> MultigridLevel::next() const {
  constexpr double gathered_cells = 4096;  // at most this size on every rank, because messages cost more than cells
  std::unique_ptr<MultigridLevel> half = coarser();
  if (partition_.ranks() == 1) return half;
  if (box().domain_cell_count() <= gathered_cells)
    return std::make_unique<MultigridLevel>(partition_.everywhere(), widths_, finest_spacing_);
  const std::array<bool, 3> thin = thin_directions(partition_.split(), half->partition_.split());
  if (!(thin[0] || thin[1] || thin[2])) return half;
  return std::make_unique<MultigridLevel>(partition_.joined(thin), widths_, finest_spacing_);
}

LineTransfer MultigridLevel::transfer(const MultigridLevel &coarse, int d) const {
  const int fine_cells = box().domain_cells()[d], coarse_cells = coarse.box().domain_cells()[d];
  const int fine_begin = box().layout().begin[d], coarse_begin = coarse.box().layout().begin[d];
  const int coarse_owned = coarse.box().cells()[d];
  const std::vector<double> &fine_width = widths_[d], &coarse_width = coarse.widths_[d];
  const std::vector<double> fine_centre = centres(fine_width), coarse_centre = centres(coarse_width);
  const bool wall = box().boundary(d) == Boundary::wall;
  LineTransfer line;
  line.stride = coarse_cells < fine_cells ? 2 : 1;
  line.first = line.stride * coarse_begin - fine_begin;
  for (int m = 0; m < 3; ++m)
    for (int I = 0; I < coarse_owned; ++I) {
      const int g = coarse_begin + I, child = line.stride * g + m;
      const bool exists = child < fine_cells && parent_of(child, line.stride, coarse_cells) == g;
      line.weight[m].push_back(exists ? fine_width[child] / coarse_width[g] : 0);
    }
  // Direction of the neighbour (-1, 0, 1) and its share for a fine cell of global index g in the domain.
  const auto neighbour = [&](int g, double *share) {
    const int parent = parent_of(g, line.stride, coarse_cells);
    const double distance = fine_centre[g] - coarse_centre[parent];
    const int step = distance > 0 ? 1 : distance < 0 ? -1 : 0, other = parent + step;
    *share = 0;
    if (step != 0 && wall && (other < 0 || other >= coarse_cells)) {
      if (!box().is_open(d, other >= coarse_cells)) return 0;
      *share = 2 * std::abs(distance) / coarse_width[parent];
      return step;
    }
    if (step == 0 || coarse_cells == 1) return 0;
    *share = 2 * std::abs(distance) / (coarse_width[parent] + coarse_width[(other + coarse_cells) % coarse_cells]);
    return step;
  };
  for (int i = -reach; i < box().cells()[d] + reach; ++i) {
    const int g = image(fine_begin + i, fine_cells), turns = (fine_begin + i - g) / fine_cells;
    double share;
    const int step = neighbour(g, &share);
    line.parent.push_back(parent_of(g, line.stride, coarse_cells) + turns * coarse_cells - coarse_begin);
    line.neighbour.push_back(line.parent[i] + step);
    line.share.push_back(share);
  }
  for (int I = -1; I < coarse_owned; ++I) {
    line.share_low.push_back(line.share[line.first + line.stride * I]);
    line.share_high.push_back(line.share[line.first + line.stride * I + 1]);
  }
  return line;
}

}  // namespace eulastic
