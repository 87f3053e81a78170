// Adhesion: rupture and formation of bonds.
#include "adhesion/adhesion.hpp"
#include "base/philox.hpp"
#include "base/send_to_ranks.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace eulastic {
namespace {

double length_of(const Real3 &way) { return std::sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]); }

}  // namespace

double Adhesion::random(const ReceptorName &name, Chance chance) const {
  const auto step = static_cast<std::uint64_t>(flow_.now.step);
  return uniform(philox({static_cast<std::uint32_t>(name.index), static_cast<std::uint32_t>(name.body),
                         static_cast<std::uint32_t>(step), static_cast<std::uint32_t>(step >> 32)},
                        {static_cast<std::uint32_t>(spec_.seed), 2 + static_cast<std::uint32_t>(chance)}));
}

// Of the two ends of a bond the first records that it has formed or broken.
void Adhesion::bind(const ReceptorName &name, const ReceptorName &partner, int pair, const Real3 &anchor,
                    Receptor *receptor) {
  receptor->partner = partner.body;
  receptor->other = partner.index;
  receptor->pair = pair;
  receptor->anchor = anchor;
  receptor->since = flow_.now.time;
  if (partner.body > 0 && partner < name) return;
  ++formed_here_;
  events_.push_back({flow_.now.time, true, name, partner, pair, 0, 0});
}

void Adhesion::release(const ReceptorName &name, double tension, Receptor *receptor) {
  const ReceptorName partner{static_cast<int>(receptor->partner), static_cast<int>(receptor->other)};
  receptor->partner = Receptor::none;
  broken_.insert(name);
  if (partner.body > 0 && partner < name && find_near(partner)) return;
  ++lost_here_;
  events_.push_back({flow_.now.time, false, name, partner, static_cast<int>(receptor->pair), tension,
                     flow_.now.time - receptor->since});
}

// Releases the bonds whose other end has left with its body.
void Adhesion::release_lost() {
  for_receptors([&](std::size_t b, std::size_t r, Receptor *receptor) {
    if (!(receptor->partner > 0)) return;
    const NearReceptor *other = find_near({static_cast<int>(receptor->partner), static_cast<int>(receptor->other)});
    if (!other || !(other->partner == name_of(b, r))) release(name_of(b, r), 0, receptor);
  });
}

void Adhesion::break_bonds(double dt) {
  for (const Bond &bond : bonds_) {
    Receptor &receptor = boxed_.bodies().receptors(bond.body)[bond.receptor];
    const ReceptorName name = name_of(bond.body, bond.receptor);
    const ReceptorName partner{static_cast<int>(receptor.partner), static_cast<int>(receptor.other)};
    const ReceptorName first = partner.body > 0 && partner < name ? partner : name;
    if (random(first, Chance::rupture) < kernels::probability(law(receptor).off_rate(bond.tension), dt))
      release(name, bond.tension, &receptor);
  }
}

// Returns the point of a wall of the domain to which a receptor may bind.
Foot Adhesion::foot_on_wall(const AdhesionPair &pair, const Real3 &place) const {
  const Domain &domain = flow_.domain;
  double nearest = HUGE_VAL;
  Foot foot;
  for (const auto [d, high] : domain.sides()) {
    if (flow_.spec.sides[d][high].kind != BoundaryKind::wall) continue;
    const double end = high ? domain.domain_shape().length[d] : 0;
    const double distance = std::fabs(place[d] - end);
    Real3 on_wall = place;
    on_wall[d] = end;
    if (distance >= nearest || !pair.region.has(domain, on_wall)) continue;
    nearest = distance;
    foot = {on_wall, true};
  }
  return foot;
}

