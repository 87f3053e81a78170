// Bounds that stop a run with wrong numbers: -guard_*, and fields that are not finite.
//
// They check numbers that are measured anyway: the limits of the time step and the measures of the flow. The position
// of a violation is searched only if the run stops.
#pragma once

#include "adhesion/bond_records.hpp"
#include "base/petsc.hpp"
#include "bodies/measures.hpp"
#include "diagnostics/flow_measures.hpp"
#include "diagnostics/surface_loads.hpp"
#include "field/field.hpp"
#include "grid/domain.hpp"
#include "membranes/surface_measures.hpp"
#include "rigid/rigid_surfaces.hpp"
#include "scene/config.hpp"
#include "solver/solver.hpp"

namespace eulastic {

/// Why a run has to stop; empty = it continues.
struct Stop {
  std::string reason;   ///< exit_reason of summary.json: nonfinite or guard
  std::string message;  ///< one line: step, time, position, violated limit, remedy
  explicit operator bool() const { return !reason.empty(); }
};

/// The largest value of all bodies, and the label of the body that has it; 0 if there is none.
struct Largest {
  double value = 0;
  int label = 0;
};

/// A state as measured for series.csv.
struct Measured {
  double time = -1;  ///< of the state; negative: not yet
  FlowMeasures flow;
  SurfaceEnergy surface;
  std::vector<RigidLoad> loads;            ///< of the rigid ones among the bodies
  std::vector<SurfaceLoad> surface_loads;  ///< of the others that bear loads
  std::vector<BodyMeasure> bodies;         ///< that this rank owns
  std::vector<SurfaceMeasure> surfaces;    ///< of the same bodies; empty without membranes
  BondTotals bonds;                        ///< of the middle of the last step
  std::vector<BodyBonds> body_bonds;       ///< of the bodies that this rank owns; empty without adhesion
  double volume_drift = 0;                 ///< largest of all bodies
  double resolved_drift = 0;               ///< largest of the bodies of at least a few cells at the start
  int drifting_body = 0;                   ///< its label
  Real3 drifting_place{};
  double energy_made = 0;  ///< EnergyBudget::generated_share()
  Largest stretch;         ///< of all bodies
  Largest red_cell_area;   ///< of red cells: growth of the area since rest
  double mach = 0;         ///< largest speed over the sound speed of artificial compressibility; 0 = there is none
};

class Guards {
public:
  explicit Guards(const Config &config);

  /// Collective. Before a step of `dt`, from freshly measured extremes.
  PetscErrorCode before_step(const Solver &solver, const FlowExtremes &extremes, double dt, Stop *stop) const;
  /// Collective. Velocity and B of any state, and whether bodies near each other are separate.
  PetscErrorCode check_finite(const Solver &solver, Stop *stop) const;
  /// Collective. A measured state; that of the start passes.
  PetscErrorCode check(const Solver &solver, const Measured &measured, Stop *stop) const;

private:
  GuardControl control_;
  std::string pressure_advice_;
};

/// Centre of the cell with the largest sum |v_d|/h_d on its low faces; the first one if there are several. Collective.
PetscErrorCode place_of_speed(const Domain &domain, const Field &velocity, Real3 *place);
/// Centre of the cell with the largest |div v|; the first one if there are several. Reads one ghost layer. Collective.
PetscErrorCode place_of_divergence(const Domain &domain, const Field &velocity, Real3 *place);
/// Centre of the cell with this index, counted along x, then y, then z.
Real3 place_of_cell(const Box &box, double index);

}  // namespace eulastic
