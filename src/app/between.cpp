#include "app/between.hpp"

#include <cmath>

namespace eulastic {
namespace {

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
    (*this)(flow.elastic_energy, other.elastic_energy);
    (*this)(flow.phase_volume, other.phase_volume);
  }
  void operator()(RigidLoad &load, const RigidLoad &other) const {
    (*this)(load.force, other.force);
    (*this)(load.torque, other.torque);
    (*this)(load.power, other.power);
  }
  void operator()(SurfaceLoad &load, const SurfaceLoad &other) const {
    (*this)(load.force, other.force);
    (*this)(load.torque, other.torque);
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
  }
  void operator()(EnergyRates &rates, const EnergyRates &other) const {
    (*this)(rates.force_power, other.force_power);
    (*this)(rates.wall_power, other.wall_power);
    (*this)(rates.elastic_power, other.elastic_power);
    (*this)(rates.extended_power, other.extended_power);
    (*this)(rates.extended_energy, other.extended_energy);
  }
};

}  // namespace

void go_between(const Measured &other, double share, Measured *measured) {
  const Between between{share};
  between(measured->flow, other.flow);
  between(measured->surface.energy, other.surface.energy);
  between(measured->surface.power, other.surface.power);
  between(measured->loads, other.loads);
  between(measured->surface_loads, other.surface_loads);
  between(measured->bodies, other.bodies);
  between(measured->surfaces, other.surfaces);
}

void go_between(const EnergyState &other, double share, EnergyState *energy) {
  const Between between{share};
  between(energy->elastic, other.elastic);
  between(energy->surface, other.surface);
  between(energy->surface_power, other.surface_power);
  between(energy->dissipation, other.dissipation);
  between(energy->rates, other.rates);
}

}  // namespace eulastic
