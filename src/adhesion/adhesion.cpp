#include "adhesion/adhesion.hpp"

#include "adhesion/grid_place.hpp"
#include "base/events.hpp"
#include "base/send_to_ranks.hpp"
#include "boxes/receptors.hpp"
#include "parts/state.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

double length_of(const Real3 &way) { return std::sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]); }

}  // namespace

std::size_t Adhesion::bytes() const {
  std::size_t receptors = 0;
  for (const FreeBodies::Body &body : bodies()) receptors += body.receptors.size();
  return receptors * sizeof(Receptor) + near_.size() * sizeof(NearReceptor) + bonds_.size() * sizeof(Bond) +
         forces_.bytes();
}

PetscErrorCode Adhesion::carry(CarriedState *state) {
  PetscFunctionBeginUser;
  PetscCall(sum_events());
  state->integers["bonds_formed_and_broken"] = {&formed_, &lost_};
  PetscFunctionReturn(0);
}

PetscErrorCode Adhesion::place_on_bodies() {
  PetscFunctionBeginUser;
  fits_ = -1;
  const std::vector<BodyInBox> list = boxed_.bodies().list();
  for (std::size_t b = 0; b < list.size(); ++b) {
    double density = 0;
    for (const AdhesionPair &pair : spec_.pairs)
      if (pair.has(list[b].species)) density = std::max(density, pair.density);
    std::vector<Receptor> &receptors = boxed_.bodies().receptors(b);
    if (density > 0 && receptors.empty())
      place_receptors(list[b], density, static_cast<std::uint32_t>(spec_.seed), &receptors);
  }
  PetscCall(rebuild_bonds());
  PetscFunctionReturn(0);
}

PetscErrorCode Adhesion::start() {
  PetscFunctionBeginUser;
  PetscCall(place_on_bodies());
  PetscFunctionReturn(0);
}

PetscErrorCode Adhesion::resume() {
  PetscFunctionBeginUser;
  fits_ = -1;
  PetscCall(rebuild_bonds());
  PetscFunctionReturn(0);
}

Receptor *Adhesion::find_own(const ReceptorName &name) {
  const auto body = std::lower_bound(bodies().begin(), bodies().end(), name.body,
                                     [](const FreeBodies::Body &one, int number) { return one.number < number; });
  if (body == bodies().end() || body->number != name.body) return nullptr;
  if (name.index < 0 || name.index >= static_cast<int>(body->receptors.size())) return nullptr;
  return &boxed_.bodies().receptors(body - bodies().begin())[name.index];
}

const Adhesion::NearReceptor *Adhesion::find_near(const ReceptorName &name) const {
  const auto found = std::lower_bound(near_.begin(), near_.end(), name,
                                      [](const NearReceptor &one, const ReceptorName &of) { return one.name < of; });
  return found != near_.end() && found->name == name ? &*found : nullptr;
}

Real3 Adhesion::way(const Real3 &from, const Real3 &to) const {
  const Domain &domain = flow_.domain;
  Real3 way{};
  for (int d = 0; d < domain.dimension(); ++d) {
    way[d] = to[d] - from[d];
    const double length = domain.domain_shape().length[d];
    if (!domain.is_wall(d)) way[d] -= length * std::round(way[d] / length);
  }
  return way;
}

double Adhesion::reach_of_bodies() const {
  double reach = 0;
  for (const AdhesionPair &pair : spec_.pairs)
    if (is_of_bodies(pair)) reach = std::max(reach, pair.law.reach);
  return reach;
}

// Returns the cells of a body's box, which contains the body until all boxes are refitted, and those around it within
// reach of bonds, with a cell for the motion of surfaces between two searches.
Extent Adhesion::hull_of(const FreeBodies::Body &body) const {
  const Domain &domain = flow_.domain;
  const bool on_grid = std::any_of(spec_.pairs.begin(), spec_.pairs.end(),
                                   [this](const AdhesionPair &pair) { return is_on_grid(pair); });
  Extent hull{};
  for (int d = 0; d < 3; ++d) {
    const double h = domain.spacing()[d];
    const int grown = d >= domain.dimension() ? 0
                                              : std::max(static_cast<int>(std::ceil(reach_of_bodies() / h)) + 1,
                                                         on_grid ? foot_reach + 1 : 0);
    hull.begin[d] = body.box.layout().begin[d] - grown;
    hull.end[d] = body.box.layout().begin[d] + body.box.cells()[d] + grown;
    for (const Receptor &receptor : body.receptors) {
      if (!(receptor.partner > 0) || d >= domain.dimension()) continue;
      const int cell = static_cast<int>(std::floor(receptor.anchor[d] / h));
      hull.begin[d] = std::min(hull.begin[d], cell);
      hull.end[d] = std::max(hull.end[d], cell + 1);
    }
  }
  return hull;
}

