#include "adhesion/adhesion.hpp"

#include "base/events.hpp"
#include "base/philox.hpp"
#include "parts/state.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace eulastic {
namespace {

// The faces of component a around a place and their weights, linear along each direction. Indices are those of the
// domain, not wrapped.
struct Around {
  int first[3]{};
  double part[3]{};

  Around(const Box &box, int a, const double place[3]) {
    for (int d = 0; d < box.dimension(); ++d) {
      const double at = place[d] / box.spacing()[d] - (d == a ? 0 : 0.5), low = std::floor(at);
      first[d] = static_cast<int>(low);
      part[d] = at - low;
    }
  }
  /// visit(i, j, k, weight)
  template <class Visit>
  void for_faces(int dimension, const Visit &visit) const {
    for (int corner = 0; corner < (dimension == 3 ? 8 : 4); ++corner) {
      int index[3]{first[0], first[1], first[2]};
      double weight = 1;
      for (int d = 0; d < dimension; ++d) {
        const int step = corner >> d & 1;
        index[d] += step;
        weight *= step ? part[d] : 1 - part[d];
      }
      visit(index[0], index[1], index[2], weight);
    }
  }
};

double length_of(const Real3 &way) { return std::sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]); }

int number_of(const std::vector<Receptor> &receptors, std::ptrdiff_t which) {
  return which < 0 ? 0 : static_cast<int>(receptors[which].body);
}

}  // namespace

PetscErrorCode Adhesion::carry(CarriedState *state) {
  PetscFunctionBeginUser;
  for (Receptor &receptor : receptors_) {
    auto &numbers = state->reals["receptors"];
    for (double *number : {&receptor.body, &receptor.partner, &receptor.pair, &receptor.since})
      numbers.push_back(number);
    for (int d = 0; d < 3; ++d) numbers.insert(numbers.end(), {&receptor.place[d], &receptor.anchor[d]});
  }
  PetscFunctionReturn(0);
}

PetscErrorCode Adhesion::start() {
  PetscFunctionBeginUser;
  PetscCall(place_receptors(spec_, flow_.domain, boxed_.list(), &receptors_));
  find_bonds();
  PetscFunctionReturn(0);
}

PetscErrorCode Adhesion::resume() {
  PetscFunctionBeginUser;
  find_bonds();
  PetscFunctionReturn(0);
}

Real3 Adhesion::way_to(const Receptor &from, const double to[3]) const {
  const Domain &domain = flow_.domain;
  Real3 way{};
  for (int d = 0; d < domain.dimension(); ++d) {
    way[d] = to[d] - from.place[d];
    const double length = domain.domain_shape().length[d];
    if (!domain.is_wall(d)) way[d] -= length * std::round(way[d] / length);
  }
  return way;
}

// Every bond once, in the order of receptors.
void Adhesion::find_bonds() {
  bonds_.clear();
  for (std::size_t r = 0; r < receptors_.size(); ++r) {
    const Receptor &receptor = receptors_[r];
    const auto other = static_cast<std::ptrdiff_t>(receptor.partner);
    if (!receptor.is_bound() || (other >= 0 && other < static_cast<std::ptrdiff_t>(r))) continue;
    const Real3 way = way_to(receptor, other < 0 ? receptor.anchor : receptors_[other].place);
    const double length = length_of(way);
    const double tension = law(receptor).tension(length), share = length > 0 ? tension / length : 0;
    bonds_.push_back({r, other, {share * way[0], share * way[1], share * way[2]}, tension});
  }
}

