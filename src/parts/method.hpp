// The two methods, and what may be changed in them.
#pragma once

namespace eulastic {

enum class MethodKind { fast, classic };
enum class ViscousScheme { rkl, explicit_euler };
enum class InterfaceScheme { plic, weno5 };
enum class SolidExterior { extrapolate, identity };
enum class ElasticForce { linear, constant };
enum class PressureKind { acm, smac, ksp };

/// The initialisers are the paper's method, of which only the pressure may be found in another way.
struct Method {
  MethodKind kind = MethodKind::classic;
  ViscousScheme viscous = ViscousScheme::explicit_euler;
  double viscous_tolerance = 0.03;  ///< of the residual of the implicit viscous step, relative to its right-hand side
  InterfaceScheme interface = InterfaceScheme::weno5;
  SolidExterior exterior = SolidExterior::identity;
  ElasticForce elastic_force = ElasticForce::constant;  ///< within a step
  PressureKind pressure = PressureKind::acm;
  int acm_sweeps_max = 1;
  double acm_tolerance = 1e-7;  ///< on rms(div v) h/U
  int acm_memory = 0;           ///< increments of earlier steps kept as directions
  bool acm_coarse = false;      ///< sweep along a V-cycle of D, else along D

  /// Whether bodies and pressure live half a step beside the velocity.
  bool staggered() const { return kind == MethodKind::fast; }
  bool linear_force() const { return staggered() && elastic_force == ElasticForce::linear; }
  /// Whether free bodies may lie in boxes of their own (boxes/free_bodies.hpp).
  bool boxes_bodies() const { return staggered() && interface == InterfaceScheme::plic; }
  /// One step of (11)-(13) and nothing else.
  bool acm_of_the_paper() const { return acm_sweeps_max == 1 && acm_memory == 0 && !acm_coarse; }
};

/// `-method classic` or `fast`.
inline Method method_preset(MethodKind kind) {
  Method method;
  if (kind == MethodKind::classic) return method;
  method.kind = MethodKind::fast;
  method.viscous = ViscousScheme::rkl;
  method.interface = InterfaceScheme::plic;
  method.exterior = SolidExterior::extrapolate;
  method.elastic_force = ElasticForce::linear;
  method.acm_sweeps_max = 50;
  method.acm_memory = 2;
  method.acm_coarse = true;
  return method;
}

}  // namespace eulastic
