#include "openings/leaving.hpp"

#include "bodies/labels.hpp"

#include <algorithm>

namespace eulastic {
bool has_solid(const Box &box, ConstView fraction, int d, bool high, int layers, double more_than) {
  bool any = false;
  for_points(box.boundary_cells(d, high, layers),
             [&](int i, int j, int k) { any = any || fraction(i, j, k) > more_than; });
  return any;
}

bool leaves_whole(const Material &material) { return material.has_surface() || material.viscosity > 0; }

namespace {

// Returns the cells of a block that are more than `layers` layers away from every open boundary.
Extent away_from_open_sides(const Box &box, int layers) {
  Extent away{{0, 0, 0}, box.cells()};
  for (int d = 0; d < box.dimension(); ++d) {
    const int first = box.layout().begin[d], last = box.domain_cells()[d] - layers - first;
    if (box.is_open(d, false)) away.begin[d] = std::max(away.begin[d], layers - first);
    if (box.is_open(d, true)) away.end[d] = std::min(away.end[d], last);
  }
  return away;
}

}  // namespace

bool leaves_box(const BodyInBox &body) {
  const Box &box = *body.box;
  const ConstView phi = body.phase->fraction[0];
  bool at_open_side = false;
  for (const auto [d, high] : box.sides())
    at_open_side = at_open_side || (box.is_open(d, high) && has_solid(box, phi, d, high, free_layers, 0));
  if (!at_open_side || leaves_whole(body.phase->material)) return at_open_side;
  bool leaves = true;
  for_points(away_from_open_sides(box, free_layers),
             [&](int i, int j, int k) { leaves = leaves && !(phi(i, j, k) > BodyCells::threshold); });
  return leaves;
}

void mark_staying(const Box &box, int layers, const Phase &phase, std::map<int, Leaving> *leaves) {
  const BodyCells cells{phase.label[0], phase.fraction[0]};
  for_points(away_from_open_sides(box, layers), [&](int i, int j, int k) {
    if (const int label = static_cast<int>(cells(i, j, k)); label > 0)
      if (const auto found = leaves->find(label); found != leaves->end()) found->second = Leaving::stays;
  });
}

void mark_leaving(const Box &box, int d, bool high, int layers, bool whole, Phase *phase,
                  std::map<int, Leaving> *leaves) {
  const View fraction = phase->fraction[0], label = phase->label[0];
  for_points(box.boundary_cells(d, high, layers), [&](int i, int j, int k) {
    if (!(fraction(i, j, k) > 0)) return;
    if (label(i, j, k) > 0)
      (*leaves)[static_cast<int>(label(i, j, k))] = Leaving::leaves;
    else if (whole)
      fraction(i, j, k) = 0;
  });
}

void remove_leaving(const Box &box, const std::map<int, Leaving> &leaves, Phase *phase) {
  const View fraction = phase->fraction[0], label = phase->label[0];
  for_points(box.rows(), [&](int i, int j, int k) {
    double &name = label(i, j, k);
    if (!(name > 0)) return;
    const auto found = leaves.find(static_cast<int>(name));
    if (found == leaves.end() || found->second != Leaving::leaves) return;
    fraction(i, j, k) = 0;
    name = 0;
  });
}

}  // namespace eulastic
