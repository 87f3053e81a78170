// The values of one body in summary.json and bodies.h5.
#pragma once

#include "adhesion/bond_records.hpp"
#include "bodies/measures.hpp"
#include "membranes/surface_measures.hpp"

namespace eulastic {

struct BodyRecord {
  BodyMeasure body;
  double largest_stretch = 0;  ///< largest principal stretch anywhere in it; of a membrane along its surface
  SurfaceMeasure surface;      ///< of a membrane
  Real3 force{}, torque{};     ///< of the fluid on a body that bears loads; 0 of others
  BodyBonds bonds;             ///< of a body that adheres
};

/// Calls visit(name, value) for all numbers of a record, the value a double or a Real3; on request also for those of
/// membranes, loads and bonds.
template <class Visit>
void for_numbers(const BodyRecord &record, bool membranes, bool loads, bool bonds, const Visit &visit) {
  const BodyMeasure &body = record.body;
  visit("centroid", body.centroid);
  visit("velocity", body.velocity);
  visit("volume", body.volume);
  visit("taylor_deformation", body.taylor_deformation);
  visit("inclination", body.inclination);
  visit("elastic_energy", body.elastic_energy);
  visit("largest_stretch", record.largest_stretch);
  visit("rest_deformation", body.rest_deformation);
  if (membranes) {
    visit("surface_area", record.surface.area);
    visit("shear_energy", record.surface.shear_energy);
    visit("area_energy", record.surface.area_energy);
    visit("bending_energy", record.surface.bending_energy);
    visit("turning_rate", record.surface.turning_rate);
  }
  if (loads) {
    visit("force", record.force);
    visit("torque", record.torque);
  }
  if (!bonds) return;
  visit("bonds", double(record.bonds.bonds));
  visit("bond_force", record.bonds.force);
  visit("bond_tension", record.bonds.tension);
  visit("bond_age", record.bonds.age);
}

}  // namespace eulastic