// Of the grid, linear between faces, by the rank that owns the cell of the place: in a sum over all ranks the others
// have 0, which changes no bit.
PetscErrorCode Adhesion::find_velocity(const std::vector<Real3> &places, std::vector<Real3> *velocities) const {
  const Domain &domain = flow_.domain;
  const Field &velocity = flow_.now.velocity;
  PetscFunctionBeginUser;
  velocities->assign(places.size(), {});
  for (std::size_t p = 0; p < places.size(); ++p) {
    int cell[3]{}, shift[3]{};
    for (int d = 0; d < domain.dimension(); ++d) {
      const int plain = static_cast<int>(std::floor(places[p][d] / domain.spacing()[d]));
      cell[d] = domain.is_wall(d) ? std::clamp(plain, 0, domain.domain_cells()[d] - 1) : domain.image(d, plain);
      shift[d] = (domain.is_wall(d) ? 0 : cell[d] - plain) - domain.layout().begin[d];
    }
    if (domain.owner(cell[0], cell[1], cell[2]) != domain.rank()) continue;
    for (int a = 0; a < domain.dimension(); ++a) {
      const ConstView v = velocity[a];
      Around(domain, a, places[p].data()).for_faces(domain.dimension(), [&](int i, int j, int k, double weight) {
        (*velocities)[p][a] += weight * v(i + shift[0], j + shift[1], k + shift[2]);
      });
    }
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, velocities->data(), static_cast<int>(3 * places.size()), MPI_DOUBLE, MPI_SUM,
                             domain.comm()));
  PetscFunctionReturn(0);
}

// By the midpoint rule, with the anchors of bonds: on walls the velocity between faces is that of the wall.
PetscErrorCode Adhesion::move_receptors(double dt) {
  const Domain &domain = flow_.domain;
  std::vector<double *> moved;
  std::vector<Real3> places, velocities;
  PetscFunctionBeginUser;
  for (Receptor &receptor : receptors_) moved.push_back(receptor.place);
  for (Receptor &receptor : receptors_)
    if (receptor.partner == Receptor::wall) moved.push_back(receptor.anchor);
  for (const double *place : moved) places.push_back({place[0], place[1], place[2]});
  PetscCall(find_velocity(places, &velocities));
  for (std::size_t p = 0; p < places.size(); ++p)
    for (int d = 0; d < 3; ++d) places[p][d] += 0.5 * dt * velocities[p][d];
  PetscCall(find_velocity(places, &velocities));
  for (std::size_t p = 0; p < places.size(); ++p)
    for (int d = 0; d < domain.dimension(); ++d) {
      moved[p][d] += dt * velocities[p][d];
      const double length = domain.domain_shape().length[d];
      if (domain.is_wall(d)) moved[p][d] = std::clamp(moved[p][d], 0.0, length);
    }
  PetscFunctionReturn(0);
}

// What receptors have drifted off their surfaces is taken back by the rank that has the body. Those of bodies that no
// rank has any more are given up.
PetscErrorCode Adhesion::follow_surfaces() {
  std::vector<std::array<double, 4>> ways(receptors_.size());  // and 1 where the body is there
  std::map<int, const BodyInBox *> own;
  const std::vector<BodyInBox> bodies = boxed_.list();
  PetscFunctionBeginUser;
  for (const BodyInBox &body : bodies) own[body.number] = &body;
  for (std::size_t r = 0; r < receptors_.size(); ++r) {
    const auto body = own.find(static_cast<int>(receptors_[r].body));
    if (body == own.end()) continue;
    const Real3 way = way_to_surface(*body->second, receptors_[r].place);
    ways[r] = {way[0], way[1], way[2], 1};
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, ways.data(), static_cast<int>(4 * ways.size()), MPI_DOUBLE, MPI_SUM,
                             flow_.domain.comm()));
  for (std::size_t r = 0; r < receptors_.size(); ++r) {
    for (int d = 0; d < 3; ++d) receptors_[r].place[d] += ways[r][d];
    if (ways[r][3] > 0 || !receptors_[r].alive()) continue;
    if (receptors_[r].is_bound()) release(&receptors_[r], 0);
    receptors_[r].body = 0;
  }
  PetscFunctionReturn(0);
}

double Adhesion::random(std::size_t receptor, unsigned which) const {
  const auto step = static_cast<std::uint64_t>(flow_.now.step);
  return uniform(philox({static_cast<std::uint32_t>(receptor), static_cast<std::uint32_t>(step),
                         static_cast<std::uint32_t>(step >> 32), which},
                        {static_cast<std::uint32_t>(spec_.seed), 2}));
}

