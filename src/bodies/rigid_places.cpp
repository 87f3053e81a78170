// RigidBodies: where bodies are at a time.
#include "bodies/fill_phase.hpp"
#include "bodies/rigid.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

namespace eulastic {
namespace {

constexpr double most_lost = 0.05;  // volume of a body from a file that travels

// Moments in the coordinates of the box.
RigidMass turned(const RigidMass &mass, const Rotation &R) {
  const auto &[xx, yy, zz, yz, xz, xy] = mass.second;
  const Rotation S{{{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}}};
  const auto second = [&](int a, int b) {
    double sum = 0;
    for (int m = 0; m < 3; ++m)
      for (int n = 0; n < 3; ++n) sum += R[a][m] * S[m][n] * R[b][n];
    return sum;
  };
  RigidMass now{mass.volume, {}, {second(0, 0), second(1, 1), second(2, 2), second(1, 2), second(0, 2), second(0, 1)}};
  for (int a = 0; a < 3; ++a)
    for (int m = 0; m < 3; ++m) now.first[a] += R[a][m] * mass.first[m];
  return now;
}

}  // namespace

// Of a body from a file that travels: all of phi, which every rank gets.
PetscErrorCode RigidBodies::map_file(const SpeciesSpec &spec, const Phase &phase,
                                     std::shared_ptr<const Surface> *surface, RigidMass *mass, std::string *wrong) {
  PetscFunctionBeginUser;
  const int dimension = domain_.dimension();
  const Int3 &N = domain_.domain_cells(), &begin = domain_.layout().begin;
  std::array<int, 6> ends{N[0], N[1], N[2], 1, 1, 1};  // first cells, and -last ones
  for_points(domain_.rows(), [&](int i, int j, int k) {
    const Int3 local{i, j, k};
    for (int d = 0; d < 3 && phase.fraction[0](i, j, k) > 0; ++d) {
      ends[d] = std::min(ends[d], begin[d] + local[d]);
      ends[3 + d] = std::min(ends[3 + d], -(begin[d] + local[d]));
    }
  });
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, ends.data(), 6, MPI_INT, MPI_MIN, domain_.comm()));
  FractionBox box;
  box.size = {1, 1, 1};
  std::ptrdiff_t count = 1;
  Int3 first{};
  for (int d = 0; d < dimension; ++d) {
    if (ends[d] == 0 || -ends[3 + d] == N[d] - 1)
      *wrong = "-" + spec.name + "_voxels: " + spec.voxels.path + " reaches the sides of the box along " + "xyz"[d] +
               ", and what moves there needs fluid around it; accepted: a cell of it, or no motion";
    first[d] = ends[d] - LevelMap::margin;
    box.size[d] = -ends[3 + d] - ends[d] + 1 + 2 * LevelMap::margin;
    box.spacing[d] = domain_.spacing()[d];
    box.first[d] = (first[d] + 0.5) * domain_.spacing()[d] - spec.centre[d];
    count *= box.size[d];
  }
  if (!wrong->empty()) PetscFunctionReturn(0);
  box.fraction.resize(count);
  for_points(domain_.rows(), [&](int i, int j, int k) {
    const double phi = phase.fraction[0](i, j, k);
    if (phi > 0)
      box.fraction[(begin[0] + i - first[0]) +
                   box.size[0] *
                       ((begin[1] + j - first[1]) + std::ptrdiff_t(box.size[1]) * (begin[2] + k - first[2]))] = phi;
  });
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, box.fraction.data(), static_cast<int>(count), MPI_DOUBLE, MPI_SUM, domain_.comm()));
  *surface = std::make_shared<const Surface>(LevelMap(box, dimension));
  *mass = moments(**surface, dimension);
  const double cells = std::accumulate(box.fraction.begin(), box.fraction.end(), 0.0),
               seen = mass->volume / domain_.cell_volume();
  if (std::fabs(seen - cells) > most_lost * cells) {
    char text[160];
    std::snprintf(text, sizeof text,
                  " moves and must be three cells thick to be seen: it would have %.4g cells instead of %.4g; "
                  "accepted: a finer grid, or no motion",
                  seen, cells);
    *wrong = "-" + spec.name + "_voxels: " + spec.voxels.path + text;
  }
  PetscFunctionReturn(0);
}

void RigidBodies::put(int index, const BodyPlace &place) {
  Source &source = sources_[index];
  Real3 centre{};
  for (int d = 0; d < domain_.dimension(); ++d)
    centre[d] = (place.centre[d] - domain_.domain_shape().length[d] / 2) / domain_.spacing()[d];
  if (source.surface) {
    source.body = std::make_unique<PlacedBody>(*source.surface, domain_.domain_shape(), place);
    centre = source.body->centre();
  }
  const int motion = faces_.bodies[images * index].motion;
  if (faces_.motions[motion].turning) faces_.masses[index] = turned(species_[motion].mass, rotation(place.orientation));
  for (int image = 0; image < images; ++image) {
    const Int3 shift{image % 3 - 1, image / 3 % 3 - 1, image / 9 - 1};
    Real3 &there = faces_.bodies[images * index + image].centre;
    there = centre;
    for (int d = 0; d < domain_.dimension(); ++d) there[d] -= shift[d] * domain_.domain_cells()[d];
  }
}

