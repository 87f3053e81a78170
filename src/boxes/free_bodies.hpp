// Elastic bodies, membranes and drops that are not anchored and never merge with others: each is stored in a box of its
// own, an aligned block of the grid around the body, which is complete on one rank. A body receives the velocity and
// sends its force; no other messages are needed (docs/architecture.md).
#pragma once

#include "base/events.hpp"
#include "base/petsc.hpp"
#include "boxes/box_exchange.hpp"
#include "drops/surface_tension.hpp"
#include "field/net_force.hpp"
#include "field/phase.hpp"
#include "field/receptor.hpp"
#include "membranes/membrane.hpp"
#include "solids/interface.hpp"
#include "solids/solid_transport.hpp"

#include <cstdint>
#include <map>
#include <vector>

namespace eulastic {

class FreeBodies {
public:
  struct Body {
    int number;                               ///< label, from 1 on, unique over all ranks
    int species;                              ///< index
    Box box;                                  ///< its indices do not wrap around periodic boundaries
    Phase phase;                              ///< of this body alone, on the box; no labels
    SegmentValues force;                      ///< per mass of the fluid, on the faces forced()
    std::vector<SurfaceMarker> markers = {};  ///< of a membrane, with cells that are not wrapped either
    WallFilm film = {};                       ///< the same: walls in the box
    std::vector<SurfaceSample> surface = {};  ///< the same, as of `force`, without velocities; may be missing
    ActiveSegments tension_faces = {};        ///< with surface tension: faces on which it or the stress acts
    std::vector<Receptor> receptors = {};     ///< of adhesion
    const ActiveSegments &forced() const {
      return phase.material.surface_tension > 0 ? tension_faces : phase.tensor.stressed;
    }
  };

  /// `sides` must outlive this. `extends`: B is extended outside bodies; else it is I there.
  FreeBodies(const Domain &domain, const Fluid &fluid, const BoundaryConditions &sides, bool extends = true);

  /// Adds a body to this rank: `phase` has material, rule and the owned cells of phi and B on `box`, which may be any
  /// block that holds the body.
  PetscErrorCode add(int number, int species, const Box &box, Phase &&phase, std::vector<SurfaceMarker> &&markers = {},
                     std::vector<Receptor> &&receptors = {});
  /// Returns a body of this rank as numbers for add_packed(): label, species, first cell and cells of a block around it
  /// and number of its markers (the head), then phi and the components of B of that block, the markers and the
  /// receptors.
  std::vector<double> packed(std::size_t body) const;
  static constexpr int head = 9;  ///< numbers before phi
  /// Returns the number of values of a body between its head and its receptors. `centred`: all components of B are
  /// stored at centres.
  static std::size_t packed_values(const DomainShape &domain, bool centred, const double *head);
  /// Adds a body from the result of packed(). `like`: a phase with its material and rule.
  PetscErrorCode add_packed(const std::vector<double> &packed, const Phase &like);
  /// Adds a copy, labelled `copy`, of the body `number` of this rank, moved by `shift` cells; its receptors are free.
  /// `like`: as for add_packed().
  PetscErrorCode add_copy(int number, int copy, const Int3 &shift, const Phase &like);
  /// Sends the bodies of this rank to `ranks` (one for each body, in their order). `species`: phases with the materials
  /// and rules of all species. Collective.
  PetscErrorCode give(const std::vector<int> &ranks, const std::vector<Phase> &species);
  /// Removes bodies of this rank, by ascending index in bodies(). Call follow() afterwards on all ranks.
  void remove(const std::vector<std::size_t> &which);
  void clear();