void Adhesion::release(Receptor *receptor, double tension) {
  const auto other = static_cast<std::ptrdiff_t>(receptor->partner);
  events_.push_back({flow_.now.time, false, static_cast<int>(receptor->body), number_of(receptors_, other),
                     static_cast<int>(receptor->pair), tension, flow_.now.time - receptor->since});
  if (other >= 0) receptors_[other].partner = Receptor::none;
  receptor->partner = Receptor::none;
}

void Adhesion::break_bonds(double dt) {
  for (const Bond &bond : bonds_) {
    Receptor &receptor = receptors_[bond.receptor];
    if (!receptor.is_bound()) continue;
    if (random(bond.receptor, 0) < kernels::probability(law(receptor).off_rate(bond.tension), dt))
      release(&receptor, bond.tension);
  }
}

// Receptors that may bind in this step: those that were free when it began.
std::vector<char> Adhesion::find_free() const {
  std::vector<char> free;
  for (const Receptor &receptor : receptors_) free.push_back(receptor.alive() && !receptor.is_bound());
  return free;
}

// Whether a pair is adhesive at a place.
bool Adhesion::is_in_region(const AdhesionPair &pair, const Real3 &place) const {
  const Domain &domain = flow_.domain;
  bool inside = true;
  for (int d = 0; d < domain.dimension(); ++d) {
    const double length = domain.domain_shape().length[d];
    const double wrapped = domain.is_wall(d) ? place[d] : place[d] - length * std::floor(place[d] / length);
    inside = inside && wrapped >= pair.low[d] && wrapped <= pair.high[d];
  }
  return inside;
}

// Where a receptor would bind to a wall of the box.
Foot Adhesion::foot_on_wall(const AdhesionPair &pair, const Receptor &receptor) const {
  const Domain &domain = flow_.domain;
  double nearest = HUGE_VAL;
  Foot foot;
  for (const auto [d, high] : domain.sides()) {
    if (flow_.spec.sides[d][high].kind != SideKind::wall) continue;
    const double end = high ? domain.domain_shape().length[d] : 0;
    const double distance = std::fabs(receptor.place[d] - end);
    Real3 place{receptor.place[0], receptor.place[1], receptor.place[2]};
    place[d] = end;
    if (distance >= nearest || !is_in_region(pair, place)) continue;
    nearest = distance;
    foot = {place, 1};
  }
  return foot;
}

// Free receptors and what they may bind to that is no other receptor: the nearest of all pairs.
PetscErrorCode Adhesion::form_bonds_to_walls(double dt, const std::vector<char> &free) {
  std::vector<Real3> places;
  std::vector<double> distances(receptors_.size(), HUGE_VAL);
  std::vector<Foot> anchors(receptors_.size()), feet(receptors_.size());
  std::vector<int> pairs(receptors_.size());
  PetscFunctionBeginUser;
  for (const Receptor &receptor : receptors_)
    places.push_back({receptor.place[0], receptor.place[1], receptor.place[2]});
  for (std::size_t p = 0; p < spec_.pairs.size(); ++p) {
    const AdhesionPair &pair = spec_.pairs[p];
    std::vector<char> wanted(free);
    for (std::size_t r = 0; r < wanted.size(); ++r)
      wanted[r] = wanted[r] && static_cast<int>(receptors_[r].species) == pair.first;
    if (is_on_grid(pair)) PetscCall(find_feet(flow_.domain, flow_.now.phases[pair.second], places, wanted, &feet));
    for (std::size_t r = 0; r < wanted.size() && (pair.to_wall() || is_on_grid(pair)); ++r) {
      if (!wanted[r]) continue;
      const Foot foot = pair.to_wall() ? foot_on_wall(pair, receptors_[r]) : feet[r];
      if (!(foot.found > 0) || !is_in_region(pair, foot.place)) continue;
      const Real3 way = way_to(receptors_[r], foot.place.data());
      const double distance = length_of(way);
      if (distance > pair.law.reach || distance >= distances[r]) continue;
      distances[r] = distance;
      anchors[r] = foot;
      pairs[r] = static_cast<int>(p);
    }
  }
  for (std::size_t r = 0; r < receptors_.size(); ++r) {
    if (!(distances[r] < HUGE_VAL)) continue;
    if (random(r, 1) >= kernels::probability(spec_.pairs[pairs[r]].law.on_rate(distances[r]), dt)) continue;
    Receptor &receptor = receptors_[r];
    receptor.partner = Receptor::wall;
    receptor.pair = pairs[r];
    receptor.since = flow_.now.time;
    std::copy_n(anchors[r].place.data(), 3, receptor.anchor);
    note_formed(r);
  }
  PetscFunctionReturn(0);
}