// In the box: across periodic sides a body comes back on the other one.
BodyPlace RigidBodies::place_of(const BodyPlace &start, const RigidMotion &motion, double time) const {
  BodyPlace place = start;
  const Real3 shift = motion.shift(time);
  place.orientation = turned(start.orientation, motion.angle(time));
  for (int d = 0; d < domain_.dimension(); ++d) {
    const double length = domain_.domain_shape().length[d];
    place.centre[d] += shift[d];
    if (shift[d] != 0 && !domain_.is_wall(d)) place.centre[d] -= length * std::floor(place.centre[d] / length);
  }
  return place;
}

PetscErrorCode RigidBodies::place(double time, double surface_time) {
  PetscFunctionBeginUser;
  contact_ = {};
  faces_.ahead.assign(faces_.motions.size(), {});
  for (std::size_t m = 0; m < faces_.ahead.size(); ++m)
    for (int d = 0; d < domain_.dimension(); ++d) {
      const RigidMotion &motion = faces_.motions[m];
      faces_.ahead[m][d] = (motion.shift(time)[d] - motion.shift(surface_time)[d]) / domain_.spacing()[d];
    }
  for (int index = 0; index < faces_.count; ++index) {
    const RigidMotion &motion = faces_.motions[faces_.bodies[images * index].motion];
    if (!motion.travels()) continue;
    for (int a = 0; a < domain_.dimension(); ++a) clear(a, index);
  }
  for (int index = 0; index < faces_.count; ++index) {
    const RigidMotion &motion = faces_.motions[faces_.bodies[images * index].motion];
    if (!motion.travels()) continue;
    Source &source = sources_[index];
    BodyPlace place = place_of(source.start, motion, time);
    put(index, place);
    if (motion.turning && surface_time != time) {
      place.orientation = place_of(source.start, motion, surface_time).orientation;
      source.before = std::make_unique<PlacedBody>(*source.surface, domain_.domain_shape(), place);
    } else {
      source.before.reset();
    }
    for (int a = 0; a < domain_.dimension(); ++a) mark(a, index);
  }
  Int3 layers{};
  for (int d = 0; d < domain_.dimension(); ++d) layers[d] = domain_.layout().ghosts[d] - 1;
  std::array<RigidFaces::Component, 3> components;
  faces_.speed = {};
  for (int a = 0; a < domain_.dimension(); ++a) {
    PetscCall(exchange_.update_ghosts(inside_[a], domain_.layout().ghosts[a]));
    if (level_[a]) PetscCall(exchange_.update_ghosts(level_[a], domain_.layout().ghosts[a]));
    components[a] = component(a, layers);
    for (const RigidFaces::Cut &cut : components[a].cuts) {
      const double along = std::fabs(faces_.motions[faces_.bodies[cut.body].motion].velocity[a]);
      for (const double turn : cut.turn) faces_.speed[a] = std::max(faces_.speed[a], along + std::fabs(turn));
    }
    if (travel()) continue;
    inside_[a] = {};
    level_[a] = {};
  }
  const double count = faces_.count;
  std::array<double, 4> most{faces_.speed[0], faces_.speed[1], faces_.speed[2], contact_[0] * count + contact_[1]};
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, most.data(), 4, MPI_DOUBLE, MPI_MAX, domain_.comm()));
  std::copy_n(most.begin(), 3, faces_.speed.begin());
  faces_.set(layers, domain_.cells()[1] + 2 * layers[1], std::move(components));
  touching_.clear();
  if (most[3] != 0)
    say_touching({static_cast<int>(most[3] / count), static_cast<int>(std::fmod(most[3], count))}, time);
  PetscFunctionReturn(0);
}

void RigidBodies::say_touching(const std::array<int, 2> &bodies, double time) {
  const auto species = [&](int index) { return species_[faces_.bodies[images * index].motion].spec; };
  const SpeciesSpec first = species(bodies[0]), second = species(bodies[1]),
                    mover = first.travels(domain_.dimension()) ? first : second;
  char text[320];
  std::snprintf(text, sizeof text,
                "-%s_%svelocity: two rigid bodies (%s and %s) come within a cell of each other at t = %.6g; accepted: "
                "paths with fluid between the bodies",
                mover.name.c_str(), mover.turns(domain_.dimension()) ? "angular_" : "", first.name.c_str(),
                second.name.c_str(), time);
  touching_ = text;
}

bool RigidBodies::travels(const Phase &phase) const {
  return std::any_of(species_.begin(), species_.end(), [&](const Species &s) {
    return s.spec.name == phase.species && s.spec.travels(domain_.dimension());
  });
}

PetscErrorCode RigidBodies::fill(double time, std::vector<Phase> *phases) const {
  PetscFunctionBeginUser;
  for (std::size_t s = 0; s < species_.size(); ++s)
    for (Phase &phase : *phases) {
      const RigidMotion &motion = faces_.motions[s];
      if (!motion.travels() || phase.species != species_[s].spec.name) continue;
      Places places = species_[s].places;
      for (BodyPlace &place : places.known) place = place_of(place, motion, time);
      Phase filled;
      fill_bodies(domain_, *species_[s].surface, places, species_[s].first_label, &filled);
      phase.fraction = std::move(filled.fraction);
      if (phase.label) phase.label = std::move(filled.label);
    }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
