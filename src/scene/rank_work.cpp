#include "scene/rank_work.hpp"

#include "base/deliver.hpp"
#include "bodies/near_places.hpp"
#include "bodies/overlap.hpp"
#include "bodies/volume_fraction.hpp"
#include "boxes/free_bodies.hpp"
#include "boxes/share_out.hpp"
#include "grid/domain.hpp"
#include "solids/exterior.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <tuple>

namespace eulastic {
namespace {

// Work that a planned rank has. Of a body in a box the rank is its home, and whoever takes the body has the work.
struct Work {
  int rank, number;
  bool in_box;
  double cost;
};

using Span = PlacedBody::Range;

void join(const Span &other, Span *span) {
  if (other.begin >= other.end) return;
  if (span->begin >= span->end) *span = {other.begin, other.end, 0};
  span->begin = std::min(span->begin, other.begin);
  span->end = std::max(span->end, other.end);
}

// Rows of cells that a body and what it needs around it occupy, as FreeBodies and OccupiedRows find them from phi.
class BodyRows {
public:
  /// A box that ends `margin` cells around the body, or at sides of the domain; rows that hold all within `reach` cells
  /// of it.
  BodyRows(const DomainShape &grid, const PlacedBody &body, int margin, int reach) {
    for (int d = 0; d < 3; ++d) {
      const bool wall = grid.boundary[d] == Boundary::wall;
      flat_[d] = grid.cells[d] == 1;
      touched_[d] = body.extent(d);
      if (wall || flat_[d]) {
        touched_[d].begin = std::max(touched_[d].begin, 0);
        touched_[d].end = std::min(touched_[d].end, grid.cells[d]);
      }
      held_[d] = {touched_[d].end, touched_[d].begin, 0};
    }
    find_spans(body);
    for (int d = 0; d < 3; ++d) {
      box_[d] = held_[d];
      if (flat_[d]) continue;
      box_[d] = {held_[d].begin - margin, held_[d].end + margin, 0};
      if (grid.boundary[d] == Boundary::wall)
        box_[d] = {std::max(box_[d].begin, 0), std::min(box_[d].end, grid.cells[d]), 0};
    }
    count(reach);
  }

  /// Cells of these rows.
  double cells() const { return cells_; }
  /// The cell in the middle of the box along d, not wrapped.
  int middle(int d) const { return box_[d].begin + (box_[d].end - box_[d].begin) / 2; }

private:
  int size(int d) const { return std::max(0, touched_[d].end - touched_[d].begin); }

  // What is solid of every row that the body may touch.
  void find_spans(const PlacedBody &body) {
    spans_.assign(std::size_t(size(1)) * size(2), {0, 0, 0});
    for (int k = touched_[2].begin; k < touched_[2].end; ++k)
      for (int j = touched_[1].begin; j < touched_[1].end; ++j) {
        const auto holds = [&](int i) { return !body.is_clear_of({i, j, k}) && body.fraction({i, j, k}) > 0; };
        int first = touched_[0].begin, end = touched_[0].end;
        while (first < end && !holds(first)) ++first;
        while (first < end && !holds(end - 1)) --end;
        if (first >= end) continue;
        spans_[(j - touched_[1].begin) + std::size_t(size(1)) * (k - touched_[2].begin)] = {first, end, 0};
        const Span found[3] = {{first, end, 0}, {j, j + 1, 0}, {k, k + 1, 0}};
        for (int d = 0; d < 3; ++d) join(found[d], &held_[d]);
      }
  }

  // The least span that has all rows within reach, first along y, then along z.
  void count(int reach) {
    const int rows = size(1), planes = size(2), wide = box_[1].end - box_[1].begin;
    std::vector<Span> along_y(std::size_t(std::max(0, wide)) * planes, {0, 0, 0});
    for (int k = 0; k < planes; ++k)
      for (int j = 0; j < rows; ++j)
        for (int y = -reach; y <= reach; ++y) {
          const int to = j + touched_[1].begin + (flat_[1] ? 0 : y) - box_[1].begin;
          if (to >= 0 && to < wide) join(spans_[j + std::size_t(rows) * k], &along_y[to + std::size_t(wide) * k]);
        }
    for (int z = box_[2].begin; z < box_[2].end; ++z)
      for (int y = 0; y < wide; ++y) {
        Span all{0, 0, 0};
        const int around = flat_[2] ? 0 : reach;
        for (int k = std::max(z - around, touched_[2].begin); k <= std::min(z + around, touched_[2].end - 1); ++k)
          join(along_y[y + std::size_t(wide) * (k - touched_[2].begin)], &all);
        if (all.begin < all.end)
          cells_ += std::min(all.end + reach, box_[0].end) - std::max(all.begin - reach, box_[0].begin);
      }
  }

