#include "scene/open_parts.hpp"

#include "bodies/labels.hpp"
#include "bodies/volume_fraction.hpp"
#include "io/option_values.hpp"
#include "openings/leaving.hpp"
#include "scene/flow_paths.hpp"
#include "scene/voxels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace eulastic {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// The largest solid fraction in every cell that one of the bodies of a species has there.
std::string fill(const Config &config, std::size_t s, const CellWindow &cells, View fraction) {
  const SpeciesSpec &spec = config.species[s];
  const Int3 &first = cells.begin;
  if (spec.shape == Shape::voxels)
    return read_voxels(spec, config.grid, cells, [&](const CellWindow &window, ConstView phi) {
      for (int k = 0; k < window.size[2]; ++k)
        for (int j = 0; j < window.size[1]; ++j)
          std::copy_n(phi.row(j, k), window.size[0], fraction.row(j, window.begin[2] - first[2] + k));
    });
  const Surface surface(spec, config.grid.dimension());
  for (const NumberedPlace &place : config.places[s].known) {
    const PlacedBody body(surface, config.grid, place);
    body.for_cells(first, cells.size, [&](const Int3 &cell, const Int3 &unwrapped) {
      double &phi = fraction(cell[0] - first[0], cell[1] - first[1], cell[2] - first[2]);
      phi = std::max(phi, body.fraction(unwrapped));
    });
  }
  return {};
}

// The plane of cells beside a boundary, x before y before z: the open part of each cell and the width of the lumen
// there.
class SideCells {
public:
  SideCells(const Config &config, int d, bool high)
      : config_(config), d_(d), window_(config.grid, {}, config.grid.cells) {
    for (int e = 0; e < 3; ++e)
      if (e != d) along_[e - (e > d)] = e;
    window_.begin[d] = high ? config.grid.cells[d] - 1 : 0;
    window_.size[d] = 1;
    open_.assign(std::size_t(count(0)) * count(1), 1);
  }

  // Error of a file. `known`: false if bodies come from -initial_state.
  std::string subtract_rigid(bool *known) {
    const Int3 &n = window_.size;
    for (std::size_t s = 0; s < config_.species.size(); ++s) {
      const SpeciesSpec &spec = config_.species[s];
      if (spec.law != Law::rigid) continue;
      *known = *known && spec.shape != Shape::state;
      if (spec.shape == Shape::state) continue;
      std::vector<double> solid(open_.size());
      const View fraction{solid.data(), n[0], std::ptrdiff_t(n[0]) * n[1]};
      if (std::string wrong = fill(config_, s, window_, fraction); !wrong.empty()) return wrong;
      for (std::size_t c = 0; c < open_.size(); ++c) open_[c] = std::max(0.0, open_[c] - solid[c]);
    }
    return {};
  }

  OpenPart measure() {
    OpenPart part;
    double sum = 0;
    for (const double open : open_) sum += open;
    part.share = sum / double(open_.size());
    part.area = part.share * config_.grid.side_area(d_);
    chords_.assign(open_.size(), infinity);
    widths_ = chords_;
    for (const int which : {0, 1})
      if (count(which) > 1 || config_.grid.boundary[along_[which]] != Boundary::periodic) find_chords(which);
    part.cells = infinity;
    std::vector<bool> seen(open_.size());
    for (std::size_t c = 0; c < open_.size(); ++c) {
      if (seen[c] || !is_open(c)) continue;
      double cells = 0;
      for_lumen(c, &seen, [&](std::size_t at) {
        cells = std::max(cells, chords_[at]);
        part.width = std::max(part.width, widths_[at]);
      });
      part.cells = std::min(part.cells, cells);
      ++part.lumens;
    }
    return part;
  }

  std::size_t count() const { return open_.size(); }
  bool is_open(std::size_t c) const { return open_[c] > 0.5; }

private:
  int count(int which) const { return window_.size[along_[which]]; }
  bool wraps(int which) const { return config_.grid.boundary[along_[which]] == Boundary::periodic; }
  // Whether the lumen continues beyond the end of the plane as its mirror image.
  bool mirrors(int which, int high) const { return config_.sides[along_[which]][high].kind != BoundaryKind::wall; }

