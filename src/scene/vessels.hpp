// Measures of vessels: the flow through their lumen, and its loads on elastic vessels.
#pragma once

#include "base/petsc.hpp"
#include "diagnostics/side_flows.hpp"
#include "diagnostics/surface_loads.hpp"
#include "scene/config.hpp"
#include "solver/solver.hpp"

namespace eulastic {

/// The flow through the lumen of a tube.
struct VesselFlow {
  std::string species;
  double flow_rate = 0;           ///< volume along its axis per time; 2-D: per depth
  double apparent_viscosity = 0;  ///< dynamic, by Poiseuille's law from the driving pressure; 0 without flow
};

/// Returns the flow in every tube, constricted or not, whose axis lies in the box. `bulk`: mean velocity in the box;
/// `sides`: measured flows through the boundaries.
std::vector<VesselFlow> vessel_flows(const Config &config, double time, const Real3 &bulk,
                                     const std::vector<SideFlow> &sides);

/// Measures the loads of all elastic bodies that bear loads, in the order of the bodies. Collective.
PetscErrorCode measure_vessel_loads(const Config &config, Solver *solver, std::vector<SurfaceLoad> *loads);

}  // namespace eulastic
