// Rigid bodies in a scene that is set up by hand.
#pragma once

#include "bodies/fill_phase.hpp"
#include "rigid/rigid_bodies.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

namespace eulastic::test {

/// Adds one body of every species, all of them rigid, at its centre; before prepare(). `file`: the first one is known
/// by its solid fraction alone.
inline void add_rigid(Scene *scene, const std::vector<SpeciesSpec> &species, bool file = false) {
  auto bodies = std::make_unique<RigidBodies>(scene->domain, scene->solver.exchange());
  int label = 1;
  for (SpeciesSpec spec : species) {
    spec.law = Law::rigid;
    spec.name = "rigid" + std::to_string(label);
    spec.centre_given = true;
    Places places;
    EXPECT_EQ(place_bodies(spec, scene->domain.domain_shape(), &places), "");
    Phase phase;
    EXPECT_EQ(fill_phase(scene->domain, spec, places, label, &phase), 0);
    if (file && label == 1) spec.shape = Shape::voxels;
    std::string wrong;
    EXPECT_EQ(bodies->add(spec, places, label++, &phase, &wrong), 0);
    EXPECT_EQ(wrong, "");
    scene->solver.state().phases.push_back(std::move(phase));
  }
  EXPECT_EQ(scene->solver.set_rigid(std::move(bodies)), 0);
}

inline SpeciesSpec rigid_body(Shape shape, double radius, const Real3 &centre, int axis = 2) {
  SpeciesSpec spec;
  spec.shape = shape;
  spec.radius = radius;
  spec.centre = centre;
  spec.axis = axis;
  return spec;
}

}  // namespace eulastic::test