// Binds free receptors at random to the nearest wall or surface on the grid of all pairs.
void Adhesion::form_bonds_to_walls(double dt) {
  for_receptors([&](std::size_t b, std::size_t r, Receptor *receptor) {
    const ReceptorName name = name_of(b, r);
    if (receptor->is_bound() || broken_.count(name) > 0) return;
    double nearest = HUGE_VAL;
    Real3 anchor{};
    int chosen = 0;
    const auto consider = [&](int p, const Real3 &foot) {
      const double distance = length_of(way(receptor->place, foot));
      if (distance > spec_.pairs[p].law.reach || distance >= nearest) return;
      nearest = distance;
      anchor = foot;
      chosen = p;
    };
    for (std::size_t p = 0; p < spec_.pairs.size(); ++p) {
      const AdhesionPair &pair = spec_.pairs[p];
      if (!pair.to_wall() || pair.first != bodies()[b].species) continue;
      if (const Foot foot = foot_on_wall(pair, receptor->place); foot.found) consider(static_cast<int>(p), foot.place);
    }
    if (const auto feet = feet_.find(name); feet != feet_.end())
      for (const auto &[p, foot] : feet->second)
        if (spec_.pairs[p].region.has(flow_.domain, foot)) consider(p, foot);
    if (!(nearest < HUGE_VAL)) return;
    if (random(name, Chance::bond_to_wall) < kernels::probability(spec_.pairs[chosen].law.on_rate(nearest), dt))
      bind(name, {0, 0}, chosen, anchor, receptor);
  });
}

// Draws for every free receptor of this rank whether it proposes to bind to the nearest free receptor of another body
// within reach that comes after it in the order of names. `to`: the ranks that get the proposals.
void Adhesion::find_proposals(double dt, std::vector<Proposal> *proposals, std::vector<int> *to) {
  ReceptorBins bins(flow_.domain, reach_of_bodies());
  for (std::size_t n = 0; n < near_.size(); ++n)
    if (near_[n].is_free) bins.add(n, near_[n].place);
  for (std::size_t n = 0; n < near_.size(); ++n) {
    const NearReceptor &from = near_[n];
    if (!from.is_free || from.rank != flow_.domain.rank() || find_own(from.name)->is_bound()) continue;
    Proposal nearest{from.name, {}, -1, from.rank, HUGE_VAL, false};
    int rank = 0;
    bins.for_near(from.place, [&](std::size_t m) {
      const NearReceptor &other = near_[m];
      if (m <= n || other.name.body == from.name.body) return;
      const double distance = length_of(way(from.place, other.place));
      for (std::size_t p = 0; p < spec_.pairs.size(); ++p) {
        const AdhesionPair &pair = spec_.pairs[p];
        if (!is_of_bodies(pair) || !pair.joins(from.species, other.species) || distance > pair.law.reach) continue;
        if (std::pair(distance, other.name) < std::pair(nearest.distance, nearest.to))
          nearest = {from.name, other.name, static_cast<int>(p), from.rank, distance, false}, rank = other.rank;
      }
    });
    if (nearest.pair < 0) continue;
    const double rate = spec_.pairs[nearest.pair].law.on_rate(nearest.distance);
    if (random(from.name, Chance::bond_of_bodies) >= kernels::probability(rate, dt)) continue;
    proposals->push_back(nearest);
    to->push_back(rank);
  }
}

// Decides on the proposals to receptors of this rank: each accepts the nearest, unless it has become bound or has
// itself proposed (`wanting`).
void Adhesion::accept_proposals(const std::set<ReceptorName> &wanting, std::vector<Proposal> *proposals) {
  std::sort(proposals->begin(), proposals->end(), [](const Proposal &one, const Proposal &other) {
    return std::tie(one.to, one.distance, one.from) < std::tie(other.to, other.distance, other.from);
  });
  for (Proposal &proposal : *proposals) {
    Receptor *receptor = find_own(proposal.to);
    const NearReceptor *from = find_near(proposal.from);
    if (!receptor || !from || receptor->is_bound() || wanting.count(proposal.to) > 0) continue;
    proposal.accepted = true;
    bind(proposal.to, proposal.from, proposal.pair, from->place, receptor);
  }
}

PetscErrorCode Adhesion::form_bonds_of_bodies(double dt) {
  const MPI_Comm comm = flow_.domain.comm();
  std::vector<Proposal> proposals;
  std::vector<int> to;
  std::set<ReceptorName> wanting;
  PetscFunctionBeginUser;
  if (!(reach_of_bodies() > 0)) PetscFunctionReturn(0);
  find_proposals(dt, &proposals, &to);
  for (const Proposal &proposal : proposals) wanting.insert(proposal.from);
  PetscCall(send_to_ranks(comm, to, &proposals));
  accept_proposals(wanting, &proposals);
  to.clear();
  for (const Proposal &proposal : proposals) to.push_back(proposal.rank);
  PetscCall(send_to_ranks(comm, to, &proposals));
  for (const Proposal &proposal : proposals)
    if (proposal.accepted)
      bind(proposal.from, proposal.to, proposal.pair, find_near(proposal.to)->place, find_own(proposal.from));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
