#include "scene/rank_work.hpp"

#include "base/one_line.hpp"
#include "base/send_to_ranks.hpp"
#include "bodies/fill_phase.hpp"
#include "bodies/near_places.hpp"
#include "bodies/overlap.hpp"
#include "bodies/volume_fraction.hpp"
#include "boxes/free_bodies.hpp"
#include "boxes/share_out.hpp"
#include "grid/domain.hpp"
#include "solids/exterior.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace eulastic {
namespace {

// Work of a planned rank. A body in a box counts for the rank that share_out() assigns it to.
struct Work {
  int rank, number;
  bool in_box;
  double cost;
};

class Estimate {
public:
  Estimate(const Config &config, int ranks)
      : config_(config),
        domain_(Domain::planned(config.grid, ranks)),
        first_(first_labels(config.species, config.places)) {}

  /// Adds the work of the bodies known to this rank; with `on_rank_0` also that of walls, posts and bodies known to
  /// all.
  void add_all(bool on_rank_0) {
    for (std::size_t s = 0; s < config_.species.size(); ++s) {
      const Places &places = config_.places[s];
      if ((places.everywhere && !on_rank_0) || phase_work(config_.species[s].material(), false) == 0) continue;
      const Surface surface(config_.species[s], domain_.dimension());
      const Shape shape = config_.species[s].shape;
      if (is_anchored(shape) || shape == Shape::cylinder)
        add_walls(s, surface);
      else
        add_bodies(s, surface);
    }
  }
  std::vector<Work> &list() { return list_; }

  /// Work of the planned ranks, of all the pieces in `list`.
  std::vector<double> total(std::vector<Work> list, std::array<double, 3> *parts) const {
    std::sort(list.begin(), list.end(), [](const Work &one, const Work &other) {
      return std::tie(one.rank, one.number) < std::tie(other.rank, other.number);
    });
    std::vector<double> work, costs;
    double boxed = 0;
    for (int rank = 0; rank < domain_.ranks(); ++rank)
      work.push_back(flow_work * domain_.split().box_of(rank, config_.grid, 0).cell_count());
    (*parts)[0] = std::accumulate(work.begin(), work.end(), 0.);
    for (const Work &piece : list) {
      if (piece.in_box)
        costs.push_back(piece.cost), boxed += piece.cost;
      else
        work[piece.rank] += piece.cost;
    }
    (*parts)[1] = std::accumulate(work.begin(), work.end(), 0.) - (*parts)[0];
    (*parts)[2] = boxed;
    const std::vector<int> takers = fill_ranks(work, 0, boxed, costs);
    for (std::size_t n = 0; n < costs.size(); ++n) work[takers[n]] += costs[n];
    return work;
  }

private:
  static constexpr double samples = 1e6;  // points that are looked at for walls

  void add_bodies(std::size_t s, const Surface &surface) {
    const SpeciesSpec &spec = config_.species[s];
    const bool in_box = config_.lies_in_boxes(s);
    const int margin = in_box ? FreeBodies::margin(spec.material()) : config_.grid.ghosts + OccupiedRows::beyond_ghosts;
    for (const NumberedPlace &place : config_.places[s].known) {
      const Box block = box_of_body(domain_.domain_shape(), surface, place, margin - 1, 0);
      const double cost = phase_work(spec.material(), in_box) * block.cell_count();
      const int number = first_[s] + place.index;
      if (in_box) {
        Int3 home{};
        for (int d = 0; d < 3; ++d) home[d] = domain_.image(d, block.layout().begin[d] + block.cells()[d] / 2);
        list_.push_back({domain_.owner(home[0], home[1], home[2]), number, true, cost});
        continue;
      }
      const std::vector<int> near = ranks_near(domain_, surface, place);
      for (const int rank : near) list_.push_back({rank, number, false, cost / double(near.size())});
    }
  }