// Finds the surroundings of all bodies again if boxes have been refitted or surfaces may have moved by a cell.
PetscErrorCode Adhesion::update_surroundings() {
  PetscFunctionBeginUser;
  if (fits_ == boxed_.bodies().fits() && travel_ <= 1) PetscFunctionReturn(0);
  fits_ = boxed_.bodies().fits();
  travel_ = 0;
  std::vector<BodyBlock> blocks;
  for (const FreeBodies::Body &body : bodies()) {
    const Layout &layout = body.box.layout();
    Extent box{layout.begin, {}};
    for (int d = 0; d < 3; ++d) box.end[d] = layout.begin[d] + layout.cells[d];
    if (!body.receptors.empty()) blocks.push_back({body.number, body.species, box, hull_of(body)});
  }
  const auto join = [this](int one, int other) {
    return std::any_of(spec_.pairs.begin(), spec_.pairs.end(),
                       [&](const AdhesionPair &pair) { return is_of_bodies(pair) && pair.joins(one, other); });
  };
  const auto has_surface = [this](int species, const Extent &hull) {
    return std::any_of(spec_.pairs.begin(), spec_.pairs.end(), [&](const AdhesionPair &pair) {
      return is_on_grid(pair) && pair.first == species &&
             has_surface_in(flow_.domain, flow_.now.phases[pair.second], hull);
    });
  };
  PetscCall(find_surroundings(flow_.domain, blocks, join, has_surface, &around_));
  PetscFunctionReturn(0);
}

// A request to the rank that owns the cell of a position, and its reply.
struct Adhesion::Request {
  int rank, body, receptor;  ///< the sender, and indices there
  int pair;                  ///< a point on the surface of its second species is requested; `anchor`: its new position
  bool found;
  Real3 place;  ///< position, replaced by the reply
  static constexpr int anchor = -1;
};

// Moves an anchor by the midpoint rule; on walls the interpolated velocity is that of the wall.
void Adhesion::reply(double dt, Request *request) const {
  const Domain &domain = flow_.domain;
  Real3 &place = request->place;
  if (request->pair != Request::anchor) {
    const Foot foot = find_foot(domain, flow_.now.phases[spec_.pairs[request->pair].second], place);
    request->found = foot.found;
    place = foot.place;
    return;
  }
  const GridPlace cell(domain, place);
  Real3 half = place;
  const Real3 first = cell.velocity(domain, flow_.now.velocity, place);
  for (int d = 0; d < 3; ++d) half[d] += 0.5 * dt * first[d];
  const Real3 second = cell.velocity(domain, flow_.now.velocity, half);
  for (int d = 0; d < domain.dimension(); ++d) {
    place[d] += dt * second[d];
    if (domain.is_wall(d)) place[d] = std::clamp(place[d], 0.0, domain.domain_shape().length[d]);
  }
}

