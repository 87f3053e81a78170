#include "physics/rigid_impulse.hpp"

#include "base/events.hpp"
#include "field/exact_sum.hpp"
#include "physics/rigid_rows.hpp"

#include <algorithm>

namespace eulastic {
namespace {

// In cells: a face on an open side has half of one, on others the side gives the velocity.
double volume_of_face(const Box &box, int a, int i, int j, int k) {
  const int at = box.layout().begin[a] + std::array{i, j, k}[a];
  if (!box.is_wall(a) || (at > 0 && at < box.domain_cells()[a])) return 1;
  return box.is_open(a, at > 0) ? 0.5 : 0;
}

// What a link of a cut face sees: the image of a body that its neighbour is in, and the place of the cut face beside
// it, in cells. The neighbour's own place is in the box.
struct Seen {
  int body;
  Real3 place;
};
Seen seen_by(const Box &box, const RigidFaces &faces, int a, Int3 face, int link) {
  const int d = link / 2, step = link % 2 ? 1 : -1, N = box.domain_cells()[d];
  Seen seen{0, place_of_face(box, a, face[0], face[1], face[2])};
  const double least = (d == a ? 0 : 0.5) - 0.5 * N, neighbour = seen.place[d] + step;
  if (!box.is_wall(d) && neighbour < least) seen.place[d] += N;
  if (!box.is_wall(d) && neighbour > least + N - 1) seen.place[d] -= N;
  face[d] += step;
  const RigidFaces::Row row = faces.row(a, face[1], face[2]);
  for (const RigidFaces::Run *run = row.runs; run != row.runs_end; ++run)
    if (run->begin <= face[0] && face[0] < run->end) seen.body = run->body;
  return seen;
}

}  // namespace

RigidImpulse::RigidImpulse(const Domain &domain, const RigidFaces &faces, const Fluid &fluid)
    : domain_(domain), faces_(faces), fluid_(fluid) {
  const int cells = domain.cells()[0];
  std::array<std::vector<int>, 2> beside{std::vector<int>(cells), std::vector<int>(cells)};
  for (const Segment &row : domain.rows())
    for (int d = 0; d < domain.dimension(); ++d) {
      for (const int high : {0, 1}) faces.find_beside(d, high > 0, row.j, row.k, &beside[high]);
      for (int i = 0; i < cells; ++i)
        for (const int high : {0, 1})
          if (beside[0][i] != beside[1][i] && beside[high][i] >= 0)
            contacts_.push_back({d, i, row.j, row.k, beside[high][i], high ? 1. : -1.});
    }
  for (const RigidFootprint &at : faces.footprints)
    contacts_.push_back({at.direction, at.cell[0], at.cell[1], at.cell[2], at.body, at.high ? at.more : -at.more});
  pressure_.resize(contacts_.size());
  for (int a = 0; a < domain.dimension(); ++a) lacks_[a].resize(faces.cuts(a).size());
}

std::size_t RigidImpulse::bytes() const {
  std::size_t sum = contacts_.capacity() * sizeof(Contact) + pressure_.capacity() * sizeof(double);
  for (int a = 0; a < 3; ++a) sum += (lacks_[a].capacity() + means_.velocity[a].capacity()) * sizeof(double);
  return sum;
}

RigidMeans RigidImpulse::means_of(double time, const FieldBlock &velocity) const {
  RigidMeans means;
  for (int a = 0; a < domain_.dimension(); ++a) means.velocity[a].resize(faces_.cuts(a).size());
  for_rigid_rows(domain_, faces_, [&](int a, const RigidFaces::Row &row, int j, int k) {
    for (const RigidFaces::Cut *cut = row.cuts; cut != row.cuts_end; ++cut)
      if (owned(domain_, a, cut->i)) means.velocity[a][index(a, *cut)] = velocity[a](cut->i, j, k);
  });
  for (const RigidMotion &motion : faces_.motions)
    means.factors.push_back({motion.of_velocity.at(time), motion.of_rotation.at(time)});
  return means;
}

void RigidImpulse::begin(double time, double force_time, const FieldBlock &velocity) {
  means_ = means_of(time, velocity);
  force_ = fluid_.body_force.at(force_time);
  for (std::vector<double> &values : lacks_) std::fill(values.begin(), values.end(), 0.0);
}

void RigidImpulse::add_prediction(double dt, const FieldBlock &velocity, const FieldBlock &velocity_star) {
  for_rigid_rows(domain_, faces_, [&](int a, const RigidFaces::Row &row, int j, int k) {
    const double *before = velocity[a].row(j, k), *after = velocity_star[a].row(j, k);
    for (const RigidFaces::Cut *cut = row.cuts; cut != row.cuts_end; ++cut)
      if (const int i = cut->i; owned(domain_, a, i))
        lacks_[a][index(a, *cut)] += (1 / cut->share - 1) * (after[i] - before[i]) / dt;
  });
}

void RigidImpulse::set_pressure(const FieldBlock &pressure) {
  for (std::size_t n = 0; n < contacts_.size(); ++n)
    pressure_[n] = pressure[0](contacts_[n].i, contacts_[n].j, contacts_[n].k);
}

void RigidImpulse::add_increment(const FieldBlock &increment, bool partly) {
  for (std::size_t n = 0; n < contacts_.size(); ++n)
    pressure_[n] += increment[0](contacts_[n].i, contacts_[n].j, contacts_[n].k);
  if (!partly) return;
  for_rigid_rows(domain_, faces_, [&](int a, const RigidFaces::Row &row, int j, int k) {
    const double *q = increment[0].row(j, k), factor = 1 / (fluid_.density * domain_.spacing()[a]);
    const std::ptrdiff_t step = increment[0].stride(a);
    for (const RigidFaces::Cut *cut = row.cuts; cut != row.cuts_end; ++cut)
      if (const int i = cut->i; owned(domain_, a, i))
        lacks_[a][index(a, *cut)] -= (1 - cut->open) * factor * (q[i] - q[i - step]);
  });
}

// `place` in cells, of a force along a.
void RigidImpulse::add(int body, int a, const Real3 &place, double push, ExactSums *sums) const {
  const Real3 r = RigidFaces::arm(faces_.bodies[body], place, domain_.spacing());
  const int at = 6 * faces_.bodies[body].index;
  Real3 f{};
  f[a] = push;
  sums->add(at + a, push);
  for (int d = 0; d < 3; ++d) {
    const int e = (d + 1) % 3, g = (d + 2) % 3;
    if (e == a || g == a) sums->add(at + 3 + d, r[e] * f[g] - r[g] * f[e]);
  }
}

// The viscous terms of a cut face and of its neighbours inside, as if all were fluid, less what the cut face feels of
// the surface. Inside, the velocity is linear: the other links of the neighbour take what one beyond it would.
void RigidImpulse::add_cut(const RigidMeans &means, int a, const RigidFaces::Cut &cut, int j, int k,
                           ExactSums *sums) const {
  const double volume = volume_of_face(domain_, a, cut.i, j, k);
  if (volume == 0) return;
  const double mass = fluid_.density * domain_.cell_volume() * volume, nu = fluid_.kinematic_viscosity(),
               u = means.velocity[a][index(a, cut)];
  const auto &of_body = means.factors[faces_.bodies[cut.body].motion];
  double wall[6], lacks = lacks_[a][index(a, cut)];
  surface_velocity(faces_, cut, a, of_body[0], of_body[1], wall);
  for (int link = 0; link < 2 * domain_.dimension(); ++link) {
    if (!(cut.walls >> link & 1U)) continue;
    const auto [body, here] = seen_by(domain_, faces_, a, {cut.i, j, k}, link);
    Real3 there = here;
    there[link / 2] += link % 2 ? 1 : -1;
    const auto given = [&, body = body](const Real3 &place) {
      const auto &[along, turning] = means.factors[faces_.bodies[body].motion];
      return faces_.velocity(a, faces_.bodies[body], place, domain_.spacing(), along, turning);
    };
    const double h = domain_.spacing()[link / 2], rate = nu / (h * h);
    lacks += rate * (given(there) - u) - nu * cut.link[link] * (wall[link] - u);
    add(body, a, there, mass * rate * (u - given(here)), sums);
    add(body, a, here, mass * lacks, sums);
    lacks = 0;  // the rest of it is that of the first link's body
  }
}

PetscErrorCode RigidImpulse::sum(const RigidMeans &means, std::vector<double> *total) const {
  PetscFunctionBeginUser;
  ExactSums sums(6 * faces_.count);
  for (std::size_t n = 0; n < contacts_.size(); ++n) {
    const Contact &at = contacts_[n];  // arms along d are those of forces along d, which make no torque
    add(at.body, at.d, place_of_face(domain_, at.d, at.i, at.j, at.k),
        at.weight * pressure_[n] * domain_.cell_volume() / domain_.spacing()[at.d], &sums);
  }
  for_rigid_rows(domain_, faces_, [&](int a, const RigidFaces::Row &row, int j, int k) {
    for (const RigidFaces::Cut *cut = row.cuts; cut != row.cuts_end; ++cut)
      if (owned(domain_, a, cut->i)) add_cut(means, a, *cut, j, k, &sums);
  });
  total->assign(6 * faces_.count, 0);
  PetscCall(sums.reduce(domain_.comm(), total->data()));
  PetscFunctionReturn(0);
}

PetscErrorCode RigidImpulse::measure(double time, const FieldBlock &velocity, std::vector<RigidLoad> *loads) const {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::rigid);
  std::vector<double> total, now(6 * faces_.count);
  PetscCall(sum(means_, &total));
  if (faces_.moves) PetscCall(sum(means_of(time, velocity), &now));
  loads->assign(faces_.count, {});
  for (const RigidBody &body : faces_.bodies) {
    RigidLoad &load = (*loads)[body.index];
    const RigidMotion &motion = faces_.motions[body.motion];
    load.power = 0;
    for (int d = 0; d < 3; ++d) {
      const int at = 6 * body.index + d;
      load.force[d] = total[at];
      load.torque[d] = total[at + 3];
      load.power -= now[at] * motion.velocity[d] * motion.of_velocity.at(time) +
                    now[at + 3] * motion.angular_velocity[d] * motion.of_rotation.at(time);
    }
  }
  // Between the surface and the faces inside the stress balances the body force.
  for (std::size_t b = 0; b < faces_.gaps.size(); ++b)
    for (int a = 0; a < 3; ++a) {
      const double push = -fluid_.density * force_[a];
      (*loads)[b].force[a] += push * faces_.gaps[b].volume[a];
      const int e = (a + 1) % 3, g = (a + 2) % 3;  // r x e_a has r_g along e and -r_e along g
      (*loads)[b].torque[e] += push * faces_.gaps[b].first[a][g];
      (*loads)[b].torque[g] -= push * faces_.gaps[b].first[a][e];
    }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
