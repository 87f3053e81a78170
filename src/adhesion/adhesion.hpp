// Adhesion: bonds between receptors of two bodies, or of a body and a wall, that form and break at random and pull as
// springs; docs/method.md, section 21.
#pragma once

#include "adhesion/receptor_bins.hpp"
#include "adhesion/receptors.hpp"
#include "adhesion/surface_feet.hpp"
#include "parts/flow.hpp"
#include "parts/flow_part.hpp"

#include <utility>
#include <vector>

namespace eulastic {

/// A bond that has formed or broken.
struct BondEvent {
  double time;
  bool formed;
  int body, partner;    ///< numbers of bodies; partner 0: a wall or a surface on the grid
  int pair;             ///< of AdhesionSpec::pairs
  double tension, age;  ///< of a bond that breaks
};

/// What the bonds of a body do.
struct BodyBonds {
  int body;
  int bonds = 0;
  Real3 force{};       ///< on the body
  double tension = 0;  ///< mean of its bonds
  double age = 0;      ///< mean of its bonds
};

class Adhesion final : public FlowPart {
public:
  Adhesion(Flow *flow, BoxedBodies *boxed, const AdhesionSpec &spec) : flow_(*flow), boxed_(*boxed), spec_(spec) {}

  std::size_t bytes() const override { return receptors_.size() * sizeof(Receptor) + bonds_.size() * sizeof(Bond); }
  PetscErrorCode carry(CarriedState *state) override;
  PetscErrorCode start() override;
  PetscErrorCode resume() override;
  /// That of springs that pull on the fluid, and of rates of formation and rupture.
  double largest_step() const override;
  PetscErrorCode begin_slope(double dt, Field &slope) override;
  PetscErrorCode move(double dt, std::vector<Phase> *phases) override;
  PetscErrorCode add_rate(const MomentumRate &rate) override;
  void mark_forced_rows(std::vector<char> *rows) const override;
  PetscErrorCode add_power(const FlowLook &look, double *power) override;

  /// Of all bodies with receptors, by their numbers; the same on all ranks.
  std::vector<BodyBonds> measure() const;
  /// Both ends of every bond and its tension, the same on all ranks.
  struct Line {
    int body, partner;
    Real3 from, to;
    double tension, since;
  };
  std::vector<Line> lines() const;
  /// Since the last call; the same on all ranks.
  std::vector<BondEvent> take_events() { return std::exchange(events_, {}); }

private:
  /// A bond with its tension: the pull on a receptor, and on the other one, unless that is a wall.
  struct Bond {
    std::size_t receptor;
    std::ptrdiff_t other;  ///< index; negative: the anchor on a wall or a surface of the grid
    Real3 pull;
    double tension;
  };
  /// From a receptor to what it is bound to, the shortest way across periodic sides.
  Real3 way_to(const Receptor &from, const double to[3]) const;
  const kernels::BondLaw &law(const Receptor &receptor) const { return spec_.pairs[int(receptor.pair)].law; }
  bool is_on_grid(const AdhesionPair &pair) const;
  const double *other_end(const Bond &bond) const;
  void find_bonds();
  /// At places that need not be wrapped around periodic sides, in their order. Collective, the same on all ranks.
  PetscErrorCode find_velocity(const std::vector<Real3> &places, std::vector<Real3> *velocities) const;
  PetscErrorCode move_receptors(double dt);
  PetscErrorCode follow_surfaces();
  /// In [0, 1), of this step; `which`: the kind of event.
  double random(std::size_t receptor, unsigned which) const;
  void break_bonds(double dt);
  std::vector<char> find_free() const;
  bool is_in_region(const AdhesionPair &pair, const Real3 &place) const;
  Foot foot_on_wall(const AdhesionPair &pair, const Receptor &receptor) const;
  PetscErrorCode form_bonds_to_walls(double dt, const std::vector<char> &free);
  struct Candidate;
  Candidate nearest_partner(std::size_t receptor, const ReceptorBins &bins) const;
  void form_bonds_of_bodies(double dt, const std::vector<char> &free);
  void note_formed(std::size_t receptor);
  void release(Receptor *receptor, double tension);
  /// Adds factor times the force per mass of a point force to a field on owned faces.
  void add_at(const double place[3], const Real3 &force, double factor, Field *field) const;
  void add(const std::vector<WeightedTarget> &targets) const;

  Flow &flow_;
  BoxedBodies &boxed_;
  AdhesionSpec spec_;
  std::vector<Receptor> receptors_;
  std::vector<Bond> bonds_;
  std::vector<BondEvent> events_;
};

}  // namespace eulastic