// The pair by which a receptor binds to the nearest free one of another body within reach, of those after it.
struct Adhesion::Candidate {
  double distance = HUGE_VAL;
  std::size_t other = 0;
  int pair = -1;
};

Adhesion::Candidate Adhesion::nearest_partner(std::size_t r, const ReceptorBins &bins) const {
  const Receptor &receptor = receptors_[r];
  Candidate nearest;
  bins.for_near(receptor, [&](std::size_t s) {
    const Receptor &candidate = receptors_[s];
    if (s <= r || candidate.is_bound() || candidate.body == receptor.body) return;
    for (std::size_t p = 0; p < spec_.pairs.size(); ++p) {
      const AdhesionPair &pair = spec_.pairs[p];
      if (!pair.joins(static_cast<int>(receptor.species), static_cast<int>(candidate.species))) continue;
      const Real3 way = way_to(receptor, candidate.place);
      const double distance = length_of(way);
      const bool is_nearer = distance < nearest.distance || (distance == nearest.distance && s < nearest.other);
      if (distance <= pair.law.reach && is_nearer) nearest = {distance, s, static_cast<int>(p)};
    }
  });
  return nearest;
}

void Adhesion::form_bonds_of_bodies(double dt, const std::vector<char> &free) {
  double reach = 0;
  for (const AdhesionPair &pair : spec_.pairs)
    if (!pair.to_wall() && !is_on_grid(pair)) reach = std::max(reach, pair.law.reach);
  if (!(reach > 0)) return;
  ReceptorBins bins(flow_.domain, reach);
  for (std::size_t r = 0; r < receptors_.size(); ++r)
    if (free[r] && !receptors_[r].is_bound()) bins.add(r, receptors_[r]);
  for (std::size_t r = 0; r < receptors_.size(); ++r) {
    Receptor &receptor = receptors_[r];
    if (!free[r] || receptor.is_bound()) continue;
    const Candidate found = nearest_partner(r, bins);
    if (found.pair < 0) continue;
    if (random(r, 2) >= kernels::probability(spec_.pairs[found.pair].law.on_rate(found.distance), dt)) continue;
    receptor.partner = double(found.other);
    receptors_[found.other].partner = double(r);
    for (Receptor *end : {&receptor, &receptors_[found.other]}) {
      end->pair = found.pair;
      end->since = flow_.now.time;
    }
    note_formed(r);
  }
}

void Adhesion::note_formed(std::size_t r) {
  const Receptor &receptor = receptors_[r];
  events_.push_back({flow_.now.time, true, static_cast<int>(receptor.body),
                     number_of(receptors_, static_cast<std::ptrdiff_t>(receptor.partner)),
                     static_cast<int>(receptor.pair), 0, 0});
}

PetscErrorCode Adhesion::move(double dt, std::vector<Phase> *phases) {
  PetscFunctionBeginUser;
  if (phases != &flow_.now.phases || receptors_.empty()) PetscFunctionReturn(0);
  VerbScope scope(Verb::adhesion);
  PetscCall(move_receptors(dt));
  PetscCall(follow_surfaces());
  find_bonds();
  const std::vector<char> free = find_free();
  break_bonds(dt);
  PetscCall(form_bonds_to_walls(dt, free));
  form_bonds_of_bodies(dt, free);
  find_bonds();
  PetscFunctionReturn(0);
}

