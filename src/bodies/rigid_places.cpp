// RigidBodies: where bodies are at a time.
#include "bodies/fill_phase.hpp"
#include "bodies/rigid.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace eulastic {

// In the box: across periodic sides a body comes back on the other one.
BodyPlace RigidBodies::place_of(const BodyPlace &start, const Real3 &shift) const {
  BodyPlace place = start;
  for (int d = 0; d < grid_.dimension(); ++d) {
    const double length = grid_.spec().length[d];
    place.centre[d] += shift[d];
    if (shift[d] != 0 && !grid_.is_wall(d)) place.centre[d] -= length * std::floor(place.centre[d] / length);
  }
  return place;
}

PetscErrorCode RigidBodies::place(double time, double surface_time) {
  PetscFunctionBeginUser;
  contact_ = {};
  ahead_.assign(faces_.motions.size(), {});
  for (std::size_t m = 0; m < ahead_.size(); ++m)
    for (int d = 0; d < grid_.dimension(); ++d) {
      const RigidMotion &motion = faces_.motions[m];
      ahead_[m][d] = (motion.shift(time)[d] - motion.shift(surface_time)[d]) / grid_.spacing()[d];
    }
  for (int index = 0; index < faces_.count; ++index) {
    const RigidMotion &motion = faces_.motions[faces_.bodies[images * index].motion];
    if (!motion.travels()) continue;
    for (int a = 0; a < grid_.dimension(); ++a) clear(a, index);
  }
  for (int index = 0; index < faces_.count; ++index) {
    const RigidMotion &motion = faces_.motions[faces_.bodies[images * index].motion];
    if (!motion.travels()) continue;
    put(index, place_of(sources_[index].start, motion.shift(time)));
    for (int a = 0; a < grid_.dimension(); ++a) mark(a, index);
  }
  Int3 layers{};
  for (int d = 0; d < grid_.dimension(); ++d) layers[d] = grid_.layout().ghosts[d] - 1;
  std::array<RigidFaces::Component, 3> components;
  faces_.speed = {};
  for (int a = 0; a < grid_.dimension(); ++a) {
    PetscCall(exchange_.update(inside_[a], grid_.layout().ghosts[a]));
    if (level_[a]) PetscCall(exchange_.update(level_[a], grid_.layout().ghosts[a]));
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
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, most.data(), 4, MPI_DOUBLE, MPI_MAX, grid_.comm()));
  std::copy_n(most.begin(), 3, faces_.speed.begin());
  faces_.set(layers, grid_.owned()[1] + 2 * layers[1], std::move(components));
  touching_.clear();
  if (most[3] == 0) PetscFunctionReturn(0);
  const std::array<int, 2> two{static_cast<int>(most[3] / count), static_cast<int>(std::fmod(most[3], count))};
  const auto species = [&](int index) { return species_[faces_.bodies[images * index].motion].spec; };
  const bool first = species(two[0]).travels(grid_.dimension());
  char text[320];
  std::snprintf(text, sizeof text,
                "-%s_velocity: two rigid bodies (%s and %s) come within a cell of each other at t = %.6g; accepted: "
                "paths with fluid between the bodies",
                species(two[first ? 0 : 1]).name.c_str(), species(two[0]).name.c_str(), species(two[1]).name.c_str(),
                time);
  touching_ = text;
  PetscFunctionReturn(0);
}

bool RigidBodies::travels(const Phase &phase) const {
  return std::any_of(species_.begin(), species_.end(), [&](const Species &s) {
    return s.spec.name == phase.species && s.spec.travels(grid_.dimension());
  });
}

PetscErrorCode RigidBodies::fill(double time, std::vector<Phase> *phases) const {
  PetscFunctionBeginUser;
  for (std::size_t s = 0; s < species_.size(); ++s)
    for (Phase &phase : *phases) {
      const RigidMotion &motion = faces_.motions[s];
      if (!motion.travels() || phase.species != species_[s].spec.name) continue;
      Places places = species_[s].places;
      for (BodyPlace &place : places.known) place = place_of(place, motion.shift(time));
      Phase filled;
      PetscCall(fill_phase(grid_, species_[s].spec, places, species_[s].first_label, &filled));
      phase.fraction = std::move(filled.fraction);
      if (phase.label) phase.label = std::move(filled.label);
    }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
