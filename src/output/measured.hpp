// All that is measured of a state for series.csv, bodies.h5, the guards and the verdicts.
#pragma once

#include "adhesion/bond_records.hpp"
#include "bodies/measures.hpp"
#include "diagnostics/energy_budget.hpp"
#include "diagnostics/flow_measures.hpp"
#include "diagnostics/side_flows.hpp"
#include "diagnostics/surface_loads.hpp"
#include "membranes/surface_measures.hpp"
#include "rigid/rigid_surfaces.hpp"

namespace eulastic {

/// The largest value of all bodies, and the label of the body that has it; 0 if there is none.
struct Largest {
  double value = 0;
  int label = 0;
};

/// A state as measured for a row of series.csv.
struct Measured {
  double time = -1;         ///< of the state; negative: not yet
  double dt = 0, step = 0;  ///< of the step that led to it
  int body_count = 0;       ///< of the whole box
  EnergyState energy;
  std::vector<SideFlow> sides;  ///< boundaries that volume crosses
  FlowMeasures flow;
  SurfaceEnergy surface;
  std::vector<RigidLoad> loads;            ///< of the rigid ones among the bodies
  std::vector<SurfaceLoad> surface_loads;  ///< of the others that bear loads
  std::vector<BodyMeasure> bodies;         ///< that this rank owns
  std::vector<SurfaceMeasure> surfaces;    ///< of the same bodies; empty without membranes
  BondTotals bonds;                        ///< of the middle of the last step
  std::vector<BodyBonds> body_bonds;       ///< of the bodies that this rank owns; empty without adhesion
  double volume_drift = 0;                 ///< largest of all bodies
  Largest resolved_drift;                  ///< of the bodies of at least a few cells at the start
  Real3 drifting_place{};                  ///< centroid of the body with resolved_drift
  double energy_made = 0;                  ///< EnergyBudget::generated_share()
  Largest stretch;                         ///< of all bodies
  Largest red_cell_area;                   ///< of red cells: growth of the area since rest
  double mach = 0;  ///< largest speed over the sound speed of artificial compressibility; 0 = there is none
};

}  // namespace eulastic
