// Grids with open sides, one or more of them, in every direction and beside every kind of other side.
#pragma once

#include "support/poisson_scene.hpp"

namespace eulastic::test {

inline std::vector<GridSpec> open_boundaries(const Int3 &cells) {
  const int dimension = cells[2] == 1 ? 2 : 3;
  std::vector<GridSpec> specs;
  const auto add = [&](int walls, std::initializer_list<std::array<int, 2>> open) {
    GridSpec spec;
    spec.cells = cells;
    spec.length = {1.7, 0.9, 2.3};
    for (int d = 0; d < dimension; ++d) spec.boundary[d] = walls >> d & 1 ? Boundary::wall : Boundary::periodic;
    for (const auto &[d, high] : open) spec.open[d][high] = true;
    specs.push_back(spec);
  };
  const int all = (1 << dimension) - 1;
  for (int d = 0; d < dimension; ++d) {
    for (int high = 0; high < 2; ++high) {
      add(all, {{d, high}});
      add(1 << d, {{d, high}});
    }
    add(all, {{d, 0}, {d, 1}});
    add(1 << d, {{d, 0}, {d, 1}});
    add(all, {{d, 1}, {(d + 1) % dimension, 0}});
  }
  return specs;
}

inline std::string open_name(const GridSpec &spec) {
  std::string text = name(spec) + "open:";
  for (int d = 0; d < 3; ++d)
    for (int high = 0; high < 2; ++high)
      if (spec.open[d][high]) text += std::string(" ") + "xyz"[d] + (high ? "max" : "min");
  return text;
}

}  // namespace eulastic::test