double Adhesion::largest_step() const {
  constexpr double pi = 3.14159265358979323846;
  const Domain &domain = flow_.domain;
  std::map<double, int> bonds_of;
  for (const Bond &bond : bonds_) ++bonds_of[receptors_[bond.receptor].body];
  int most = 1;
  for (const auto &[body, bonds] : bonds_of) most = std::max(most, bonds);
  double shortest = HUGE_VAL, h = domain.spacing()[0];
  for (int d = 1; d < domain.dimension(); ++d) h = std::min(h, domain.spacing()[d]);
  for (const AdhesionPair &pair : spec_.pairs) {
    const double stiffness = pair.law.stiffness * most;
    const double drag = 3 * pi * flow_.fluid.viscosity * h, mass = flow_.fluid.density * h * h * h;
    if (stiffness > 0) shortest = std::min(shortest, std::max(drag / stiffness, std::sqrt(mass / stiffness)));
    const double rate = std::max(pair.law.rate_on, pair.law.off_rate(0));
    if (rate > 0) shortest = std::min(shortest, 0.2 / rate);
  }
  return shortest;
}

bool Adhesion::is_on_grid(const AdhesionPair &pair) const {
  return !pair.to_wall() && !flow_.now.phases[pair.second].boxed;
}

// Where a bond pulls on the flow with its other end too; null: a wall of the box bears that.
const double *Adhesion::other_end(const Bond &bond) const {
  const Receptor &receptor = receptors_[bond.receptor];
  if (bond.other >= 0) return receptors_[bond.other].place;
  return is_on_grid(spec_.pairs[static_cast<std::size_t>(receptor.pair)]) ? receptor.anchor : nullptr;
}

// On the faces around a place, with the weights with which the velocity is read there, so that the power of a force is
// what it does on the flow. Of a face behind a side the velocity is that of its mirror image with a sign, and so is
// the force. Faces on walls are theirs.
void Adhesion::add_at(const double place[3], const Real3 &force, double factor, Field *field) const {
  const Domain &domain = flow_.domain;
  const Layout &layout = domain.layout();
  for (int a = 0; a < domain.dimension(); ++a) {
    const View out = (*field)[a];
    Around(domain, a, place).for_faces(domain.dimension(), [&](int i, int j, int k, double weight) {
      int at[3] = {i, j, k};
      for (int d = 0; d < domain.dimension(); ++d) {
        const int cells = domain.domain_cells()[d];
        if (!domain.is_wall(d)) {
          at[d] = domain.image(d, at[d]);
        } else if (d == a) {
          if (at[d] < 1 || at[d] >= cells) return;
        } else if (at[d] < 0 || at[d] >= cells) {
          if (is_solid(flow_.spec.sides[d][at[d] >= cells].kind)) weight = -weight;
          at[d] = at[d] < 0 ? -1 - at[d] : 2 * cells - 1 - at[d];
        }
        at[d] -= layout.begin[d];
        if (at[d] < 0 || at[d] >= layout.cells[d]) return;
      }
      out(at[0], at[1], at[2]) += factor * weight * force[a];
    });
  }
}

void Adhesion::add(const std::vector<WeightedTarget> &targets) const {
  const double per_mass = 1 / (flow_.fluid.density * flow_.domain.cell_volume());
  for (const Bond &bond : bonds_)
    for (const WeightedTarget &target : targets) {
      add_at(receptors_[bond.receptor].place, bond.pull, target.factor * per_mass, target.field);
      if (const double *end = other_end(bond)) add_at(end, bond.pull, -target.factor * per_mass, target.field);
    }
}

PetscErrorCode Adhesion::begin_slope(double dt, Field &slope) {
  PetscFunctionBeginUser;
  add({{&slope, -1 / dt}});
  PetscFunctionReturn(0);
}

