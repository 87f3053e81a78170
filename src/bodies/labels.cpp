#include "bodies/labels.hpp"

#include "base/events.hpp"
#include "grid/threads.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace eulastic {
namespace {

constexpr int layers = 4;

// A label that a cell may take. While labels spread, confirmed labels are positive and old, unconfirmed ones negative.
struct Candidate {
  double label = 0, phi = 0;
  bool face = false;

  bool better_than(const Candidate &other) const noexcept {
    if ((label > 0) != (other.label > 0)) return label > 0;
    if (face != other.face) return face;
    if (phi != other.phi) return phi > other.phi;
    return std::abs(label) < std::abs(other.label);
  }
};

// A cell whose label is not confirmed yet.
struct OpenCell {
  Int3 cell;
  double label;
};

// Existing cells along each direction, including one ghost layer.
using Reach = std::array<Box::Range, 3>;

// Returns the best neighbour of local cell c, with label 0 if there is none. Confirmed face neighbours come first.
Candidate best_neighbour(const Int3 &c, const Reach &reach, ConstView phi, ConstView label) {
  Candidate best;
  const auto consider = [&](int i, int j, int k, bool face) {
    const double value = label(i, j, k);
    if (value == 0) return;
    const Candidate other{value, phi(i, j, k), face};
    if (best.label == 0 || other.better_than(best)) best = other;
  };
  for (int d = 0; d < 3; ++d)
    for (const int side : {-1, 1}) {
      Int3 at = c;
      at[d] += side;
      if (at[d] >= reach[d].begin && at[d] < reach[d].end) consider(at[0], at[1], at[2], true);
    }
  if (best.label > 0) return best;
  const auto first = [&](int d) { return std::max(c[d] - 1, reach[d].begin); };
  const auto end = [&](int d) { return std::min(c[d] + 2, reach[d].end); };
  for (int k = first(2); k < end(2); ++k)
    for (int j = first(1); j < end(1); ++j)
      for (int i = first(0); i < end(0); ++i)
        if ((i != c[0]) + (j != c[1]) + (k != c[2]) > 1) consider(i, j, k, false);
  return best;
}

// The cells of a part of the rows whose labels change.
struct OpenCells {
  std::vector<OpenCell> open;
  std::vector<Int3> emptied;  // keep their old label until neighbours have seen it: a body may have left all its cells
};

OpenCells open_cells(const Box &box, const RowPart &part, ConstView phi, View label) {
  OpenCells cells;
  for (const Segment &row : part.rows(box)) {
    const double *fraction = phi.row(row.j, row.k);
    double *own = label.row(row.j, row.k);
    for (int i = row.i_begin; i < row.i_end; ++i) {
      if (fraction[i] <= label_threshold) {
        if (own[i] == 0) continue;  // no write: the page may be shared (Field::on_demand)
        own[i] = -own[i];
        cells.emptied.push_back({i, row.j, row.k});
        continue;
      }
      if (fraction[i] <= 0.5) own[i] = -own[i];
      if (own[i] <= 0) cells.open.push_back({{i, row.j, row.k}, own[i]});
    }
  }
  return cells;
}

// Collects only the cells without a label.
OpenCells new_cells(const Box &box, const RowPart &part, const OccupiedRows &rows, ConstView phi, View label) {
  OpenCells cells;
  for (const Segment &whole : part.rows(box)) {
    const Segment row = rows.within(whole);
    const double *fraction = phi.row(row.j, row.k), *own = label.row(row.j, row.k);
    for (int i = row.i_begin; i < row.i_end; ++i)
      if (own[i] == 0 && fraction[i] > label_threshold) cells.open.push_back({{i, row.j, row.k}, 0});
  }
  return cells;
}

PetscErrorCode carry(const Box &box, GhostExchange &exchange, bool only_new, Phase *phase) {
  PetscFunctionBeginUser;
  EventScope scope(Event::bodies);
  PetscCall(exchange.update_ghosts(phase->fraction, 1, &phase->rows));
  const ConstView phi = phase->fraction[0];
  const View label = phase->label[0];
  std::vector<OpenCells> cells(row_parts(box));
  in_row_parts(box, [&](const RowPart &part) {
    cells[part.number] = only_new ? new_cells(box, part, phase->rows, phi, label) : open_cells(box, part, phi, label);
  });
  const auto with_ghosts = [&](int d) { return box.points_with_ghosts(d, false, 1); };
  const Reach reach{with_ghosts(0), with_ghosts(1), with_ghosts(2)};
  for (int layer = 0; layer < layers; ++layer) {
    PetscCall(exchange.update_ghosts(phase->label, 1, &phase->rows));
    in_row_parts(box, [&](const RowPart &part) {
      for (OpenCell &o : cells[part.number].open) {
        const Candidate best = best_neighbour(o.cell, reach, phi, label);
        if (best.label > 0 || o.label == 0) o.label = best.label;
      }
    });
    in_row_parts(box, [&](const RowPart &part) {
      std::vector<OpenCell> &own = cells[part.number].open;
      for (const OpenCell &o : own) label(o.cell[0], o.cell[1], o.cell[2]) = o.label;
      own.erase(std::remove_if(own.begin(), own.end(), [](const OpenCell &o) { return o.label > 0; }), own.end());
    });
  }
  for (const OpenCells &part : cells) {
    for (const OpenCell &o : part.open) label(o.cell[0], o.cell[1], o.cell[2]) = std::abs(o.label);
    for (const Int3 &c : part.emptied) label(c[0], c[1], c[2]) = 0;
  }
  PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode carry_labels(const Box &box, GhostExchange &exchange, Phase *phase) {
  return carry(box, exchange, false, phase);
}

PetscErrorCode label_new_cells(const Box &box, GhostExchange &exchange, Phase *phase) {
  return carry(box, exchange, true, phase);
}

}  // namespace eulastic