// Moves anchors and finds the points of surfaces on the grid that free receptors may bind to.
PetscErrorCode Adhesion::query_grid(double dt) {
  const Domain &domain = flow_.domain;
  std::vector<Request> requests;
  std::vector<int> to;
  PetscFunctionBeginUser;
  feet_.clear();
  const auto request_at = [&](std::size_t b, std::size_t r, int pair, const Real3 &place) {
    requests.push_back({domain.rank(), static_cast<int>(b), static_cast<int>(r), pair, false, place});
    to.push_back(GridPlace(domain, place).owner(domain));
  };
  for_receptors([&](std::size_t b, std::size_t r, Receptor *receptor) {
    if (receptor->partner == Receptor::wall) request_at(b, r, Request::anchor, receptor->anchor);
    const auto around = around_.find(bodies()[b].number);
    if (receptor->is_bound() || around == around_.end() || !around->second.surface) return;
    for (std::size_t p = 0; p < spec_.pairs.size(); ++p)
      if (is_on_grid(spec_.pairs[p]) && spec_.pairs[p].first == bodies()[b].species)
        request_at(b, r, static_cast<int>(p), receptor->place);
  });
  const bool any = std::any_of(spec_.pairs.begin(), spec_.pairs.end(),
                               [this](const AdhesionPair &pair) { return !is_of_bodies(pair); });
  if (!any) PetscFunctionReturn(0);
  PetscCall(send_to_ranks(domain.comm(), to, &requests));
  to.clear();
  for (Request &request : requests) {
    reply(dt, &request);
    to.push_back(request.rank);
  }
  PetscCall(send_to_ranks(domain.comm(), to, &requests));
  for (const Request &request : requests) {
    if (request.pair == Request::anchor)
      boxed_.bodies().receptors(request.body)[request.receptor].anchor = request.place;
    else if (request.found)
      feet_[name_of(request.body, request.receptor)].emplace_back(request.pair, request.place);
  }
  PetscFunctionReturn(0);
}

// Returns whether a position is within reach of a block.
bool Adhesion::is_near(const Real3 &place, const Extent &box, double reach) const {
  const Domain &domain = flow_.domain;
  for (int d = 0; d < domain.dimension(); ++d) {
    const double h = domain.spacing()[d], length = domain.domain_shape().length[d];
    double away = place[d] - 0.5 * h * (box.begin[d] + box.end[d]);
    if (!domain.is_wall(d)) away -= length * std::round(away / length);
    if (std::fabs(away) > 0.5 * h * (box.end[d] - box.begin[d]) + 1.0001 * reach) return false;
  }
  return true;
}

// Sends receptors near another body, and those bound to it, to the rank of that body.
PetscErrorCode Adhesion::send_near_receptors() {
  const double reach = reach_of_bodies();
  const int here = flow_.domain.rank();
  std::vector<NearReceptor> own;
  std::vector<int> to;
  PetscFunctionBeginUser;
  near_.clear();
  if (!(reach > 0)) PetscFunctionReturn(0);
  for_receptors([&](std::size_t b, std::size_t r, const Receptor *receptor) {
    const auto around = around_.find(bodies()[b].number);
    if (around == around_.end()) return;
    std::set<int> ranks;
    for (const NearBody &body : around->second.bodies)
      if (receptor->partner == body.number || is_near(receptor->place, body.box, reach)) ranks.insert(body.rank);
    if (ranks.empty()) return;
    ranks.insert(here);
    for (const int rank : ranks) {
      own.push_back({name_of(b, r),
                     bodies()[b].species,
                     here,
                     !receptor->is_bound(),
                     {static_cast<int>(receptor->partner), static_cast<int>(receptor->other)},
                     receptor->place});
      to.push_back(rank);
    }
  });
  PetscCall(send_to_ranks(flow_.domain.comm(), to, &own));
  near_.swap(own);
  std::sort(near_.begin(), near_.end(),
            [](const NearReceptor &one, const NearReceptor &other) { return one.name < other.name; });
  PetscFunctionReturn(0);
}

// Releases receptors whose partner has left with its body.
void Adhesion::find_bonds() {
  bonds_.clear();
  for_receptors([&](std::size_t b, std::size_t r, Receptor *receptor) {
    if (!receptor->is_bound()) return;
    const bool wall = receptor->partner == Receptor::wall;
    const NearReceptor *other =
        wall ? nullptr : find_near({static_cast<int>(receptor->partner), static_cast<int>(receptor->other)});
    if (!wall && !other) return;
    const Real3 span = way(receptor->place, wall ? receptor->anchor : other->place);
    const double length = length_of(span), tension = law(*receptor).tension(length);
    const double share = length > 0 ? tension / length : 0;
    for (int d = 0; d < 3 && !wall; ++d) receptor->anchor[d] = receptor->place[d] + span[d];
    bonds_.push_back({b, r, {share * span[0], share * span[1], share * span[2]}, tension});
  });
}

