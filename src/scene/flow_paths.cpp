#include "scene/flow_paths.hpp"

#include "base/rank_zero.hpp"
#include "scene/closed_faces.hpp"
#include "scene/open_parts.hpp"
#include "scene/voxels.hpp"

#include <algorithm>
#include <cstdint>

namespace eulastic {
namespace {

using Bits = std::vector<std::uint8_t>;

bool closes_faces(const Config &config, const SpeciesSpec &spec) {
  return spec.law == Law::rigid && spec.shape != Shape::state &&
         (spec.shape == Shape::slab || !spec.travels(config.grid.dimension()));
}

// Sets of connected cells, each with bits of the boundaries that it touches.
struct Sets {
  std::vector<int> parent;
  Bits sides;

  int add() {
    parent.push_back(static_cast<int>(parent.size()));
    sides.push_back(0);
    return parent.back();
  }
  int find(int set) {
    while (parent[set] != set) set = parent[set] = parent[parent[set]];
    return set;
  }
  /// `one` may be -1, no set yet; nothing is done if `other` is.
  void join(int *one, int other) {
    if (other < 0 || other == *one) return;
    const int a = *one < 0 ? find(other) : find(*one), b = find(other);
    parent[std::max(a, b)] = *one = std::min(a, b);
    sides[*one] |= sides[std::max(a, b)];
  }
};

// Labels connected cells layer by layer, so that the whole box is never in memory.
class Paths {
public:
  explicit Paths(const Config &config) : config_(config), n_(config.grid.cells), plane_(std::size_t(n_[0]) * n_[1]) {}

  // Rank 0 does the work; the others take part in reading files.
  std::string find(std::array<int, 6> *connected) {
    int rank;
    (void)MPI_Comm_rank(run_communicator(), &rank);
    const int step = static_cast<int>(std::clamp<std::size_t>(most_cells / plane_, 1, n_[2]));
    for (int begin = 0; begin < n_[2]; begin += step) {
      const int layers = rank == 0 ? std::min(step, n_[2] - begin) : 0;
      Bits closed(plane_ * layers);
      if (std::string wrong = close_faces(begin, layers, &closed); !wrong.empty()) return wrong;
      for (int k = 0; k < layers; ++k) connect(begin + k, closed.data() + plane_ * k);
    }
    for (std::size_t c = 0; c < first_.size() && !config_.grid.is_wall(2); ++c)
      if (first_[c] >= 0) sets_.join(&first_[c], last_[c]);
    for (int set = 0; set < static_cast<int>(sets_.parent.size()); ++set)
      for (int side = 0; side < 6; ++side)
        if (sets_.sides[set] >> side & 1) (*connected)[side] |= sets_.sides[sets_.find(set)];
    share(connected);
    return {};
  }

private:
  static constexpr int most_cells = 1 << 24;  // in memory at a time

  // Bits of faces_inside() of all bodies, for the cells of some layers.
  std::string close_faces(int begin, int layers, Bits *closed) const {
    for (std::size_t s = 0; s < config_.species.size(); ++s) {
      const SpeciesSpec &spec = config_.species[s];
      if (!closes_faces(config_, spec)) continue;
      if (spec.shape == Shape::voxels) {
        if (std::string wrong = close_faces_of_file(spec, begin, layers, closed); !wrong.empty()) return wrong;
        continue;
      }
      const Surface surface(spec, config_.grid.dimension());
      for (const NumberedPlace &place : config_.places[s].known) {
        const PlacedBody body(surface, config_.grid, place);
        body.for_cells({0, 0, begin}, {n_[0], n_[1], layers}, [&](const Int3 &cell, const Int3 &unwrapped) {
          (*closed)[cell[0] + std::size_t(n_[0]) * cell[1] + plane_ * (cell[2] - begin)] |=
              static_cast<std::uint8_t>(faces_inside(body, config_.grid, unwrapped));
        });
      }
    }
    return {};
  }

