#include "bodies/leaving.hpp"

namespace eulastic {
bool has_solid(const Grid &grid, ConstView fraction, int d, bool high, int layers, double more_than) {
  bool any = false;
  for_points(grid.cells_at(d, high, layers), [&](int i, int j, int k) { any = any || fraction(i, j, k) > more_than; });
  return any;
}

void mark_leaving(const Grid &grid, int d, bool high, int layers, Phase *phase, std::set<int> *leaves) {
  const View fraction = phase->fraction[0], label = phase->label[0];
  for_points(grid.cells_at(d, high, layers), [&](int i, int j, int k) {
    if (!(fraction(i, j, k) > 0)) return;
    if (label(i, j, k) > 0)
      leaves->insert(static_cast<int>(label(i, j, k)));
    else
      fraction(i, j, k) = 0;
  });
}

void take_out(const Grid &grid, const std::set<int> &leaves, Phase *phase) {
  const View fraction = phase->fraction[0], label = phase->label[0];
  for_points(grid.rows(), [&](int i, int j, int k) {
    double &name = label(i, j, k);
    if (!(name > 0 && leaves.count(static_cast<int>(name)) > 0)) return;
    fraction(i, j, k) = 0;
    name = 0;
  });
}

}  // namespace eulastic
