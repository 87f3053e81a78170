// Rigid bodies in a scene that is set up by hand.
#pragma once

#include "bodies/fill_phase.hpp"
#include "bodies/rigid.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

namespace eulastic::test {

/// Adds one body of every species, all of them rigid, at its centre; before prepare().
inline void add_rigid(Scene *scene, const std::vector<SpeciesSpec> &species) {
  RigidBuilder builder(scene->grid, scene->solver.exchange());
  for (SpeciesSpec spec : species) {
    spec.law = Law::rigid;
    spec.centre_given = true;
    std::vector<BodyPlace> places;
    EXPECT_EQ(place_bodies(spec, scene->grid.spec(), &places), "");
    Phase phase;
    EXPECT_EQ(fill_phase(scene->grid, spec, places, 1, &phase), 0);
    EXPECT_EQ(builder.add(spec, places, &phase), 0);
    scene->solver.state().phases.push_back(std::move(phase));
  }
  std::unique_ptr<RigidFaces> faces;
  EXPECT_EQ(builder.finish(&faces), 0);
  EXPECT_EQ(scene->solver.set_rigid(std::move(faces)), 0);
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
