// Models behind pressure boundaries: a resistance, or a three-element Windkessel (a resistance, then a capacity with a
// second resistance). The pressure on the boundary follows implicitly from the flow through it (docs/method.md,
// section 20).
#pragma once

#include "field/boundaries.hpp"

namespace eulastic {

class OutletLoads {
public:
  /// Whether no boundary has a load.
  static bool none(const BoundaryConditions &sides);

  explicit OutletLoads(const BoundaryConditions &sides);
  std::size_t bytes() const;
  int count() const { return static_cast<int>(loads_.size()); }
  /// The boundary of a load: direction, high.
  std::array<int, 2> side(int n) const { return {loads_[n].direction, loads_[n].high}; }
  /// Sets the response to a pressure of 1 on the boundary of load n alone: the pressure, and the flow out of each
  /// loaded boundary per time.
  void set_response(int n, Field &&pressure, const std::vector<double> &flow);

  /// Begins a step of dt and predicts the pressures. `middle`: time of the pressure in the step; `flow`: volume per
  /// time that leaves through each boundary at the start of the step.
  void begin(const BoundaryConditions &sides, double middle, double dt, const std::vector<double> &flow);
  /// Ends the step: computes the pressures that are consistent with the loads and returns their differences from the
  /// predicted ones. `flow`: after the projection with the predicted pressures.
  std::vector<double> end(double dt, const std::vector<double> &flow);
  /// Computes increment = sum of changes times responses, including ghosts.
  void add_up(const Box &box, const std::vector<double> &changes, Field &increment) const;

  /// Returns `sides` with the present pressures of those that have loads.
  BoundaryConditions with_pressures(const BoundaryConditions &sides) const;
  /// The persistent state: pressures of the capacities and on the boundaries.
  std::vector<double *> numbers();

private:
  struct Load {
    int direction, high;
    OutletLoad spec;
    double capacity = 0;  ///< pressure of the capacity at the end of the last step
    double pressure = 0;  ///< on the boundary, of the last step
    /// Of the present step: pressure = base + share x flow at its end; capacity = kept + gain x that flow.
    double base = 0, share = 0, kept = 0, gain = 0;
    Field response;
    std::vector<double> flow;
  };
  std::vector<Load> loads_;
};

}  // namespace eulastic
