// A membrane at one point: its surface strain B_s = F P_0 F^T, and tension and energy of its laws.
//
// The normal is an eigenvector of B_s with the eigenvalue 0; J^2 = ((tr B_s)^2 - tr B_s^2)/2 is the area stretch
// squared. In 2-D the third direction is not stretched. docs/method.md, section 18; Barthes-Biesel, Annu. Rev. Fluid
// Mech. 48 (2016).
#pragma once

#include "kernels/membrane_law.hpp"
#include "kernels/stencils.hpp"
#include "kernels/tensor.hpp"

#include <array>

namespace eulastic::kernels {

template <int Dim>
using Vector = std::array<double, Dim>;
template <int Dim>
using Tensor = std::array<Vector<Dim>, Dim>;

template <int Dim>
EULASTIC_INLINE double trace_of(const Tensor<Dim> &t) noexcept {
  double sum = t[0][0] + t[1][1];
  if constexpr (Dim == 3) sum += t[2][2];
  return sum;
}

/// Returns P = 1 - n n.
template <int Dim>
EULASTIC_INLINE Tensor<Dim> tangential(const Vector<Dim> &n) noexcept {
  Tensor<Dim> P;
  for (int a = 0; a < Dim; ++a)
    for (int b = 0; b < Dim; ++b) P[a][b] = (a == b ? 1 : 0) - n[a] * n[b];
  return P;
}

/// Returns P B P.
template <int Dim>
EULASTIC_INLINE Tensor<Dim> project(const Tensor<Dim> &B, const Vector<Dim> &n) noexcept {
  Vector<Dim> Bn{};
  double nBn = 0;
  for (int a = 0; a < Dim; ++a) {
    for (int b = 0; b < Dim; ++b) Bn[a] = fma(B[a][b], n[b], Bn[a]);
    nBn = fma(n[a], Bn[a], nBn);
  }
  Tensor<Dim> out;
  for (int a = 0; a < Dim; ++a)
    for (int b = a; b < Dim; ++b)
      out[a][b] = out[b][a] = (B[a][b] - (n[a] * Bn[b] + Bn[a] * n[b])) + nBn * (n[a] * n[b]);
  return out;
}

/// Rotates tangential tensors by the smallest rotation of their normals into n, and multiplies them by share[m], m <
/// count. B[field][m] are the components of the tensors, from[d][m] their normals.
template <int Dim, int Most>
EULASTIC_INLINE void rotate_tensors(const Vector<Dim> &n, int count, const double *share, const double (*from)[Most],
                                    double (*B)[Most]) noexcept {
  alignas(64) double Bn[Dim][Most], w[Dim][Most], nBn[Most];
#pragma omp simd
  for (int m = 0; m < count; ++m) {
    double cosine = fma(n[1], from[1][m], n[0] * from[0][m]);
    if (Dim > 2) cosine = fma(n[Dim - 1], from[Dim - 1][m], cosine);
    nBn[m] = 1 / (1 + (cosine > -0.5 ? cosine : -0.5));
  }
  for (int a = 0; a < Dim; ++a)
#pragma omp simd
    for (int m = 0; m < count; ++m) {
      w[a][m] = nBn[m] * (n[a] + from[a][m]);
      double sum = fma(B[position<Dim>(a, 1)][m], n[1], B[position<Dim>(a, 0)][m] * n[0]);
      if (Dim > 2) sum = fma(B[position<Dim>(a, Dim - 1)][m], n[Dim - 1], sum);
      Bn[a][m] = sum;
    }
#pragma omp simd
  for (int m = 0; m < count; ++m) {
    double sum = fma(n[1], Bn[1][m], n[0] * Bn[0][m]);
    if (Dim > 2) sum = fma(n[Dim - 1], Bn[Dim - 1][m], sum);
    nBn[m] = sum;
  }
  for (int a = 0; a < Dim; ++a)
    for (int b = a; b < Dim; ++b) {
      double *out = B[position<Dim>(a, b)];
#pragma omp simd
      for (int m = 0; m < count; ++m)
        out[m] = share[m] * ((out[m] - (w[a][m] * Bn[b][m] + Bn[a][m] * w[b][m])) + nBn[m] * (w[a][m] * w[b][m]));
    }
}

/// Returns F P_0 F^T of a surface with the normal n in a body with B = F F^T, where P_0 is the projection of the
/// surface before F: B - Bn (Bn)^T/(n.Bn). The result is exactly P where B = 1.
template <int Dim>
EULASTIC_INLINE Tensor<Dim> surface_tensor(const Tensor<Dim> &B, const Vector<Dim> &n) noexcept {
  Vector<Dim> Bn{};
  double nBn = 0;
  bool undeformed = true;
  for (int a = 0; a < Dim; ++a) {
    for (int b = 0; b < Dim; ++b) {
      Bn[a] = fma(B[a][b], n[b], Bn[a]);
      undeformed = undeformed && B[a][b] == (a == b ? 1 : 0);
    }
    nBn = fma(n[a], Bn[a], nBn);
  }
  if (undeformed) return tangential<Dim>(n);
  Tensor<Dim> out;
  for (int a = 0; a < Dim; ++a)
    for (int b = 0; b < Dim; ++b) out[a][b] = B[a][b] - Bn[a] * Bn[b] / nBn;
  return out;
}

/// tr B_s and J^2, including the third direction in 2-D.
struct SurfaceStrain {
  double trace, area_squared;
};
template <int Dim>
EULASTIC_INLINE SurfaceStrain surface_strain(const Tensor<Dim> &B) noexcept {
  constexpr double third = Dim == 2 ? 1 : 0, least = 1e-4;
  double square = third;
  for (int a = 0; a < Dim; ++a)
    for (int b = 0; b < Dim; ++b) square = fma(B[a][b], B[a][b], square);
  const double sum = trace_of<Dim>(B) + third, twice = fma(sum, sum, -square);
  return {sum, 0.5 * twice > least ? 0.5 * twice : least};
}

/// Bounds the area of a strain in the plane normal to n: if its area squared is below `least`, the principal values are
/// moved towards their mean, which is raised if necessary, until the area squared is `least`. Returns whether the
/// strain was changed.
template <int Dim>
EULASTIC_INLINE bool bound_area(const Vector<Dim> &n, double least, Tensor<Dim> *B) noexcept {
  constexpr int values = Dim - 1;
  double square = 0;
  for (int a = 0; a < Dim; ++a)
    for (int b = 0; b < Dim; ++b) square = fma((*B)[a][b], (*B)[a][b], square);
  const double trace = trace_of<Dim>(*B), mean = trace / values;
  const double area_squared = Dim == 2 ? trace : 0.5 * fma(trace, trace, -square);
  if (!(area_squared < least)) return false;  // false for NaN as well, which the guards detect
  const double root = Dim == 2 ? least : __builtin_sqrt(least), raised = mean > root ? mean : root;
  const double spread = mean * mean - area_squared, left = raised * raised - least;
  const double share = Dim == 3 && spread > left ? __builtin_sqrt(left / spread) : 0;
  for (int a = 0; a < Dim; ++a)
    for (int b = 0; b < Dim; ++b) {
      const double plane = (a == b) - n[a] * n[b];
      (*B)[a][b] = fma(share, (*B)[a][b] - mean * plane, raised * plane);
    }
  return true;
}

/// Returns B rotated by the smallest rotation from its own plane into that normal to n, by at most 45 degrees. The
/// normal part of a mean over different planes is distributed over all tangential directions. Such a mean keeps the
/// trace, but its J would be too large.
template <int Dim>
EULASTIC_INLINE Tensor<Dim> project_surface(const Tensor<Dim> &B, const Vector<Dim> &n) noexcept {
  constexpr double least = 1e-4;
  const Tensor<Dim> A = project<Dim>(B, n);
  double trace = 0, squares = 0, across = 0;
  // first B n along the plane, then times the inverse of A: the tangent of the angle between the planes
  Vector<Dim> tilt{};
  for (int a = 0; a < Dim; ++a) {
    trace += A[a][a];
    for (int b = 0; b < Dim; ++b) {
      squares = fma(A[a][b], A[a][b], squares);
      tilt[a] = fma(B[a][b], n[b], tilt[a]);
    }
    across = fma(tilt[a], n[a], across);
  }
  for (int a = 0; a < Dim; ++a) tilt[a] -= across * n[a];
  Vector<Dim> x{};
  double along = 0, square = 0;
  for (int a = 0; a < Dim; ++a) {
    if (Dim == 2) {
      x[a] = tilt[a] / (trace > least ? trace : least);
    } else {
      double turned = trace * tilt[a];
      for (int b = 0; b < Dim; ++b) turned -= A[a][b] * tilt[b];
      const double area_squared = 0.5 * (trace * trace - squares);
      x[a] = turned / (area_squared > least ? area_squared : least);
    }
    square = fma(x[a], x[a], square);
  }
  const double turn = 1 / __builtin_sqrt(square > 1 ? square : 1);
  square = square > 1 ? 1 : square;
  for (int a = 0; a < Dim; ++a) {
    x[a] *= turn;
    along = fma(x[a], tilt[a], along);
  }
  const double g = 1 / (__builtin_sqrt(1 + square) + 1);
  Tensor<Dim> M, MA{}, out{};
  for (int a = 0; a < Dim; ++a)
    for (int b = 0; b < Dim; ++b) M[a][b] = (a == b) + g * x[a] * x[b];
  for (int a = 0; a < Dim; ++a)
    for (int b = 0; b < Dim; ++b)
      for (int c = 0; c < Dim; ++c) MA[a][b] = fma(M[a][c], A[c][b], MA[a][b]);
  double whole = 0;
  for (int a = 0; a < Dim; ++a) {
    for (int b = 0; b < Dim; ++b)
      for (int c = 0; c < Dim; ++c) out[a][b] = fma(MA[a][c], M[c][b], out[a][b]);
    whole += out[a][a];
  }
  const double correction = (across - along) / (whole > least ? whole : least);  // close to 0, of either sign
  const double scale = 1 + (correction > -0.5 ? correction : -0.5);
  for (auto &row : out)
    for (double &value : row) value *= scale;
  return out;
}

/// Force per length of the deformed membrane, alpha B_s + beta P, and energy per area of the undeformed one. area: J.
struct MembraneState {
  double alpha, beta, energy, area;
};
EULASTIC_INLINE MembraneState membrane_state(const Membrane &m, const SurfaceStrain &s) noexcept {
  const double J = __builtin_sqrt(s.area_squared), G = m.shear_modulus;
  if (m.law == MembraneLaw::neo_hookean)
    return {G / J, -G / (J * s.area_squared), 0.5 * G * (s.trace + 1 / s.area_squared - 3), J};
  const double I1 = s.trace - 2, I2 = s.area_squared - 1, C = m.area_modulus;
  return {G * (I1 + 1) / J, G * J * (C * I2 - 1), 0.25 * G * (I1 * I1 + 2 * I1 - 2 * I2 + C * I2 * I2), J};
}

/// Returns the smaller of the two principal tensions; 2-D: the tension in the plane.
template <int Dim>
EULASTIC_INLINE double smaller_tension(const Membrane &m, const SurfaceStrain &s) noexcept {
  const MembraneState state = membrane_state(m, s);
  const double square = s.trace * s.trace - 4 * s.area_squared,
               difference = __builtin_fabs(state.alpha) * __builtin_sqrt(square > 0 ? square : 0);
  return Dim == 2 ? fma(state.alpha, s.trace - 1, state.beta) : 0.5 * (state.alpha * s.trace - difference) + state.beta;
}

/// Returns the larger of the two principal stretches along the surface.
EULASTIC_INLINE double larger_stretch(const SurfaceStrain &s) noexcept {
  const double square = s.trace * s.trace - 4 * s.area_squared;
  return __builtin_sqrt(0.5 * (s.trace + __builtin_sqrt(square > 0 ? square : 0)));
}

/// Returns the energy of the same area stretch with equal stretches in all directions of the surface.
EULASTIC_INLINE double area_energy(const Membrane &m, const SurfaceStrain &s) noexcept {
  const double J = __builtin_sqrt(s.area_squared);
  return membrane_state(m, {2 * J, s.area_squared}).energy;
}

}  // namespace eulastic::kernels
