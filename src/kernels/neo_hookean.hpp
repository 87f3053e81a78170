// The neo-Hookean law: sigma = G phi dev B, (3). What a law is: the members of this struct.
#pragma once

#include "kernels/tensor.hpp"

namespace eulastic::kernels {

struct NeoHookean {
  /// Whether products with off-diagonal components enter: the normal stress of a centre then reads its edges.
  static constexpr bool couples_edges = false;
  double modulus;  ///< G

  NeoHookean scaled(double factor) const noexcept { return {factor * modulus}; }
  double shear_modulus() const noexcept { return modulus; }  ///< at rest
  /// Tangential traction on a plane with normal n over the tangential part of Bn is shear_modulus() and so much times
  /// tr B - 3.
  double stiffening() const noexcept { return 0; }
  /// Of the force, per face.
  static constexpr double flops(int dimension) noexcept { return dimension == 2 ? 32 : 57; }
  /// The largest rho c^2 of an elastic wave (docs/method.md).
  double stiffness(const StretchBounds &b) const noexcept { return modulus * b.stretch; }

  /// sigma_aa - tr sigma / 3 at the centre at offset i.
  template <int Dim>
  EULASTIC_INLINE double normal_stress(double phi, const TensorAt<Dim> &t, std::ptrdiff_t i) const noexcept {
    const double zz = Dim == 3 ? t.cc[i] : 1.0;
    return modulus * phi * (1. / 3) * ((t.aa[i] - t.bb[i]) + (t.aa[i] - zz));
  }
  /// sigma_ab on the edge at offset i.
  template <int Dim>
  EULASTIC_INLINE double shear_stress(const double *phi, const TensorAt<Dim> &t, std::ptrdiff_t i) const noexcept {
    return modulus * average4(phi + i, -t.a, -t.b) * t.ab[i];
  }
  /// What multiplies B_ab in the stress, at a centre and per phi.
  template <int Dim>
  EULASTIC_INLINE double shear_factor(const TensorAt<Dim> &, std::ptrdiff_t) const noexcept {
    return modulus;
  }
  /// W at a centre, per phi.
  template <int Dim>
  EULASTIC_INLINE double energy(const TensorAt<Dim> &t, std::ptrdiff_t i) const noexcept {
    return 0.5 * modulus * excess_trace(t, i);
  }
};

}  // namespace eulastic::kernels