  /// Call before follow() if any species has a surface that exerts forces. `drifts`: no wall resists the flow, so that
  /// a net force of surfaces would accelerate all of it; `rigid`: phases of rigid bodies that do not move.
  void set_surroundings(bool drifts, const std::vector<const Phase *> &rigid);
  /// Refits all boxes if bodies have been added or removed, or if a body has come close to the end of its box.
  /// Collective.
  PetscErrorCode follow();
  /// Computes B_s of membranes from B of their bodies (MembraneMechanics::start()).
  PetscErrorCode start_membranes();
  /// Places markers on the membranes that need them and have none, with the strain of the membrane.
  PetscErrorCode place_markers();
  struct Step {
    double time;  ///< of the velocity
    double dt;
    std::int64_t number;  ///< of the step; orders the directions of the interface
  };
  /// Moves all bodies over dt with a velocity on the grid's faces, of the middle of the step, and finds their forces.
  /// `unresolved`: of all ranks, MembraneMechanics::move(). Collective.
  PetscErrorCode advance(const Step &step, const Field &velocity, long *unresolved);
  /// Adds the force per mass, times a factor, to fields of the grid. Collective.
  PetscErrorCode add_forces(const std::vector<WeightedTarget> &targets);
  /// Mean over the domain of the force per mass of bending and surface tension, an error of the discretisation; 0 where
  /// walls resist the flow.
  const Real3 &mean_force() const noexcept { return mean_force_; }
  /// Marks in `rows` (one value for each row of this rank's cells) the rows to which add_forces() may add.
  void mark_rows(std::vector<char> *rows) const { exchange_.mark_rows(rows); }
  /// Resets B where the grid does not resolve it (solids/unresolved.hpp). `trace`: the largest tr B of every species;
  /// `count`: centres of all ranks. Collective.
  PetscErrorCode reset_unresolved(const std::vector<double> &trace, long *count);

  const std::vector<Body> &bodies() const noexcept { return bodies_; }
  /// The receptors of a body, by its index in bodies().
  std::vector<Receptor> &receptors(std::size_t body) { return bodies_[body].receptors; }
  /// Version number of the set of bodies and boxes, the same on all ranks.
  long fits() const noexcept { return fits_; }
  /// Whether samples of surfaces are kept when forces are found; measure_surfaces() takes longer without them.
  void keep_surfaces(bool keep) { keeps_surfaces_ = keep; }
  /// Adds energy and power of the surfaces of `bodies`, the result of synchronise(). `samples`: of each membrane;
  /// `species`: phases with the materials. Collective.
  PetscErrorCode measure_surfaces(const std::vector<BodyInBox> &bodies, const std::vector<Phase> &species,
                                  SurfaceEnergy *measured, std::vector<std::vector<SurfaceSample>> *samples);
  /// Computes the power of stretch forces on the flow; arguments as for measure_surfaces(). Collective if any species
  /// has stretch forces.
  PetscErrorCode stretch_power(const std::vector<BodyInBox> &bodies, const std::vector<Phase> &species, double *power);
  /// Sets phi of some phases on the grid (owned points) to the sum over `bodies`, the result of synchronise() or
  /// list(). Collective.
  PetscErrorCode put_fractions_on_grid(const std::vector<BodyInBox> &bodies, const std::map<int, Phase *> &phases);
  /// Returns the bodies of this rank at their own time, without velocity.
  std::vector<BodyInBox> list() const;
  /// Returns the bodies of this rank at the time of the velocity, with the velocity in their boxes: copies moved over
  /// step.dt, or the bodies themselves if that is 0. The result is valid until bodies change. Collective.
  PetscErrorCode synchronise(const Step &step, const Field &velocity, std::vector<BodyInBox> *bodies);
  /// Adds `bodies`, the result of synchronise(), to empty phases of the grid (owned points), by species: phi is the sum
  /// over the bodies; B and the label are those of the body with the largest phi, the first one of equals. Outside all
  /// bodies, B is the extension of the first body that has one there. Collective.
  PetscErrorCode put_on_grid(const std::vector<BodyInBox> &bodies, const std::map<int, Phase *> &phases) const;
  std::size_t bytes() const;
  /// Number of doubles of a body that extends over `cells`: phi and B with the ghosts around its box, the force, and
  /// the copy and the velocity of synchronise(), which cover fewer layers if the body has no surface.
  static double values(const Material &material, int dimension, const Real3 &cells, int ghosts);

