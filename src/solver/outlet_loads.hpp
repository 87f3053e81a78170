// What is behind pressure sides: a resistance, or a resistance before a capacity that another one drains (three-element
// Windkessel). The pressure on the side follows the flow through it, implicitly (docs/method.md, section 20).
#pragma once

#include "field/sides.hpp"

namespace eulastic {

class OutletLoads {
public:
  /// No side has a load.
  static bool none(const BoxSides &sides);

  explicit OutletLoads(const BoxSides &sides);
  std::size_t bytes() const;
  int count() const { return static_cast<int>(loads_.size()); }
  /// The side of a load: direction, high.
  std::array<int, 2> side(int n) const { return {loads_[n].direction, loads_[n].high}; }
  /// What a pressure of 1 on that side alone means: p, and the flow out of each loaded side per time of it.
  void set_response(int n, FieldBlock &&pressure, const std::vector<double> &flow);

  /// Begins a step of length dt to `time` + dt; the capacities go on by `between`, to its middle. `flow`: volume that
  /// leaves through each per time, now. Sets the pressures that are expected.
  void begin(const BoxSides &sides, double middle, double between, const std::vector<double> &flow);
  /// `flow` as the projection under the expected pressures has left it; returns by how much these change.
  std::vector<double> settle(double dt, const std::vector<double> &flow);
  /// increment = sum of changes times responses, ghosts included.
  void add_up(const Grid &grid, const std::vector<double> &changes, FieldBlock &increment) const;

  /// `sides` with the present pressures on those that are loaded.
  BoxSides with_pressures(const BoxSides &sides) const;
  /// Pressures of the capacities and on the sides: what is carried from step to step.
  std::vector<double> numbers() const;
  void set_numbers(const std::vector<double> &numbers);

private:
  struct Load {
    int direction, high;
    OutletLoad spec;
    double capacity = 0;            ///< its pressure
    double pressure = 0, base = 0;  ///< on the side; base: without what the flow at the end of the step adds
    FieldBlock response;
    std::vector<double> flow;
  };
  std::vector<Load> loads_;
};

}  // namespace eulastic
