#include "grid/domain.hpp"

#include <algorithm>
#include <cstdint>

namespace eulastic {
namespace {

// Block length of the exact sums. x is split at multiples of it, so that sums over rows do not depend on the split.
constexpr int sum_block = 256;

// Returns the first cell of each of `parts` ranks. They are multiples of a power of two, so that coarse grids have
// whole cells on every rank, as large as an imbalance of one eighth permits; in x multiples of sum_block if there are
// enough cells.
std::vector<int> split(int cells, int parts, bool in_blocks) {
  int unit = cut_unit(cells, parts);
  while (cells % (2 * unit * parts) == 0 && cells / parts >= 4 * unit) unit *= 2;
  if (in_blocks && cells >= sum_block * parts) unit = sum_block;
  const std::int64_t units = (cells + unit - 1) / unit;
  std::vector<int> starts(parts + 1);
  for (int p = 0; p <= parts; ++p)
    starts[p] = static_cast<int>(std::min<std::int64_t>(cells, units * p / parts * unit));
  return starts;
}

std::vector<int> starts_of(const GridSpec &spec, const Int3 &ranks, int d) {
  return spec.starts[d].empty() ? split(spec.cells[d], ranks[d], d == 0) : spec.starts[d];
}

bool wide_enough(const std::vector<int> &starts, bool needs_ghosts) {
  for (std::size_t p = 0; p + 1 < starts.size(); ++p)
    if (starts[p + 1] - starts[p] < (needs_ghosts ? Domain::stencil_width : 1)) return false;
  return true;
}

bool fits(const GridSpec &spec, const Int3 &ranks) {
  const bool flat = spec.cells[2] == 1;
  if (flat && ranks[2] != 1) return false;
  for (int d = 0; d < 3; ++d)
    if (!wide_enough(starts_of(spec, ranks, d), !(flat && d == 2))) return false;
  return true;
}

}  // namespace

Int3 Domain::decompose(const GridSpec &spec, int ranks) {
  constexpr double min_cost_ratio = 1.3;  // ratio of costs from which x is split more than necessary
  constexpr double cell_cost = .125;  // relative to the cost of a ghost cell of one layer in all exchanges of a step
  Int3 best{0, 0, 0}, with_shorter_rows{0, 0, 0};
  if (!spec.starts[0].empty()) {
    for (int d = 0; d < 3; ++d) best[d] = static_cast<int>(spec.starts[d].size()) - 1;
    return best[0] * best[1] * best[2] == ranks && fits(spec, best) ? best : with_shorter_rows;
  }
  double best_cost = 0, cost_with_shorter_rows = 0;
  for (int px = 1; px <= ranks; ++px) {
    if (ranks % px) continue;
    if (spec.processors[0] && px != spec.processors[0]) continue;
    const bool is_least_split = best[0] == 0 || best[0] == px;
    if (!is_least_split && spec.cells[0] < sum_block * px) break;
    for (int py = 1; py <= ranks / px; ++py) {
      if ((ranks / px) % py) continue;
      const Int3 trial{px, py, ranks / px / py};
      if (spec.processors[1] && py != spec.processors[1]) continue;
      if (spec.processors[2] && trial[2] != spec.processors[2]) continue;
      if (!fits(spec, trial)) continue;
      // The cost of the largest box: its ghost cells per layer, where a split of z is preferred because planes are
      // contiguous, and the cells that it has more than the mean.
      const Int3 n = largest_box(spec, trial);
      const double size = double(n[0]) * n[1] * n[2],
                   mean = double(spec.cells[0]) * spec.cells[1] * spec.cells[2] / ranks;
      const double cost = double(n[0]) * ((py > 1) * n[2] * 1.001 + (trial[2] > 1) * n[1]) +
                          double(px > 1) * n[1] * n[2] + cell_cost * (size - mean);
      Int3 &chosen = is_least_split ? best : with_shorter_rows;
      double &chosen_cost = is_least_split ? best_cost : cost_with_shorter_rows;
      if (chosen[0] != 0 && cost >= chosen_cost) continue;
      chosen = trial;
      chosen_cost = cost;
    }
  }
  return with_shorter_rows[0] != 0 && best_cost > min_cost_ratio * cost_with_shorter_rows ? with_shorter_rows : best;
}

Int3 Domain::largest_box(const GridSpec &spec, const Int3 &ranks) {
  Int3 most{0, 0, 0};
  for (int d = 0; d < 3; ++d) {
    const std::vector<int> starts = starts_of(spec, ranks, d);
    for (int p = 0; p < ranks[d]; ++p) most[d] = std::max(most[d], starts[p + 1] - starts[p]);
  }
  return most;
}

std::string Domain::refusal_reason(const GridSpec &spec, int ranks) {
  for (int d = 0; d < (spec.cells[2] == 1 ? 2 : 3); ++d)
    if (spec.cells[d] < stencil_width)
      return "-grid_cells: " + std::to_string(spec.cells[d]) + " in " + "xyz"[d] +
             "; accepted: at least 3 in x and y, 1 (2-D) or at least 3 in z";
  if (decompose(spec, ranks)[0]) return {};
  std::string text = std::to_string(ranks) + (ranks > 1 ? " ranks" : " rank") + " cannot share " +
                     std::to_string(spec.cells[0]) + " x " + std::to_string(spec.cells[1]) + " x " +
                     std::to_string(spec.cells[2]) + " cells";
  std::string option = "-grid_cells: ", rule = "; accepted: ";
  if (spec.processors[0] || spec.processors[1] || spec.processors[2]) {
    text += " as " + std::to_string(spec.processors[0]) + " x " + std::to_string(spec.processors[1]) + " x " +
            std::to_string(spec.processors[2]) + " ranks (0 = free)";
    option = "-da_processors_x, _y, _z: ";
    rule += "a product of " + std::to_string(ranks) + ", and ";
  }
  return option + text + rule + "at least 3 cells per rank in every direction";
}

Domain Domain::planned(const GridSpec &spec, int ranks) {
  Domain domain;
  domain.divide(spec, ranks);
  static_cast<Box &>(domain) = domain.split_.box_of(0, domain.spec_, spec.ghosts);
  return domain;
}

void Domain::divide(const GridSpec &spec, int ranks) {
  spec_ = spec;
  ranks_ = ranks;
  if (spec_.cells[2] == 1) spec_.boundary[2] = Boundary::periodic;
  for (int d = 0; d < 3; ++d)
    if (spec_.boundary[d] != Boundary::wall) spec_.open[d] = {};
  const Int3 parts = decompose(spec, ranks);
  for (int d = 0; d < 3; ++d) split_.starts[d] = starts_of(spec, parts, d);
}

PetscErrorCode Domain::create(MPI_Comm comm, const GridSpec &spec) {
  int ranks;
  PetscFunctionBeginUser;
  comm_ = comm;
  PetscCallMPI(MPI_Comm_rank(comm, &rank_));
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  const std::string reason = refusal_reason(spec, ranks);
  PetscCheck(reason.empty(), comm, PETSC_ERR_ARG_SIZ, "%s", reason.c_str());
  divide(spec, ranks);
  PetscCall(create_dm(true, DMDA_STENCIL_BOX, spec.ghosts, dm_.put()));
  PetscCall(read_dm());
  PetscFunctionReturn(0);
}

PetscErrorCode Domain::create_cell_dm(DMDAStencilType stencil, int width, DM *dm) const {
  return create_dm(false, stencil, width, dm);
}

// With `high_faces` a direction with boundaries has one point more than cells.
PetscErrorCode Domain::create_dm(bool high_faces, DMDAStencilType stencil, int width, DM *dm) const {
  PetscFunctionBeginUser;
  std::array<std::vector<PetscInt>, 3> counts;
  std::array<DMBoundaryType, 3> type{};
  Int3 points = spec_.cells;
  for (int d = 0; d < 3; ++d) {
    for (int p = 0; p < processors(d); ++p) counts[d].push_back(split_.cells_along(d, p));
    const bool wall = spec_.is_wall(d), more = wall && high_faces;
    if (d < spec_.dimension()) width = std::min<int>(width, *std::min_element(counts[d].begin(), counts[d].end()));
    counts[d].back() += more;
    points[d] += more;
    type[d] = !wall ? DM_BOUNDARY_PERIODIC : high_faces ? DM_BOUNDARY_GHOSTED : DM_BOUNDARY_NONE;
  }
  PetscCall(DMDACreate(comm_, dm));
  PetscCall(DMSetDimension(*dm, spec_.dimension()));
  PetscCall(DMDASetSizes(*dm, points[0], points[1], points[2]));
  PetscCall(DMDASetNumProcs(*dm, processors(0), processors(1), processors(2)));
  PetscCall(DMDASetOwnershipRanges(*dm, counts[0].data(), counts[1].data(), counts[2].data()));
  PetscCall(DMDASetBoundaryType(*dm, type[0], type[1], type[2]));
  PetscCall(DMDASetDof(*dm, 1));
  PetscCall(DMDASetStencilType(*dm, stencil));
  PetscCall(DMDASetStencilWidth(*dm, width));
  PetscCall(DMSetFromOptions(*dm));
  PetscCall(DMSetUp(*dm));
  PetscFunctionReturn(0);
}

// Reads the points of all ranks from the DMDA, and makes the box of this rank.
PetscErrorCode Domain::read_dm() {
  const PetscInt *points[3];
  PetscInt begin[3], count[3];
  PetscFunctionBeginUser;
  PetscCall(DMDAGetOwnershipRanges(dm_.get(), &points[0], &points[1], &points[2]));
  PetscCall(DMDAGetCorners(dm_.get(), &begin[0], &begin[1], &begin[2], &count[0], &count[1], &count[2]));
  Int3 first, cells;
  for (int d = 0; d < 3; ++d) {
    const int N = spec_.cells[d];  // point N, on a high boundary, is not a cell
    for (int p = 0; p < processors(d); ++p)
      split_.starts[d][p + 1] = std::min(N, split_.starts[d][p] + (points[d] ? static_cast<int>(points[d][p]) : 1));
    first[d] = static_cast<int>(begin[d]);
    cells[d] = std::min(N, static_cast<int>(begin[d] + count[d])) - first[d];
  }
  static_cast<Box &>(*this) = Box(spec_, first, cells, spec_.ghosts, processors(0) == 1);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
