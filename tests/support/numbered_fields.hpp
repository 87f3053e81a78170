// A grid, and fields whose values tell their global index.
#pragma once

#include "base/rank_zero.hpp"
#include "field/boundaries.hpp"

namespace eulastic::test {

// Distinct at every point, exact in single precision.
inline double value_at(int i, int j, int k, int component = 0) {
  return i + 32 * j + 1024 * k + 0.25 * component - 500;
}

struct NumberedFields {
  explicit NumberedFields(const Int3 &cells, bool walls = true, MPI_Comm comm = run_communicator()) {
    GridSpec spec;
    spec.cells = cells;
    spec.length = {1.0, 2.0, 3.0};
    if (walls) spec.boundary = {Boundary::wall, Boundary::wall, Boundary::periodic};
    domain.create(comm, spec);
  }
  // Owned points, and the high wall of staggered directions.
  void fill(View q, const Staggering &s, int component = 0) const {
    for (int k = 0; k < domain.points_end(2, s[2]); ++k)
      for (int j = 0; j < domain.points_end(1, s[1]); ++j)
        for (int i = 0; i < domain.points_end(0, s[0]); ++i) {
          const Int3 &begin = domain.layout().begin;
          q(i, j, k) = value_at(begin[0] + i, begin[1] + j, begin[2] + k, component);
        }
  }
  Domain domain;
};

}  // namespace eulastic::test
