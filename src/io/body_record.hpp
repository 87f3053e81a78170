// What summary.json and bodies.h5 say of one body.
#pragma once

#include "grid/box.hpp"

#include <string>

namespace eulastic {

struct BodyRecord {
  long id = 0;  ///< 1 + index over all bodies: the value in `body`
  std::string species;
  Real3 centroid{};               ///< unwrapped: counts the crossings of periodic sides
  Real3 velocity{};               ///< mean over the body
  double volume = 0;              ///< area in 2-D
  double taylor_deformation = 0;  ///< (a - c) / (a + c), lengths from second moments
  double inclination = 0;         ///< degrees of the long axis from x in the xy plane
  double elastic_energy = 0;
  double largest_stretch = 0;   ///< largest principal stretch anywhere in it, from tr B
  double rest_deformation = 0;  ///< taylor_deformation of what is left when the mean of B is undone
  Real3 force{}, torque{};      ///< of the fluid on a body that bears loads; 0 of others
  double bonds = 0, bond_tension = 0, bond_age = 0;  ///< of adhesion: number, means
  Real3 bond_force{};                                ///< of all of them, on the body
  /// Of membranes: area (2-D: length) of the surface, energies, angular velocity at which it goes round in the xy
  /// plane.
  double surface_area = 0, shear_energy = 0, area_energy = 0, bending_energy = 0, turning_rate = 0;
};

/// Calls visit(name, value) for all numbers of a record, the value a double or a Real3; on request also for those of
/// membranes, loads and bonds.
template <class Visit>
void for_numbers(const BodyRecord &body, bool membranes, bool loads, bool bonds, const Visit &visit) {
  visit("centroid", body.centroid);
  visit("velocity", body.velocity);
  visit("volume", body.volume);
  visit("taylor_deformation", body.taylor_deformation);
  visit("inclination", body.inclination);
  visit("elastic_energy", body.elastic_energy);
  visit("largest_stretch", body.largest_stretch);
  visit("rest_deformation", body.rest_deformation);
  if (membranes) {
    visit("surface_area", body.surface_area);
    visit("shear_energy", body.shear_energy);
    visit("area_energy", body.area_energy);
    visit("bending_energy", body.bending_energy);
    visit("turning_rate", body.turning_rate);
  }
  if (loads) {
    visit("force", body.force);
    visit("torque", body.torque);
  }
  if (!bonds) return;
  visit("bonds", body.bonds);
  visit("bond_force", body.bond_force);
  visit("bond_tension", body.bond_tension);
  visit("bond_age", body.bond_age);
}

}  // namespace eulastic