  // Finds for every cell the length, in cells, of the open piece of its line; keeps the shorter one of both directions.
  void find_chords(int which) {
    const int n = count(which), lines = count(1 - which);
    const double spacing = config_.grid.length[along_[which]] / n;
    for (int line = 0; line < lines; ++line) {
      const auto at = [&](int i) {
        i = (i + n) % n;
        return which == 0 ? i + std::size_t(n) * line : line + std::size_t(lines) * i;
      };
      int start = 0;  // of a line that wraps: a closed cell
      while (wraps(which) && start < n && is_open(at(start))) ++start;
      if (start == n) continue;
      for (int begin = start, end; begin < start + n; begin = end + 1) {
        double chord = 0;
        for (end = begin; end < start + n && is_open(at(end)); ++end) chord += open_[at(end)];
        if (end == begin) continue;
        const bool low = begin == 0 && !wraps(which), high = end == n && !wraps(which);
        if (!low) chord += open_[at(begin - 1)];
        if (!high) chord += open_[at(end)];
        const int mirrored = (low && mirrors(which, 0)) + (high && mirrors(which, 1));
        chord *= mirrored == 2 ? infinity : 1 + mirrored;
        for (int i = begin; i < end; ++i) {
          chords_[at(i)] = std::min(chords_[at(i)], chord);
          widths_[at(i)] = std::min(widths_[at(i)], chord * spacing);
        }
      }
    }
  }

  // All open cells that are connected with one of them through faces.
  template <class Visit>
  void for_lumen(std::size_t first, std::vector<bool> *seen, Visit visit) const {
    const int n[2] = {count(0), count(1)};
    std::vector<std::size_t> waiting{first};
    (*seen)[first] = true;
    while (!waiting.empty()) {
      const std::size_t c = waiting.back();
      waiting.pop_back();
      visit(c);
      for (const int which : {0, 1})
        for (const int step : {-1, 1}) {
          int at[2] = {static_cast<int>(c % n[0]), static_cast<int>(c / n[0])};
          at[which] += step;
          if (wraps(which)) at[which] = (at[which] + n[which]) % n[which];
          if (at[which] < 0 || at[which] == n[which]) continue;
          const std::size_t other = at[0] + std::size_t(n[0]) * at[1];
          if ((*seen)[other] || !is_open(other)) continue;
          (*seen)[other] = true;
          waiting.push_back(other);
        }
    }
  }

  const Config &config_;
  int d_, along_[2];
  CellWindow window_;
  std::vector<double> open_, chords_, widths_;
};

// A boundary is closed if no cell is more than half open, or none of those where the profile is not 0.
bool is_closed(const Config &config, const SideCells &cells, int d, int high) {
  const auto &profile = config.sides[d][high].profile;
  const bool shaped = config.openings[d][high].from_file() && profile && !profile->empty();
  double sum = 0;
  for (std::size_t c = 0; c < cells.count(); ++c)
    if (cells.is_open(c)) sum += shaped ? (*profile)[c] : 1;
  return !(std::fabs(sum) > 0);
}

// A rigid slab stops fluid where faces of the grid across its axis are inside it: it needs one, also while it moves. On
// a boundary that is not periodic the slab may be thinner, as the boundary is closed without it.
bool is_too_thin(const Config &config, const SpeciesSpec &slab) {
  const double spacing = config.grid.spacing(slab.axis);
  const double low = slab.interval[0] / spacing, high = slab.interval[1] / spacing;
  const bool bounded = config.grid.boundary[slab.axis] == Boundary::wall;
  if (bounded && (low <= 0 || high >= config.grid.cells[slab.axis])) return false;
  if (slab.travels(config.grid.dimension())) return high - low < 1 - on_surface;
  return std::floor(low + on_surface) + 1 >= high - on_surface;
}

std::string check_slabs(const Config &config) {
  for (const SpeciesSpec &spec : config.species) {
    const double length = config.grid.length[spec.axis];
    if (spec.law == Law::rigid && spec.shape == Shape::slab && spec.interval[0] <= 0 && spec.interval[1] >= length)
      return "-" + spec.name +
             "_interval: the rigid slab fills all of the box and leaves no fluid; accepted: a part of 0," +
             to_text(length);
    if (spec.law == Law::rigid && spec.shape == Shape::slab && is_too_thin(config, spec))
      return "-" + spec.name +
             "_interval: the rigid slab holds no face of the grid, so that fluid passes through it; accepted: at "
             "least " +
             to_text(config.grid.spacing(spec.axis)) + " long, one cell, with a multiple of it inside";
  }
  return {};
}

