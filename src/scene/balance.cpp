#include "scene/balance.hpp"

#include "base/one_line.hpp"
#include "boxes/share_out.hpp"
#include "grid/domain.hpp"

#include <algorithm>

namespace eulastic {
namespace {

constexpr double worth = 0.97;    // of the heaviest rank's cost, before the even split is given up
constexpr int rounds = 8;         // of cuts that are tried
constexpr int most_units = 4096;  // along a direction: a sum over all ranks for each

class Balance {
public:
  explicit Balance(const Solver &solver)
      : domain_(solver.domain()), split_(domain_.split()), cost_(domain_.rows().size(), 0) {
    for (double &cost : cost_) cost = flow_work * domain_.cells()[0];
    for (const Phase &phase : solver.state().phases) add(phase);
    for (const double cost : cost_) own_ += cost;
    for (int d = 0; d < 3; ++d) {
      const int cells = domain_.domain_cells()[d], parts = domain_.processors(d);
      unit_[d] = cut_unit(cells, parts);
      while (cells > most_units * unit_[d]) unit_[d] *= 2;
      least_[d] = (Box::stencil_width + unit_[d] - 1) / unit_[d];
      movable_[d] = d > 0 && parts > 1 && cells / unit_[d] >= parts * least_[d];
    }
  }

  PetscErrorCode find(GridSpec *spec, double *before, double *after) {
    PetscFunctionBeginUser;
    double total = own_, heaviest = own_;
    std::array<std::vector<double>, 3> sums, weights;
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &total, 1, MPI_DOUBLE, MPI_SUM, domain_.comm()));
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &heaviest, 1, MPI_DOUBLE, MPI_MAX, domain_.comm()));
    *before = heaviest * domain_.ranks() / total;
    const double even = heaviest;
    for (int d = 1; d < 3; ++d) PetscCall(sum_planes(d, &sums[d]));
    weights = sums;
    Split best = split_;
    for (int round = 0; round < rounds; ++round) {
      for (int d = 1; d < 3; ++d)
        if (movable_[d] && (round == 0 || round % 2 == d - 1)) cut(d, weights[d]);
      std::array<std::vector<double>, 3> most;
      PetscCall(heaviest_boxes(&most));
      const double here = *std::max_element(most[1].begin(), most[1].end());
      if (here < heaviest) heaviest = here, best = split_;
      for (int d = 1; d < 3; ++d)
        if (movable_[d]) weigh(d, sums[d], most[d], &weights[d]);
    }
    *after = heaviest * domain_.ranks() / total;
    if (heaviest < worth * even) spec->starts = best.starts;
    PetscFunctionReturn(0);
  }