  std::array<bool, 3> flat_{};
  std::array<Span, 3> touched_{}, held_{}, box_{};
  std::vector<Span> spans_;  ///< of touched rows, y first
  double cells_ = 0;
};

class Estimate {
public:
  Estimate(const Config &config, int ranks)
      : config_(config),
        domain_(Domain::planned(config.grid, ranks)),
        first_(first_labels(config.species, config.places)) {}

  /// What this rank knows of; rank 0 alone of walls, posts and what all ranks know.
  void add_all(bool on_rank_0) {
    for (std::size_t s = 0; s < config_.species.size(); ++s) {
      const Places &places = config_.places[s];
      if ((places.everywhere && !on_rank_0) || phase_work(config_.species[s].material(), false) == 0) continue;
      const Surface surface(config_.species[s], domain_.dimension());
      const Shape shape = config_.species[s].shape;
      if (is_attached(shape) || shape == Shape::cylinder)
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
  static constexpr double examined = 1e6;  // cells of boxes; further bodies are as large as the mean
  static constexpr double samples = 1e6;   // points that are looked at for walls

  void add_bodies(std::size_t s, const Surface &surface) {
    const SpeciesSpec &spec = config_.species[s];
    const bool in_box = config_.lies_in_boxes(s);
    const int reach = in_box ? FreeBodies::rows_reach(spec.material(), config_.grid.ghosts)
                             : config_.grid.ghosts + OccupiedRows::beyond_ghosts;
    const int margin = in_box ? FreeBodies::margin(spec.material()) : reach;
    const double per_cell = phase_work(spec.material(), in_box);
    double looked_at = 0, sum = 0, count = 0;
    for (const NumberedPlace &place : config_.places[s].known) {
      Int3 home{};
      double cells = count > 0 ? std::round(sum / count) : 0;
      for (int d = 0; d < domain_.dimension(); ++d)
        home[d] = static_cast<int>(std::floor(place.centre[d] / domain_.spacing()[d]));
      if (looked_at <= examined) {
        const PlacedBody body(surface, config_.grid, place);
        const BodyRows rows(config_.grid, body, margin, reach);
        cells = rows.cells();
        double box = 1;
        for (int d = 0; d < domain_.dimension(); ++d) {
          home[d] = rows.middle(d);
          box *= body.extent(d).end - body.extent(d).begin;
        }
        looked_at += box, sum += cells, count += 1;
      }
      const int number = first_[s] + place.index;
      if (in_box) {
        for (int d = 0; d < 3; ++d) home[d] = domain_.image(d, home[d]);
        list_.push_back({domain_.owner(home[0], home[1], home[2]), number, true, per_cell * cells});
        continue;
      }
      const std::vector<int> near = ranks_near(domain_, surface, place);
      for (const int rank : near) list_.push_back({rank, number, false, per_cell * cells / double(near.size())});
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
           return phase_work(spec.material(), false) > 0 && (spec.shape == Shape::voxels || spec.shape == Shape::state);
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
  PetscCall(deliver(comm, std::vector<int>(list.size(), 0), &list));
  if (rank > 0) PetscFunctionReturn(0);
  std::array<double, 3> parts{};
  const std::vector<double> work = estimate.total(std::move(list), &parts);
  const double sum = parts[0] + parts[1] + parts[2], mean = sum / ranks;
  char text[200];
  std::snprintf(text, sizeof text,
                "%.3f; of all work %.3g %% in the flow, %.3g %% in phases of the grid, %.3g %% in boxes\n",
                *std::max_element(work.begin(), work.end()) / mean, 100 * parts[0] / sum, 100 * parts[1] / sum,
                100 * parts[2] / sum);
  *line = name + text;
  PetscFunctionReturn(0);
}

}  // namespace eulastic