// Sends the forces of bonds to the flow. Each end of a bond between bodies adds its own; at walls of the domain the
// other end adds none.
PetscErrorCode Adhesion::send_forces() {
  std::vector<PointForce> forces;
  double most = 0;
  PetscFunctionBeginUser;
  for (std::size_t n = 0, first = 0; n < bonds_.size(); ++n) {
    const Bond &bond = bonds_[n];
    if (bond.body != bonds_[first].body) first = n;
    most = std::max(most, double(n - first + 1));
    const FreeBodies::Body &body = bodies()[bond.body];
    const Receptor &receptor = body.receptors[bond.receptor];
    const ReceptorName name = name_of(bond.body, bond.receptor);
    const Real3 &pull = bond.pull;
    int point = 0;
    for (const auto &[place, weight] : attachment_of(body.box, body.phase, receptor.place))
      forces.push_back({name.body, name.index, point++, place, {weight * pull[0], weight * pull[1], weight * pull[2]}});
    if (is_on_grid(spec_.pairs[static_cast<std::size_t>(receptor.pair)]))
      forces.push_back(
          {name.body, name.index, PointForce::on_surface, receptor.anchor, {-pull[0], -pull[1], -pull[2]}});
  }
  PetscCall(forces_.set(std::move(forces)));
  PetscCallMPI(MPI_Allreduce(&most, &most_, 1, MPI_DOUBLE, MPI_MAX, flow_.domain.comm()));
  PetscFunctionReturn(0);
}

// Rebuilds the bonds and their forces after bodies may have left or their boxes have been refitted.
PetscErrorCode Adhesion::rebuild_bonds() {
  PetscFunctionBeginUser;
  PetscCall(update_surroundings());
  PetscCall(send_near_receptors());
  find_bonds();
  PetscCall(send_forces());
  PetscFunctionReturn(0);
}

PetscErrorCode Adhesion::move(double dt, std::vector<Phase> *phases) {
  PetscFunctionBeginUser;
  if (phases != &flow_.now.phases) PetscFunctionReturn(0);
  EventScope scope(Event::adhesion);
  travel_ += flow_.now.crossing_rate * dt;
  broken_.clear();
  PetscCall(update_surroundings());
  PetscCall(query_grid(dt));
  PetscCall(send_near_receptors());
  release_lost();
  find_bonds();
  break_bonds(dt);
  form_bonds_to_walls(dt);
  PetscCall(form_bonds_of_bodies(dt));
  find_bonds();
  PetscCall(send_forces());
  PetscFunctionReturn(0);
}

// Removes the forces of the bonds of bodies that have left.
PetscErrorCode Adhesion::end_step() {
  PetscFunctionBeginUser;
  if (fits_ != boxed_.bodies().fits()) PetscCall(rebuild_bonds());
  PetscFunctionReturn(0);
}

double Adhesion::largest_step() const {
  constexpr double pi = 3.14159265358979323846;
  const Domain &domain = flow_.domain;
  double shortest = HUGE_VAL, h = domain.spacing()[0];
  for (int d = 1; d < domain.dimension(); ++d) h = std::min(h, domain.spacing()[d]);
  for (const AdhesionPair &pair : spec_.pairs) {
    const double stiffness = pair.law.stiffness * std::max(1.0, most_);
    // The two forces on an attachment to a solid move it up to three times as fast as one force would.
    const double drag = pi * flow_.fluid.viscosity * h, mass = flow_.fluid.density * h * h * h / 3;
    if (stiffness > 0) shortest = std::min(shortest, std::max(drag / stiffness, std::sqrt(mass / stiffness)));
    const double rate = std::max(pair.law.rate_on, pair.law.off_rate(0));
    if (rate > 0) shortest = std::min(shortest, 0.2 / rate);
  }
  return shortest;
}

PetscErrorCode Adhesion::begin_slope(double dt, Field &slope) {
  PetscFunctionBeginUser;
  forces_.add({{&slope, -1 / dt}});
  PetscFunctionReturn(0);
}

PetscErrorCode Adhesion::add_rate(const MomentumRate &rate) {
  PetscFunctionBeginUser;
  std::vector<WeightedTarget> targets{{&rate.field, rate.scale}};
  if (rate.slope.field) targets.push_back(rate.slope);
  forces_.add(targets);
  PetscFunctionReturn(0);
}

PetscErrorCode Adhesion::add_power(const SynchronisedBodies &, double *power) {
  PetscFunctionBeginUser;
  PetscCall(forces_.add_power(power));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