  // A face is inside if the mean solid fraction of its two cells is above 1/2, as in a run.
  std::string close_faces_of_file(const SpeciesSpec &spec, int begin, int layers, Bits *closed) const {
    std::vector<double> phi(plane_ * (layers + 1));  // with the layer below, across the boundary if it is periodic
    const auto read = [&](int first, int count, double *to) {
      return read_voxels(spec, config_.grid, {config_.grid, {0, 0, first}, {n_[0], n_[1], count}},
                         [&](const CellWindow &window, ConstView fraction) {
                           for (int k = 0; k < window.size[2]; ++k)
                             for (int j = 0; j < n_[1]; ++j, to += n_[0]) std::copy_n(fraction.row(j, k), n_[0], to);
                         });
    };
    if (std::string wrong = read((begin + n_[2] - 1) % n_[2], std::min(layers, 1), phi.data()); !wrong.empty())
      return wrong;
    if (std::string wrong = read(begin, layers, phi.data() + plane_); !wrong.empty()) return wrong;
    for (std::size_t c = 0; c < closed->size(); ++c) {
      const std::size_t i = c % n_[0], j = c / n_[0] % n_[1], at = c + plane_;
      const std::size_t below[3] = {i > 0 ? at - 1 : at + n_[0] - 1, j > 0 ? at - n_[0] : at + plane_ - n_[0], c};
      if (phi[at] > 0.5) (*closed)[c] |= centre_inside;
      for (int a = 0; a < config_.grid.dimension(); ++a)
        if (phi[at] + phi[below[a]] > 1) (*closed)[c] |= static_cast<std::uint8_t>(1U << a);
    }
    return {};
  }

  // Adds a layer of cells to the sets.
  void connect(int k, const std::uint8_t *closed) {
    const unsigned all = centre_inside + (1U << config_.grid.dimension()) - 1;
    std::vector<int> now(plane_, -1);
    for (std::size_t c = 0; c < plane_; ++c) {
      const Int3 cell{static_cast<int>(c % n_[0]), static_cast<int>(c / n_[0]), k};
      if (closed[c] == all) continue;
      if (cell[0] > 0 && !(closed[c] & 1)) sets_.join(&now[c], now[c - 1]);
      if (cell[1] > 0 && !(closed[c] & 2)) sets_.join(&now[c], now[c - n_[0]]);
      if (k > 0 && !(closed[c] & 4)) sets_.join(&now[c], last_[c]);
      if (now[c] < 0) now[c] = sets_.add();
      if (closed[c] & centre_inside) continue;
      for (int side = 0; side < 6; ++side)
        if (cell[side / 2] == side % 2 * (n_[side / 2] - 1))
          sets_.sides[now[c]] |= static_cast<std::uint8_t>(1 << side);
    }
    for (const std::size_t d : {0, 1})
      for (std::size_t line = 0; line < std::size_t(n_[1 - d]) && !config_.grid.is_wall(static_cast<int>(d)); ++line) {
        const std::size_t low = d == 0 ? line * n_[0] : line, high = d == 0 ? low + n_[0] - 1 : low + plane_ - n_[0];
        if (!(closed[low] >> d & 1) && now[low] >= 0) sets_.join(&now[low], now[high]);
      }
    if (k == 0) first_ = now;
    for (std::size_t c = 0; c < plane_ && k == 0; ++c)
      if (closed[c] & 4) first_[c] = -1;
    last_ = std::move(now);
  }

  const Config &config_;
  Int3 n_;
  std::size_t plane_;
  Sets sets_;
  std::vector<int> first_, last_;  ///< sets of the cells of the first layer, -1 above closed faces, and of the last one
};

}  // namespace

std::string find_connected_boundaries(Config *config) {
  int crossed = 0;
  unsigned bits = 0;
  for_crossed_sides(*config, [&](int d, int high) { ++crossed, bits |= 1U << (2 * d + high); });
  const bool closes = std::any_of(config->species.begin(), config->species.end(),
                                  [&](const SpeciesSpec &spec) { return closes_faces(*config, spec); });
  if (crossed < 2 || !closes) return {};
  std::array<int, 6> connected{};
  if (std::string wrong = Paths(*config).find(&connected); !wrong.empty()) return wrong;
  for_crossed_sides(*config, [&](int d, int high) {
    config->open_parts[d][high].connected = bits & static_cast<unsigned>(connected[2 * d + high]);
  });
  return {};
}

}  // namespace eulastic
