// The two methods and their options.
#pragma once

namespace eulastic {

enum class MethodKind { fast, classic };
enum class ViscousScheme { automatic, rkl, explicit_euler };
enum class InterfaceScheme { plic, weno5 };
enum class SolidExterior { extrapolate, identity };
enum class ElasticForce { linear, constant };
enum class PressureKind { acm, smac, ksp };

/// The default values are the method of the paper, in which only the pressure solver may be replaced.
struct Method {
  MethodKind kind = MethodKind::classic;
  ViscousScheme viscous = ViscousScheme::explicit_euler;
  double viscous_tolerance = 0.01;  ///< of the residual of the implicit viscous step, relative to its right-hand side
  InterfaceScheme interface = InterfaceScheme::weno5;
  SolidExterior exterior = SolidExterior::identity;
  ElasticForce elastic_force = ElasticForce::constant;  ///< variation within a step
  PressureKind pressure = PressureKind::acm;
  int acm_sweeps_max = 1;
  double acm_tolerance = 1e-7;  ///< bound of rms(div v) h/U
  int acm_memory = 0;           ///< number of earlier increments kept as search directions
  bool acm_coarse = false;      ///< search along a V-cycle of D, else along D

  /// Whether bodies and pressure are half a step apart from the velocity.
  bool staggered() const { return kind == MethodKind::fast; }
  /// Whether the viscosity limits the time step.
  bool explicit_viscosity() const { return viscous == ViscousScheme::explicit_euler; }
  /// Whether the viscous step is implicit in a scene, else it has RKL2's stages or a single one.
  bool implicit_viscosity(bool viscosities_differ, bool rigid_bodies) const {
    return viscous == ViscousScheme::automatic && viscosities_differ && !rigid_bodies;
  }
  bool linear_force() const { return staggered() && elastic_force == ElasticForce::linear; }
  /// Whether free bodies may be stored in boxes of their own (boxes/free_bodies.hpp).
  bool allows_boxed_bodies() const { return staggered() && interface == InterfaceScheme::plic; }
  /// Whether the pressure takes a single step of (11) to (13), as in the paper.
  bool is_single_acm_step() const { return acm_sweeps_max == 1 && acm_memory == 0 && !acm_coarse; }
};

/// Default settings of `-method classic` or `fast`.
inline Method method_preset(MethodKind kind) {
  Method method;
  if (kind == MethodKind::classic) return method;
  method.kind = MethodKind::fast;
  method.viscous = ViscousScheme::automatic;
  method.interface = InterfaceScheme::plic;
  method.exterior = SolidExterior::extrapolate;
  method.elastic_force = ElasticForce::linear;
  method.acm_sweeps_max = 50;
  method.acm_memory = 2;
  method.acm_coarse = true;
  return method;
}

}  // namespace eulastic
