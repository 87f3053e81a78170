#include "output/between.hpp"

#include <cmath>

namespace eulastic {
namespace {

// Strain energies are squares of what grows in proportion to time.
double energy_between(double energy, double other, double share) {
  if (energy < 0 || other < 0) return energy + share * (other - energy);
  const double root = std::sqrt(energy), between = root + share * (std::sqrt(other) - root);
  return between * between;
}

struct Between {
  double share;

  void operator()(double &value, double other) const { value += share * (other - value); }
  void operator()(Real3 &value, const Real3 &other) const {
    for (int d = 0; d < 3; ++d) (*this)(value[d], other[d]);
  }
  template <class T>
  void operator()(std::vector<T> &values, const std::vector<T> &others) const {
    for (std::size_t n = 0; n < values.size(); ++n) (*this)(values[n], others[n]);
  }

  void operator()(FlowMeasures &flow, const FlowMeasures &other) const {
    (*this)(flow.viscous_dissipation, other.viscous_dissipation);
    (*this)(flow.phase_volume, other.phase_volume);
  }
  void operator()(BodyMeasure &body, const BodyMeasure &other) const {
    (*this)(body.volume, other.volume);
    (*this)(body.centroid, other.centroid);
    (*this)(body.velocity, other.velocity);
    (*this)(body.semi_axes, other.semi_axes);
    (*this)(body.taylor_deformation, other.taylor_deformation);
    // Of an axis, known but for half turns.
    body.inclination += share * std::remainder(other.inclination - body.inclination, 180);
    if (body.inclination > 90) body.inclination -= 180;
    if (body.inclination <= -90) body.inclination += 180;
    (*this)(body.elastic_energy, other.elastic_energy);
    (*this)(body.rest_deformation, other.rest_deformation);
    (*this)(body.trace_max, other.trace_max);
  }
  void operator()(SurfaceMeasure &surface, const SurfaceMeasure &other) const {
    (*this)(surface.area, other.area);
    (*this)(surface.shear_energy, other.shear_energy);
    (*this)(surface.area_energy, other.area_energy);
    (*this)(surface.bending_energy, other.bending_energy);
    (*this)(surface.turning_rate, other.turning_rate);
    (*this)(surface.area_strain, other.area_strain);
    (*this)(surface.largest_stretch, other.largest_stretch);
  }
  void operator()(EnergyRates &rates, const EnergyRates &other) const {
    (*this)(rates.force_power, other.force_power);
    (*this)(rates.wall_power, other.wall_power);
    (*this)(rates.elastic_power, other.elastic_power);
    (*this)(rates.extended_power, other.extended_power);
    rates.extended_energy = energy_between(rates.extended_energy, other.extended_energy, share);
  }
};

}  // namespace

void interpolate_between(const Measured &other, double share, Measured *measured) {
  const Between between{share};
  const double energy = measured->flow.elastic_energy, linear = energy + share * (other.flow.elastic_energy - energy);
  measured->flow.elastic_energy = energy_between(energy, other.flow.elastic_energy, share);
  between(measured->flow, other.flow);
  between(measured->surface.energy, other.surface.energy);
  between(measured->surface.power, other.surface.power);
  between(measured->bodies, other.bodies);
  between(measured->surfaces, other.surfaces);
  if (linear > 0)  // together they have that of the flow
    for (BodyMeasure &body : measured->bodies) body.elastic_energy *= measured->flow.elastic_energy / linear;
}

void interpolate_between(const EnergyState &other, double share, EnergyState *energy) {
  const Between between{share};
  energy->elastic = energy_between(energy->elastic, other.elastic, share);
  between(energy->surface, other.surface);
  between(energy->surface_power, other.surface_power);
  between(energy->dissipation, other.dissipation);
  between(energy->rates, other.rates);
}

}  // namespace eulastic
