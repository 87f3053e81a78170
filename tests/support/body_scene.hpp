// Bodies of some phases and a velocity on a grid, for tests of what is measured of bodies.
#pragma once

#include "bodies/fill_phase.hpp"
#include "bodies/measures.hpp"
#include "bodies/shapes.hpp"
#include "diagnostics/energy_rates.hpp"
#include "support/all_bodies.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace eulastic::test {

inline GridSpec box(const Int3 &cells, const Real3 &length) {
  GridSpec spec;
  spec.cells = cells;
  spec.length = length;
  return spec;
}

inline SpeciesSpec species(Shape shape, double radius, const Real3 &semi_axes = {}, const Real3 &orientation = {}) {
  SpeciesSpec spec;
  spec.shape = shape;
  spec.radius = radius;
  spec.semi_axes = semi_axes;
  spec.orientation = orientation;
  return spec;
}

// One phase of bodies and a velocity field on a grid of `comm`.
struct BodyScene {
  Domain domain;
  std::vector<Phase> phases;
  Field velocity;
  BodyTracker tracker;

  BodyScene(MPI_Comm comm, const GridSpec &spec) {
    EXPECT_EQ(domain.create(comm, spec), 0);
    velocity = Field(domain, domain.dimension());
  }
  void add(const SpeciesSpec &spec, const Places &places) {
    phases.emplace_back();
    EXPECT_EQ(fill_phase(domain, spec, places, 1 + tracker.bodies(), &phases.back()), 0);
    tracker.add_phase(domain, places);
  }
  /// Only the fraction moves to `places`: what an interface scheme does.
  void move(const SpeciesSpec &spec, const Places &places) {
    Phase moved;
    EXPECT_EQ(fill_phase(domain, spec, places, 1, &moved), 0);
    phases[0].fraction.swap(moved.fraction);
  }
  template <class Function>  // velocity component d at x, ghosts included
  void set_velocity(Function &&function) {
    for (int d = 0; d < domain.dimension(); ++d)
      for (int k = -domain.layout().ghosts[2]; k < domain.cells()[2] + domain.layout().ghosts[2]; ++k)
        for (int j = -3; j < domain.cells()[1] + 3; ++j)
          for (int i = -3; i < domain.cells()[0] + 3; ++i) {
            const Int3 local{i, j, k};
            Real3 x{};
            for (int e = 0; e < 3; ++e) {
              const int n = domain.domain_cells()[e], global = (domain.layout().begin[e] + local[e] + n) % n;
              x[e] = (global + (e == d ? 0.0 : 0.5)) * domain.spacing()[e];
            }
            velocity[d](i, j, k) = function(d, x);
          }
  }
  /// B_xx of every body by 1 + sin(7 x)/2: strains that differ from cell to cell.
  void strain() {
    for (Phase &phase : phases)
      for (const Segment &row : domain.rows())
        for (int i = 0; i < row.i_end; ++i)
          if (phase.fraction[0](i, row.j, row.k) > 0)
            phase.tensor.field[0](i, row.j, row.k) *= 1 + std::sin(7 * (domain.layout().begin[0] + i)) / 2;
  }
  // Of all bodies, on every rank.
  std::vector<BodyMeasure> measure() {
    std::vector<BodyMeasure> owned, all;
    const int bodies = tracker.bodies();
    EXPECT_EQ(tracker.measure(domain, phases, velocity, strain_energy, &owned), 0);
    EXPECT_EQ(all_bodies(domain.comm(), bodies, bodies, owned, &all), 0);
    return all;
  }
};

inline double wrap(double x, double length) { return x - length * std::floor(x / length); }

}  // namespace eulastic::test