PetscErrorCode Adhesion::add_rate(const MomentumRate &rate) {
  PetscFunctionBeginUser;
  std::vector<WeightedTarget> targets{{&rate.field, rate.scale}};
  if (rate.slope.field) targets.push_back(rate.slope);
  add(targets);
  PetscFunctionReturn(0);
}

// Bonds come and go within a step: all rows around receptors.
void Adhesion::mark_forced_rows(std::vector<char> *rows) const {
  const Domain &domain = flow_.domain;
  const Layout &layout = domain.layout();
  for (const Receptor &receptor : receptors_) {
    if (!receptor.alive()) continue;
    int first[3]{};
    for (int d = 0; d < domain.dimension(); ++d)
      first[d] = static_cast<int>(std::floor(receptor.place[d] / domain.spacing()[d]));
    for (int z = -(domain.dimension() == 3); z <= (domain.dimension() == 3); ++z)
      for (int y = -1; y <= 1; ++y) {
        const int j = (domain.is_wall(1) ? first[1] + y : domain.image(1, first[1] + y)) - layout.begin[1];
        const int k = (domain.is_wall(2) ? first[2] + z : domain.image(2, first[2] + z)) - layout.begin[2];
        if (j >= 0 && j < layout.cells[1] && k >= 0 && k < layout.cells[2])
          (*rows)[j + std::size_t(layout.cells[1]) * k] = 1;
      }
  }
}

PetscErrorCode Adhesion::add_power(const FlowLook &, double *power) {
  std::vector<Real3> places, velocities;
  const auto add_place = [&](const double *place) { places.push_back({place[0], place[1], place[2]}); };
  PetscFunctionBeginUser;
  for (const Bond &bond : bonds_) {
    add_place(receptors_[bond.receptor].place);
    add_place(other_end(bond) ? other_end(bond) : receptors_[bond.receptor].place);
  }
  PetscCall(find_velocity(places, &velocities));
  for (std::size_t b = 0; b < bonds_.size(); ++b)
    for (int d = 0; d < 3; ++d) {
      *power += bonds_[b].pull[d] * velocities[2 * b][d];
      if (other_end(bonds_[b])) *power -= bonds_[b].pull[d] * velocities[2 * b + 1][d];
    }
  PetscFunctionReturn(0);
}

std::vector<BodyBonds> Adhesion::measure() const {
  std::map<int, BodyBonds> of;
  for (const Receptor &receptor : receptors_)
    if (receptor.alive()) of[static_cast<int>(receptor.body)].body = static_cast<int>(receptor.body);
  const auto add_to = [&](std::size_t r, const Bond &bond, double sign) {
    BodyBonds &body = of[static_cast<int>(receptors_[r].body)];
    ++body.bonds;
    for (int d = 0; d < 3; ++d) body.force[d] += sign * bond.pull[d];
    body.tension += bond.tension;
    body.age += flow_.now.time - receptors_[r].since;
  };
  for (const Bond &bond : bonds_) {
    add_to(bond.receptor, bond, 1);
    if (bond.other >= 0) add_to(static_cast<std::size_t>(bond.other), bond, -1);
  }
  std::vector<BodyBonds> all;
  for (auto &[number, body] : of) {
    body.tension /= std::max(body.bonds, 1);
    body.age /= std::max(body.bonds, 1);
    all.push_back(body);
  }
  return all;
}

std::vector<Adhesion::Line> Adhesion::lines() const {
  std::vector<Line> lines;
  for (const Bond &bond : bonds_) {
    const Receptor &receptor = receptors_[bond.receptor];
    const Real3 way = way_to(receptor, bond.other < 0 ? receptor.anchor : receptors_[bond.other].place);
    Line line{static_cast<int>(receptor.body), number_of(receptors_, bond.other), {}, {}, bond.tension, receptor.since};
    for (int d = 0; d < 3; ++d) {
      line.from[d] = receptor.place[d];
      line.to[d] = receptor.place[d] + way[d];
    }
    lines.push_back(line);
  }
  return lines;
}

}  // namespace eulastic
