// A Poisson problem lap q = D on a grid, with functions of the global cell, its residual, and all decompositions.
#pragma once

#include "base/exact_sum.hpp"
#include "base/rank_zero.hpp"
#include "field/boundaries.hpp"
#include "pressure/pressure_solver.hpp"
#include "support/lopsided.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace eulastic::test {

using CellFunction = std::function<double(int, int, int)>;  // of the global cell

// Random in (-1, 1), a function of the global index alone.
inline double noise(int i, int j, int k) {
  const double x = 43758.5453 * std::sin(12.9898 * i + 78.233 * j + 37.719 * k);
  return 2 * (x - std::floor(x)) - 1;
}

inline double global_sum(const Domain &domain, const CellFunction &local) {
  ExactSums sum(1);
  std::vector<double> row(domain.cells()[0]);
  for (const Segment &s : domain.rows()) {
    for (int i = 0; i < s.i_end; ++i) row[i] = local(i, s.j, s.k);
    sum.add_row(0, row.data(), s.i_end, domain.layout().begin[0]);
  }
  double total = 0;
  EXPECT_EQ(sum.reduce(domain.comm(), &total), 0);
  return total;
}

struct PoissonScene {
  static constexpr double dt = 0.37;
  Domain domain;
  std::unique_ptr<GhostExchange> exchange;
  Field divergence, pressure, increment;

  PoissonScene(MPI_Comm comm, const GridSpec &spec) {
    EXPECT_EQ(domain.create(comm, spec), 0);
    exchange = std::make_unique<GhostExchange>(domain);
    divergence = Field(domain, 1);
    pressure = Field(domain, 1);
    increment = Field(domain, 1);
    increment.fill(0, std::nan(""));  // so that a ghost nobody filled shows
  }
  void set(const CellFunction &f, bool without_mean = true) {
    const Layout &own = domain.layout();
    for (const Segment &s : domain.rows())
      for (int i = 0; i < s.i_end; ++i)
        divergence[0](i, s.j, s.k) = f(own.begin[0] + i, own.begin[1] + s.j, own.begin[2] + s.k);
    const ConstView D = divergence[0];
    const double mean = without_mean ? global_sum(domain, D) / domain.domain_cell_count() : 0;
    for (const Segment &s : domain.rows())
      for (int i = 0; i < s.i_end; ++i) divergence[0](i, s.j, s.k) -= mean;
    EXPECT_EQ(exchange->update_ghosts(divergence, 1), 0);
    fill_wall_ghosts_even(domain, at_centre, divergence[0], 1);
  }
  // D - dt lap increment, from the ghosts of the increment.
  double residual(int i, int j, int k) const {
    const ConstView q = increment[0];
    double laplacian = 0;
    for (int d = 0; d < domain.dimension(); ++d) {
      const double *at = q.row(j, k) + i;
      const double h = domain.spacing()[d];
      laplacian += (at[-q.stride(d)] - 2 * at[0] + at[q.stride(d)]) / (h * h);
    }
    return divergence[0](i, j, k) - dt * laplacian;
  }
  double rms(const CellFunction &local) const {
    return std::sqrt(global_sum(domain, [&](int i, int j, int k) { return std::pow(local(i, j, k), 2); }) /
                     domain.domain_cell_count());
  }
  double rms_divergence() const { return rms(divergence[0]); }
  double rms_residual() const {
    return rms([&](int i, int j, int k) { return residual(i, j, k); });
  }
};

inline std::vector<GridSpec> all_boundaries(const Int3 &cells) {
  std::vector<GridSpec> specs;
  for (int walls = 0; walls < (cells[2] == 1 ? 4 : 8); ++walls) {
    GridSpec spec;
    spec.cells = cells;
    spec.length = {1.7, 0.9, 2.3};
    for (int d = 0; d < 3; ++d) spec.boundary[d] = walls >> d & 1 ? Boundary::wall : Boundary::periodic;
    specs.push_back(spec);
  }
  return specs;
}

// Every way to share the cells of `spec` among the ranks of this run. `sums` are the same only where x is not cut
// inside a block of 256 cells.
inline std::vector<GridSpec> all_decompositions(GridSpec spec, bool sums = true) {
  int ranks = 0;
  MPI_Comm_size(run_communicator(), &ranks);
  std::vector<GridSpec> specs;
  for (int px = 1; px <= ranks; ++px)
    for (int py = 1; py <= ranks / px; ++py) {
      if (ranks % (px * py) || (sums && px > 1 && spec.cells[0] < 256 * px)) continue;
      spec.processors = {px, py, ranks / (px * py)};
      add_splits(spec, &specs);
    }
  return specs;
}

inline std::string name(const GridSpec &s) {
  std::string text;
  for (int d = 0; d < 3; ++d)
    text += std::to_string(s.cells[d]) + (s.boundary[d] == Boundary::wall ? " wall" : " periodic") + " on " +
            std::to_string(s.processors[d]) + "; ";
  return text;
}

}  // namespace eulastic::test
