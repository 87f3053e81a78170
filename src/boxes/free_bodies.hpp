// Elastic bodies, membranes and drops that are not anchored and never merge with others: each lies in a box of its own,
// an aligned block of the grid around the body, which is complete on one rank. Between receiving the velocity and
// sending the force a body needs no message: docs/architecture.md.
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
    int number;                               ///< from 1 on; no other body of any rank has it
    int species;                              ///< index
    Box box;                                  ///< its indices do not wrap around periodic sides
    Phase phase;                              ///< of this body alone, on the box; no labels
    SegmentValues force;                      ///< per mass of the fluid, on the faces forced()
    std::vector<SurfaceMarker> markers = {};  ///< of a membrane, their cells not wrapped around periodic sides
    WallFilm film = {};                       ///< the same: walls in the box
    std::vector<SurfaceSample> surface = {};  ///< the same, as of `force`, without velocities; may be missing
    ActiveSegments tension_faces = {};        ///< with surface tension: those that feel that or stress
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
  /// The number, the species, first cell and cells of a block around a body of this rank and how many markers it has,
  /// then phi and the components of B of that block, the markers and the receptors: all that add_packed() needs.
  std::vector<double> packed(std::size_t body) const;
  static constexpr int head = 9;  ///< numbers before phi
  /// How many values a body with this head has after it, before its receptors; `centred`: all components of B live at
  /// centres.
  static std::size_t packed_values(const DomainShape &domain, bool centred, const double *head);
  /// Adds such a body; `like`: a phase of the grid with its material and rule.
  PetscErrorCode add_packed(const std::vector<double> &packed, const Phase &like);
  /// Adds a body like that of this rank with a number, so many cells away; its receptors are free. `like`: as of
  /// add_packed().
  PetscErrorCode add_copy(int number, int copy, const Int3 &shift, const Phase &like);
  /// Gives every body of this rank to one of `ranks`, in their order; `species`: phases with materials and rules of
  /// all. Collective.
  PetscErrorCode give(const std::vector<int> &ranks, const std::vector<Phase> &species);
  /// Removes bodies of this rank, by their positions in bodies(), ascending; follow() must come next, on all ranks.
  void remove(const std::vector<std::size_t> &which);
  void clear();

  /// Whether no wall holds the fluid, so that a net force of surfaces would move all of it, and where rigid bodies are
  /// that stay, solid fractions on the grid; before follow(), if any species has a surface that exerts forces.
  void set_surroundings(bool drifts, const std::vector<const Phase *> &rigid);
  /// Fits all boxes again if a body has come close to the end of its box; once after bodies were added. Collective.
  PetscErrorCode follow();
  /// B_s of membranes from B of their bodies, MembraneMechanics::start().
  PetscErrorCode start_membranes();
  /// Sets markers on the membranes that need them and have none; their strain is kept.
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
  /// The mean over the domain of the force per mass, of bending and surface tension where it would drive all of the
  /// fluid: that of the discretisation alone.
  const Real3 &mean_force() const noexcept { return mean_force_; }
  /// Sets `rows`, one value for each row of this rank's cells, where add_forces() may add anything.
  void mark_rows(std::vector<char> *rows) const { exchange_.mark_rows(rows); }
  /// Resets B where the grid does not resolve it (solids/unresolved.hpp). `trace`: the largest tr B of every species;
  /// `count`: centres of all ranks. Collective.
  PetscErrorCode reset_unresolved(const std::vector<double> &trace, long *count);

  const std::vector<Body> &bodies() const noexcept { return bodies_; }
  /// Of the body at a place in bodies().
  std::vector<Receptor> &receptors(std::size_t body) { return bodies_[body].receptors; }
  /// How often bodies have come, have gone or have got other boxes: the same on all ranks.
  long fits() const noexcept { return fits_; }
  /// Whether samples of surfaces are kept when forces are found; measure_surfaces() takes longer without them.
  void keep_surfaces(bool keep) { keeps_surfaces_ = keep; }
  /// Adds energy and power of the surfaces that look() has seen; `samples`: of each membrane. `species`: phases with
  /// their materials. Collective.
  PetscErrorCode measure_surfaces(const std::vector<BodyInBox> &seen, const std::vector<Phase> &species,
                                  SurfaceEnergy *measured, std::vector<std::vector<SurfaceSample>> *samples);
  /// What stretch forces do on the flow; as measure_surfaces(). Collective if any species has one.
  PetscErrorCode stretch_power(const std::vector<BodyInBox> &seen, const std::vector<Phase> &species, double *power);
  /// Makes phi of the phases of some species the sum over the bodies that look() or list() has seen; owned points. The
  /// rows of the phases are known. Collective.
  PetscErrorCode show_fractions(const std::vector<BodyInBox> &seen, const std::map<int, Phase *> &phases);
  /// The bodies of this rank as they are, without velocity.
  std::vector<BodyInBox> list() const;
  /// The bodies of this rank with a velocity, of step.time, in their boxes: copies that it has moved over step.dt, or
  /// the bodies themselves if that is 0. Good until the next call of anything that changes bodies. Collective.
  PetscErrorCode look(const Step &step, const Field &velocity, std::vector<BodyInBox> *seen);
  /// Adds what look() has seen to empty phases of the grid, by species: phi is the sum over the bodies; B and the label
  /// are those of the body that fills most of the point, the first of equals, and where no body has a part, B is what
  /// the first one is extended to. Owned points; phases without labels get none. Collective.
  PetscErrorCode show(const std::vector<BodyInBox> &seen, const std::map<int, Phase *> &phases) const;
  std::size_t bytes() const;
  /// Doubles that a body takes whose shape extends over so many cells: phi and B with the ghosts around its box, force,
  /// and what look() keeps: a copy and a velocity, without a surface in fewer layers.
  static double values(const Material &material, int dimension, const Real3 &cells, int ghosts);

  /// Cells around a body that its box has when it is made.
  static int margin(const Material &material) { return needed(material) + 2; }
  /// How far spans of rows reach beyond phi != 0 of a body, in cells: layers around it and what moves in a step.
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
  /// Cells between the body and the ends of its box that a step needs: the body moves by less than one, and beyond that
  /// faces feel its stress. The rest of the margin is for what moves until the next fit.
  static int needed(const Material &material) { return 1 + (material.is_membrane() ? MembraneMechanics::reach : 1); }
  static int stage_fields(const Phase &phase);
  template <class PhaseOrConst, class Visit>
  static void for_values(const Box &block, const Int3 &first, PhaseOrConst &phase, const Visit &visit);
  /// Copies what two boxes share in memory, points on high sides of the domain and `layers` of the first one's ghosts
  /// included.
  static void copy_shared(const Box &box, const Field &from, int layers, Field *to);
  /// No body yet, with the material and the rule of a phase.
  static Phase empty_like(const Phase &phase, const Box &box);
  PetscErrorCode extend(Body *body);
  bool is_near_an_end(const Body &body) const;
  PetscErrorCode fit(Body *body, int layers) const;
  /// Velocity in the box of a body, with what is behind sides of the domain, after exchange_.fetch().
  void bring_velocity(std::size_t body, const Step &step, const Field &velocity, Field *flow) const;
  PetscErrorCode fit_boxes(bool *changed, long *unresolved);
  PetscErrorCode find_walls();
  PetscErrorCode find_force(Body *body);
  PetscErrorCode gather_force(MembraneMechanics &membrane, Body *body, Field &force);
  PetscErrorCode membrane_force(MembraneMechanics &membrane, const Body &body, const Phase &phase, bool of_step,
                                Field &force, std::vector<SurfaceSample> *samples);
  PetscErrorCode measure_membrane(const BodyInBox &seen, const Body &body, ExactSums *sum,
                                  std::vector<SurfaceSample> *samples);
  PetscErrorCode find_forces();
  PetscErrorCode look_at(std::size_t body, const Step &step, const Field &velocity, BodyInBox *seen);
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
  BoxExchange exchange_, fractions_;  ///< of velocities and forces, of single fields
  bool fractions_are_connected_ = false;
  bool extends_;
  bool drifts_ = false, keeps_surfaces_ = false;
  Field walls_;  ///< of the grid, solid fraction of rigid bodies that stay; none: null
  NetForce net_force_;
  Real3 mean_force_{};
  std::vector<Tools> tools_;  ///< of all threads
  std::vector<Body> bodies_;  ///< by their numbers
  /// What look() has made of a body. Where that is measured from its cells alone, the box has nothing but these and
  /// what B is extended to.
  struct Seen {
    Box box;
    Phase moved;
    Field velocity;
  };
  std::vector<Seen> seen_;
  bool fitted_ = false;  ///< the boxes are those that the exchange knows
  long fits_ = 0;
};

/// work(place) for all bodies of this rank: where there are as many as threads, each of them all on one thread.
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