private:
  double &cost(int j, int k) { return cost_[j + std::size_t(domain_.cells()[1]) * k]; }

  void add(const Phase &phase) {
    const double factor = phase_work(phase.material, false);
    if (factor == 0) return;
    for (const Segment &row : domain_.rows()) {
      const OccupiedRows::Span span = phase.rows.span(row.j, row.k);
      cost(row.j, row.k) += factor * std::max(0, std::min(span.end, row.i_end) - std::max(span.begin, 0));
    }
  }

  // Over the planes of each unit along d.
  PetscErrorCode sum_planes(int d, std::vector<double> *sums) {
    PetscFunctionBeginUser;
    const int units = domain_.domain_cells()[d] / unit_[d];  // the last one may have more cells
    sums->assign(units, 0);
    for (const Segment &row : domain_.rows()) {
      const int plane = domain_.layout().begin[d] + (d == 1 ? row.j : row.k);
      (*sums)[std::min(plane / unit_[d], units - 1)] += cost(row.j, row.k);
    }
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums->data(), units, MPI_DOUBLE, MPI_SUM, domain_.comm()));
    PetscFunctionReturn(0);
  }

  void cut(int d, const std::vector<double> &weights) {
    const int parts = domain_.processors(d);
    const std::vector<int> first = equal_cuts(weights, parts, least_[d]);
    for (int p = 1; p < parts; ++p) split_.starts[d][p] = first[p] * unit_[d];
  }

  // The planes of a rank weigh together what the heaviest of the boxes that they go through does.
  void weigh(int d, const std::vector<double> &sums, const std::vector<double> &most, std::vector<double> *weights) {
    const int units = static_cast<int>(sums.size());
    for (int p = 0; p < domain_.processors(d); ++p) {
      const int begin = split_.starts[d][p] / unit_[d],
                end = p + 1 < domain_.processors(d) ? split_.starts[d][p + 1] / unit_[d] : units;
      double sum = 0;
      for (int u = begin; u < end; ++u) sum += sums[u];
      for (int u = begin; u < end; ++u) (*weights)[u] = sums[u] * most[p] / sum;
    }
  }

  // The heaviest box at every position along y and z, if ranks had the cells of split_.
  PetscErrorCode heaviest_boxes(std::array<std::vector<double>, 3> *most) {
    PetscFunctionBeginUser;
    const Int3 &begin = domain_.layout().begin;
    const int x = split_.position_of(domain_.rank())[0];
    std::vector<double> boxes(domain_.ranks(), 0);
    for (const Segment &row : domain_.rows()) {
      const int y = split_.position_along(1, begin[1] + row.j), z = split_.position_along(2, begin[2] + row.k);
      boxes[split_.rank_at({x, y, z})] += cost(row.j, row.k);
    }
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, boxes.data(), domain_.ranks(), MPI_DOUBLE, MPI_SUM, domain_.comm()));
    for (int d = 1; d < 3; ++d) {
      (*most)[d].assign(domain_.processors(d), 0);
      for (int rank = 0; rank < domain_.ranks(); ++rank) {
        double &heaviest = (*most)[d][split_.position_of(rank)[d]];
        heaviest = std::max(heaviest, boxes[rank]);
      }
    }
    PetscFunctionReturn(0);
  }

  const Domain &domain_;
  Split split_;               ///< the best cuts so far
  std::vector<double> cost_;  ///< of owned rows
  double own_ = 0;            ///< their sum
  Int3 unit_{}, least_{};     ///< cells that cuts are multiples of; units of a rank
  std::array<bool, 3> movable_{};
};

}  // namespace

PetscErrorCode balance_ranks(const Solver &solver, GridSpec *spec, std::string *line) {
  PetscFunctionBeginUser;
  double before = 1, after = 1;
  Balance balance(solver);
  PetscCall(balance.find(spec, &before, &after));
  if (solver.domain().ranks() == 1)
    *line = print("balance: one rank has all cells");
  else if (spec->starts[0].empty())
    *line = print("balance: the even split is kept, heaviest rank %.3g of the mean, at best %.3g (estimate)", before,
                  after);
  else
    *line = print("balance: heaviest rank %.3g -> %.3g of the mean (estimate)", before, after);
  PetscFunctionReturn(0);
}

namespace {

// First unit of each rank if every rank takes as many units from the end as `bound` allows. `sums`: costs of all units
// before each.
std::vector<int> earliest(const std::vector<double> &sums, int parts, double bound) {
  std::vector<int> first(parts + 1, static_cast<int>(sums.size()) - 1);
  for (int p = parts - 1; p >= 0; --p) {
    const auto end = sums.begin() + first[p + 1];
    first[p] = static_cast<int>(std::lower_bound(sums.begin(), end, *end - bound) - sums.begin());
  }
  return first;
}

}  // namespace

std::vector<int> equal_cuts(const std::vector<double> &cost, int parts, int least) {
  std::vector<double> sums{0};
  for (const double c : cost) sums.push_back(sums.back() + c);
  const int units = static_cast<int>(cost.size());
  double too_low = 0, bound = sums.back();
  for (int halving = 0; halving < 50; ++halving) {
    const double middle = (too_low + bound) / 2;
    (earliest(sums, parts, middle)[0] > 0 ? too_low : bound) = middle;
  }
  std::vector<int> first = earliest(sums, parts, bound);
  first[0] = 0;
  for (int p = 1; p < parts; ++p) {
    const double share = sums.back() * p / parts, reach = sums[first[p - 1]] + bound;
    int cut = static_cast<int>(std::lower_bound(sums.begin(), sums.end(), share) - sums.begin());
    if (cut > 0 && share - sums[cut - 1] < sums[cut] - share) --cut;
    const int last = static_cast<int>(std::upper_bound(sums.begin(), sums.end(), reach) - sums.begin()) - 1;
    cut = std::max(std::min(cut, last), first[p]);
    first[p] = std::clamp(cut, first[p - 1] + least, units - (parts - p) * least);
  }
  return first;
}

}  // namespace eulastic