  // Slabs, tubes, posts: looks at points of each planned rank's rows; a row is occupied from the first to the last of
  // them that is_occupied().
  void add_walls(std::size_t s, const Surface &surface) {
    std::vector<PlacedBody> bodies;
    for (const NumberedPlace &place : config_.places[s].known) bodies.emplace_back(surface, config_.grid, place);
    const double per_rank = samples / (double(domain_.ranks()) * std::max<double>(1, double(bodies.size())));
    const int most = std::max(2, static_cast<int>(std::pow(per_rank, 1. / domain_.dimension())));
    for (int rank = 0; rank < domain_.ranks(); ++rank) {
      const Box box = domain_.split().box_of(rank, config_.grid, 0);
      Int3 points{};
      for (int d = 0; d < 3; ++d) points[d] = std::min(box.cells()[d], most);
      double found = 0;
      for (int k = 0; k < points[2]; ++k)
        for (int j = 0; j < points[1]; ++j) {
          const auto at = [&](int i) { return is_occupied(box, bodies, middle_of(box, points, {i, j, k})); };
          int first = 0, end = points[0];
          while (first < end && !at(first)) ++first;
          while (first < end && !at(end - 1)) --end;
          found += end - first;
        }
      const double share = found / (double(points[0]) * points[1] * points[2]);
      list_.push_back({rank, first_[s], false,
                       std::round(share * box.cell_count()) * phase_work(config_.species[s].material(), false)});
    }
  }

  // Cell of a rank's box at a point, in cells from the middle of the domain.
  Real3 middle_of(const Box &box, const Int3 &points, const Int3 &point) const {
    Real3 place{};
    for (int d = 0; d < domain_.dimension(); ++d) {
      const int cell = static_cast<int>((point[d] + 0.5) * box.cells()[d] / points[d]);
      place[d] = box.layout().begin[d] + cell + 0.5 - 0.5 * config_.grid.cells[d];
    }
    return place;
  }

  // As OccupiedRows says on the grid: a rank sees what is solid as far as its ghosts.
  bool is_occupied(const Box &box, const std::vector<PlacedBody> &bodies, const Real3 &place) const {
    const int ghosts = config_.grid.ghosts, reach = ghosts + OccupiedRows::beyond_ghosts;
    std::array<Real3, 3> along{};  // [direction]: here, and as far as is seen below and above
    for (int d = 0; d < 3; ++d) {
      along[d].fill(place[d]);
      if (d >= domain_.dimension()) continue;
      const double low = box.layout().begin[d] + 0.5 - 0.5 * config_.grid.cells[d], high = low + box.cells()[d] - 1;
      along[d] = {place[d], std::max(place[d] - reach, low - ghosts), std::min(place[d] + reach, high + ghosts)};
      const double length = config_.grid.cells[d];
      for (double &x : along[d])
        if (config_.grid.boundary[d] == Boundary::periodic) x -= length * std::floor(x / length + 0.5);
    }
    return std::any_of(bodies.begin(), bodies.end(), [&](const PlacedBody &body) {
      for (int n = 0; n < (domain_.dimension() == 2 ? 9 : 27); ++n)
        if (body.level({along[0][n % 3], along[1][n / 3 % 3], along[2][n / 9]}) < 0) return true;
      return false;
    });
  }

  const Config &config_;
  Domain domain_;
  std::vector<int> first_;  ///< label of the first body of every species
  std::vector<Work> list_;
};

// Bodies of files: nothing is known of them before the file is read.
bool comes_from_files(const Config &config) {
  return !config.initial_state.empty() ||
         std::any_of(config.species.begin(), config.species.end(), [](const SpeciesSpec &spec) {
           return phase_work(spec.material(), false) > 0 && is_from_file(spec.shape);
         });
}

}  // namespace

PetscErrorCode describe_work(MPI_Comm comm, const Config &config, int ranks, std::string *line) {
  int rank;
  bool any = false;
  PetscFunctionBeginUser;
  line->clear();
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  for (std::size_t s = 0; s < config.species.size(); ++s) any = any || config.lies_in_boxes(s);
  if (!any || ranks == 1) PetscFunctionReturn(0);
  const std::string name = "work of the fullest rank / mean (estimate): ";
  if (comes_from_files(config)) {
    *line = name + "unknown\n";
    PetscFunctionReturn(0);
  }
  Estimate estimate(config, ranks);
  estimate.add_all(rank == 0);
  std::vector<Work> list = std::move(estimate.list());
  PetscCall(send_to_ranks(comm, std::vector<int>(list.size(), 0), &list));
  if (rank > 0) PetscFunctionReturn(0);
  std::array<double, 3> parts{};
  const std::vector<double> work = estimate.total(std::move(list), &parts);
  const double sum = parts[0] + parts[1] + parts[2], mean = sum / ranks;
  *line = name + print("%.3f; of all work %.3g %% in the flow, %.3g %% in phases of the grid, %.3g %% in boxes\n",
                       *std::max_element(work.begin(), work.end()) / mean, 100 * parts[0] / sum, 100 * parts[1] / sum,
                       100 * parts[2] / sum);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
