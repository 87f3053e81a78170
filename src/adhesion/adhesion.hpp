// Adhesion: bonds between receptors of two bodies, or of a body and a wall, that form and break at random and pull as
// springs; docs/method.md, section 21.
//
// The receptors of a body in a box (boxes/receptors.hpp) are stored with it on the rank that has the body. Ranks
// exchange only receptors near another body. Both ends of a bond draw the same random numbers.
#pragma once

#include "adhesion/adhesion_pair.hpp"
#include "adhesion/bond_records.hpp"
#include "adhesion/near_bodies.hpp"
#include "adhesion/point_forces.hpp"
#include "adhesion/receptor_bins.hpp"
#include "adhesion/surface_feet.hpp"
#include "boxes/boxed_bodies.hpp"
#include "parts/flow.hpp"
#include "parts/flow_part.hpp"

#include <map>
#include <set>
#include <vector>

namespace eulastic {

class Adhesion final : public FlowPart {
public:
  Adhesion(Flow *flow, BoxedBodies *boxed, const AdhesionSpec &spec)
      : flow_(*flow), boxed_(*boxed), spec_(spec), forces_(*flow) {}

  std::size_t bytes() const override;
  PetscErrorCode carry(CarriedState *state) override;
  PetscErrorCode start() override;
  PetscErrorCode resume() override;
  /// The limit due to the stiffness of the springs and to the rates of formation and rupture.
  double largest_step() const override;
  PetscErrorCode begin_slope(double dt, Field &slope) override;
  PetscErrorCode move(double dt, std::vector<Phase> *phases) override;
  PetscErrorCode add_rate(const MomentumRate &rate) override;
  PetscErrorCode end_step() override;
  void mark_forced_rows(std::vector<char> *rows) const override { forces_.mark_rows(rows); }
  PetscErrorCode add_power(const SynchronisedBodies &bodies, double *power) override;

  const std::vector<AdhesionPair> &pairs() const { return spec_.pairs; }
  /// Places receptors on bodies that have none. Collective, like all functions below.
  PetscErrorCode place_on_bodies();
  /// Sums over all bonds of all ranks.
  PetscErrorCode measure(BondTotals *totals);
  /// Measures the bonds of the bodies that this rank owns (BodyRange of `bodies`), in their order.
  PetscErrorCode measure(int bodies, std::vector<BodyBonds> *owned) const;
  /// Gathers all bonds on rank 0.
  PetscErrorCode lines(std::vector<BondLine> *lines) const;
  /// Gathers on rank 0 the bonds that have formed or broken since the last call.
  PetscErrorCode take_events(std::vector<BondEvent> *events);

private:
  /// A bond from the side of one of its receptors.
  struct Bond {
    std::size_t body, receptor;  ///< indices in bodies() and in the body's receptors
    Real3 pull;                  ///< force on the receptor
    double tension;
  };
  /// A receptor, of any rank, that is near another body.
  struct NearReceptor {
    ReceptorName name;
    int species, rank;
    bool is_free;  ///< at the start of the step
    ReceptorName partner;
    Real3 place;
  };
  /// A receptor's proposal to bind to a receptor of another body.
  struct Proposal {
    ReceptorName from, to;
    int pair, rank;
    double distance;
    bool accepted;
  };

  /// One end of a bond, at a body.
  struct End {
    int body, pair;
    ReceptorName receptor;
    Real3 anchor, force;
    double tension, age;
  };

  const std::vector<FreeBodies::Body> &bodies() const { return boxed_.bodies().bodies(); }
  ReceptorName name_of(std::size_t body, std::size_t receptor) const {
    return {bodies()[body].number, static_cast<int>(receptor)};
  }
  Receptor *find_own(const ReceptorName &name);
  const NearReceptor *find_near(const ReceptorName &name) const;
  /// Calls visit(index of the body, index of the receptor, receptor) for the receptors of this rank.
  template <class Visit>
  void for_receptors(const Visit &visit) {
    for (std::size_t b = 0; b < bodies().size(); ++b) {
      std::vector<Receptor> &receptors = boxed_.bodies().receptors(b);
      for (std::size_t r = 0; r < receptors.size(); ++r) visit(b, r, &receptors[r]);
    }
  }
  /// Returns the shortest vector between two positions, across periodic boundaries.
  Real3 way(const Real3 &from, const Real3 &to) const;
  const kernels::BondLaw &law(const Receptor &receptor) const { return spec_.pairs[int(receptor.pair)].law; }
  bool is_on_grid(const AdhesionPair &pair) const { return !pair.to_wall() && !flow_.now.phases[pair.second].boxed; }
  bool is_of_bodies(const AdhesionPair &pair) const { return !pair.to_wall() && !is_on_grid(pair); }
  double reach_of_bodies() const;

  PetscErrorCode update_surroundings();
  Extent hull_of(const FreeBodies::Body &body) const;
  PetscErrorCode query_grid(double dt);
  struct Request;
  void reply(double dt, Request *request) const;
  bool is_near(const Real3 &place, const Extent &box, double reach) const;
  PetscErrorCode send_near_receptors();
  void release_lost();
  void find_bonds();
  PetscErrorCode send_forces();
  PetscErrorCode rebuild_bonds();

  /// The purposes of random numbers; each has its own stream.
  enum class Chance : unsigned { rupture, bond_to_wall, bond_of_bodies };
  /// Returns a random number in [0, 1) for this step.
  double random(const ReceptorName &name, Chance chance) const;
  void release(const ReceptorName &name, double tension, Receptor *receptor);
  void bind(const ReceptorName &name, const ReceptorName &partner, int pair, const Real3 &anchor, Receptor *receptor);
  void break_bonds(double dt);
  Foot foot_on_wall(const AdhesionPair &pair, const Real3 &place) const;
  void form_bonds_to_walls(double dt);
  void find_proposals(double dt, std::vector<Proposal> *proposals, std::vector<int> *to);
  void accept_proposals(const std::set<ReceptorName> &wanting, std::vector<Proposal> *proposals);
  PetscErrorCode form_bonds_of_bodies(double dt);
  PetscErrorCode sum_events();
  void find_body(End *end) const;
  PetscErrorCode find_ends(std::vector<End> *ends) const;

  Flow &flow_;
  BoxedBodies &boxed_;
  AdhesionSpec spec_;
  PointForces forces_;
  std::vector<Bond> bonds_;             ///< bonds of this rank's receptors, in their order
  std::vector<NearReceptor> near_;      ///< sorted by name
  std::map<int, Surroundings> around_;  ///< by number of the bodies of this rank
  long fits_ = -1;                      ///< version of the boxes for which around_ was found
  double travel_ = 0;                   ///< upper bound of the surfaces' motion since then, in cells
  std::map<ReceptorName, std::vector<std::pair<int, Real3>>> feet_;  ///< pair, and point on a surface on the grid
  std::set<ReceptorName> broken_;  ///< receptors of this rank whose bond has broken in this step
  std::vector<BondEvent> events_;
  double most_ = 0;                               ///< largest number of bonds of any body
  std::int64_t formed_ = 0, lost_ = 0;            ///< bonds formed and broken since the start, on all ranks
  std::int64_t formed_here_ = 0, lost_here_ = 0;  ///< on this rank, not summed yet
};

}  // namespace eulastic