// Inflow must be able to leave.
std::string check_way(const Config &config, const std::array<std::array<bool, 2>, 3> &closed) {
  std::string inlet, outlet, covered;
  bool comes_in = false, way_out = false;
  for_crossed_sides(config, [&](int d, int high) {
    const std::string side = side_name(d, high);
    if (config.sides[d][high].kind != BoundaryKind::inflow) {
      way_out = way_out || !closed[d][high];
      outlet = side;
      return;
    }
    comes_in = true;
    if (closed[d][high] && inlet.empty()) inlet = side;
    if (config.open_parts[d][high].share != 1 && !config.openings[d][high].velocity.empty() && covered.empty())
      covered = side;
  });
  if (!inlet.empty())
    return "-boundary_" + inlet +
           ": rigid bodies cover all of this inflow boundary; accepted: a boundary that is partly open";
  if (outlet.empty() && !covered.empty())
    return "-boundary_" + covered +
           "_velocity: rigid bodies cover a part of this boundary, and no boundary is open, so that the inflow rates "
           "must balance; accepted: -boundary_" +
           covered + "_flow_rate";
  if (comes_in && !outlet.empty() && !way_out)
    return "-boundary_" + outlet +
           ": rigid bodies cover all boundaries through which the inflow could leave; accepted: an open boundary";
  return {};
}

// Rigid bodies inside the box must leave a way to an open boundary. Without one, inlets that they leave connected may
// still balance each other.
std::string check_cut_off(const Config &config) {
  std::string wrong;
  for_crossed_sides(config, [&](int d, int high) {
    const unsigned connected = config.open_parts[d][high].connected;
    if (config.sides[d][high].kind != BoundaryKind::inflow || connected == 0 || !wrong.empty()) return;
    int inlets = 0;
    bool outlet = false, in = false, out = false;
    for_crossed_sides(config, [&](int e, int end) {
      if (!(connected >> (2 * e + end) & 1)) return;
      const auto range = config.sides[e][end].given.range();
      const bool inlet = config.sides[e][end].kind == BoundaryKind::inflow;
      inlets += inlet;
      outlet = outlet || !inlet;
      in = in || (inlet && range[1] > 0);
      out = out || (inlet && range[0] < 0);
    });
    if (outlet || (!in && !out) || (inlets > 1 && in && out)) return;
    wrong = "-boundary_" + side_name(d, high) +
            ": rigid bodies cut this inflow boundary off from all boundaries through which the inflow could leave; "
            "accepted: bodies that leave a way for the fluid";
  });
  return wrong;
}

// Solid that is not rigid may not begin beside a boundary that fluid crosses: a run would stop there at once. Bodies
// that not every rank knows are left to the run.
std::string check_soft(const Config &config, std::size_t s, int d, int high) {
  const SpeciesSpec &spec = config.species[s];
  const bool known = spec.bears_load() || spec.material().anchored || spec.shape == Shape::cylinder;
  if (spec.law == Law::rigid || spec.shape == Shape::state || !known) return {};
  CellWindow cells(config.grid, {}, config.grid.cells);
  const int layers = std::min(free_layers, config.grid.cells[d]);
  cells.begin[d] = high ? config.grid.cells[d] - layers : 0;
  cells.size[d] = layers;
  const Int3 &n = cells.size;
  std::vector<double> solid(std::size_t(n[0]) * n[1] * n[2]);
  if (std::string wrong = fill(config, s, cells, {solid.data(), n[0], std::ptrdiff_t(n[0]) * n[1]}); !wrong.empty())
    return wrong;
  if (*std::max_element(solid.begin(), solid.end()) <= BodyCells::threshold) return {};
  return "-" + spec.name + "_shape: a body that is not rigid is within " + std::to_string(free_layers) +
         " cells of the open boundary " + side_name(d, high != 0) + "; accepted: -" + spec.name +
         "_law rigid, a body that ends further inside, or boundaries that are periodic or walls where it reaches them";
}

}  // namespace

std::string measure_open_parts(Config *config) {
  if (std::string wrong = check_slabs(*config); !wrong.empty()) return wrong;
  std::string wrong;
  std::array<std::array<bool, 2>, 3> closed{};
  for_crossed_sides(*config, [&](int d, int high) {
    if (!wrong.empty()) return;
    for (std::size_t s = 0; s < config->species.size() && wrong.empty(); ++s) wrong = check_soft(*config, s, d, high);
    if (!wrong.empty()) return;
    bool known = true;
    SideCells cells(*config, d, high);
    wrong = cells.subtract_rigid(&known);
    if (!known) return;
    config->open_parts[d][high] = cells.measure();
    closed[d][high] = is_closed(*config, cells, d, high);
  });
  if (wrong.empty()) wrong = check_way(*config, closed);
  if (wrong.empty()) wrong = find_connected_boundaries(config);
  return wrong.empty() ? check_cut_off(*config) : wrong;
}

}  // namespace eulastic