  /// Cells between a body and the ends of its box after the box has been fitted.
  static int margin(const Material &material) { return needed(material) + 2; }
  /// Reach of spans of rows beyond phi != 0 of a body, in cells: the layers around it and the motion in a step.
  /// `ghosts`: of the grid.
  static int rows_reach(const Material &material, int ghosts) {
    return (material.is_membrane() ? ghosts : ExteriorLayers::layers) + OccupiedRows::beyond_ghosts;
  }

private:
  /// Work space of one thread for a body.
  struct Tools {
    InterfaceTransport interface;
    SolidTransport solids;
    std::vector<double> memory;
  };
  /// Cells between the body and the ends of its box that a step needs: the body moves by less than one, and its stress
  /// acts on faces beyond. The rest of the margin is for the motion until the next fit.
  static int needed(const Material &material) { return 1 + (material.is_membrane() ? MembraneMechanics::reach : 1); }
  static int stage_fields(const Phase &phase);
  template <class PhaseOrConst, class Visit>
  static void for_values(const Box &block, const Int3 &first, PhaseOrConst &phase, const Visit &visit);
  /// Copies the points that two boxes share, including those on high boundaries and `layers` ghosts of the first one.
  static void copy_shared(const Box &box, const Field &from, int layers, Field *to);
  /// Returns an empty phase on a box with the material and the rule of `phase`.
  static Phase empty_like(const Phase &phase, const Box &box);
  PetscErrorCode extend(Body *body);
  bool is_near_an_end(const Body &body) const;
  PetscErrorCode fit(Body *body, int layers) const;
  /// Computes the velocity in the box of a body, including ghosts behind boundaries, after exchange_.fetch().
  void bring_velocity(std::size_t body, const Step &step, const Field &velocity, Field *flow) const;
  PetscErrorCode fit_boxes(bool *changed, long *unresolved);
  PetscErrorCode find_walls();
  PetscErrorCode find_force(Body *body);
  PetscErrorCode gather_force(MembraneMechanics &membrane, Body *body, Field &force);
  PetscErrorCode membrane_force(MembraneMechanics &membrane, const Body &body, const Phase &phase, bool of_step,
                                Field &force, std::vector<SurfaceSample> *samples);
  PetscErrorCode measure_membrane(const BodyInBox &moved, const Body &body, ExactSums *sum,
                                  std::vector<SurfaceSample> *samples);
  PetscErrorCode find_forces();
  PetscErrorCode synchronise_body(std::size_t body, const Step &step, const Field &velocity, BodyInBox *result);
  PetscErrorCode advance_body(std::size_t body, const Step &step, const Field &velocity, long *unresolved);
  PetscErrorCode move(const Box &box, const Step &step, const Field &flow, Field &stage, Phase *phase);
  PetscErrorCode move_membrane(const Step &step, const Field &flow, Body *body, Field &work, long *unresolved);
  Tools &tools() { return tools_[TeamMember::number()]; }
  Field scratch(const Box &box, int components);
  template <class Work>
  PetscErrorCode for_bodies(const Work &work);
  PetscErrorCode connect_fractions();

  const Domain *domain_;
  Fluid fluid_;
  const BoundaryConditions *sides_;
  BoxExchange exchange_, fractions_;  ///< for velocities and forces; for single fields
  bool fractions_are_connected_ = false;
  bool extends_;
  bool drifts_ = false, keeps_surfaces_ = false;
  Field walls_;  ///< solid fraction, on the grid, of rigid bodies that do not move; empty if there are none
  NetForce net_force_;
  Real3 mean_force_{};
  std::vector<Tools> tools_;  ///< of all threads
  std::vector<Body> bodies_;  ///< by their numbers
  /// Copy of a body by synchronise(). If measures need its cells alone, the box covers these and the layers of the
  /// extension of B.
  struct SynchronisedCopy {
    Box box;
    Phase moved;
    Field velocity;
  };
  std::vector<SynchronisedCopy> copies_;
  bool fitted_ = false;  ///< exchange_ has been built for the present boxes
  long fits_ = 0;
};

/// Calls work(index) for all bodies of this rank. If there are at least as many bodies as threads, each body is
/// processed by one thread.
template <class Work>
PetscErrorCode FreeBodies::for_bodies(const Work &work) {
#ifdef PETSC_USE_DEBUG  // every thread would note its functions on one stack
  constexpr bool serial = true;
#else
  const bool serial = threads() == 1 || static_cast<int>(bodies_.size()) < threads();
#endif
  PetscFunctionBeginUser;
  if (serial) {
    for (std::size_t b = 0; b < bodies_.size(); ++b) PetscCall(work(b));
    PetscFunctionReturn(0);
  }
  EventScope scope(Event::boxes);
  std::vector<PetscErrorCode> errors(bodies_.size(), 0);
  scope.flops(in_parallel_tasks(static_cast<int>(bodies_.size()), [&](int b) { errors[b] = work(b); }));
  for (const PetscErrorCode error : errors) PetscCall(error);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
