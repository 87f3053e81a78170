// What is behind pressure sides: a resistance, or a resistance before a capacity that another one drains (three-element
// Windkessel). The pressure on the side follows the flow through it, implicitly (docs/method.md, section 20).
#pragma once

#include "field/boundaries.hpp"

namespace eulastic {

class OutletLoads {
public:
  /// No side has a load.
  static bool none(const BoundaryConditions &sides);

  explicit OutletLoads(const BoundaryConditions &sides);
  std::size_t bytes() const;
  int count() const { return static_cast<int>(loads_.size()); }
  /// The side of a load: direction, high.
  std::array<int, 2> side(int n) const { return {loads_[n].direction, loads_[n].high}; }
  /// What a pressure of 1 on that side alone means: p, and the flow out of each loaded side per time of it.
  void set_response(int n, Field &&pressure, const std::vector<double> &flow);

  /// Begins a step of length dt. `middle`: the time at which the pressure on the sides is that of the step; `flow`:
  /// volume that leaves through each side per time at the start of the step. Sets the pressures that are expected.
  void begin(const BoundaryConditions &sides, double middle, double dt, const std::vector<double> &flow);
  /// Ends the step. `flow` as the projection under the expected pressures has left it; returns by how much these
  /// change.
  std::vector<double> settle(double dt, const std::vector<double> &flow);
  /// increment = sum of changes times responses, ghosts included.
  void add_up(const Box &box, const std::vector<double> &changes, Field &increment) const;

  /// `sides` with the present pressures on those that are loaded.
  BoundaryConditions with_pressures(const BoundaryConditions &sides) const;
  /// Pressures of the capacities and on the sides: what is carried from step to step.
  std::vector<double *> numbers();

private:
  struct Load {
    int direction, high;
    OutletLoad spec;
    double capacity = 0;  ///< pressure of the capacity at the end of the last step
    double pressure = 0;  ///< on the side, of the last step
    /// Of the present step: pressure = base + share x flow at its end; capacity = kept + gain x that flow.
    double base = 0, share = 0, kept = 0, gain = 0;
    Field response;
    std::vector<double> flow;
  };
  std::vector<Load> loads_;
};

}  // namespace eulastic
