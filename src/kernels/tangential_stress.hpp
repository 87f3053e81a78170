// The part of the viscous stress that strain along a surface makes in cells that it cuts, beside harmonic means:
// docs/method.md, (29a).
#pragma once

#include "kernels/tensor.hpp"

namespace eulastic::kernels {

/// Around centres: velocity on faces, strides and inverse spacings of the directions, excess of the viscosity and unit
/// normal of the surface. Differences along a are compact, across it over two cells: means of the four edges.
template <int Dim>
struct TangentialStress {
  const double *velocity[3], *excess, *normal[3];
  std::ptrdiff_t stride[3];
  double inverse[3];

  /// Twice the rate of strain of the centre at offset i, its deviator, without shear between normal and tangents;
  /// components in the order of their block.
  EULASTIC_BODY void rate(std::ptrdiff_t i, double *out) const noexcept {
    double D[3][3], n[3], along[3];
    for (int a = 0; a < Dim; ++a) {
      const double *v = velocity[a] + i;
      n[a] = normal[a][i];
      D[a][a] = 2 * inverse[a] * (v[stride[a]] - v[0]);
    }
    for (int a = 0; a < Dim; ++a)
      for (int b = a + 1; b < Dim; ++b)
        D[a][b] = D[b][a] = fma(inverse[b], across(i, a, b), inverse[a] * across(i, b, a));
    const double third = Dim == 2 ? 0.5 * (D[0][0] + D[1][1]) : (1. / 3) * ((D[0][0] + D[1][1]) + D[Dim - 1][Dim - 1]);
    for (int a = 0; a < Dim; ++a) D[a][a] -= third;
    for (int a = 0; a < Dim; ++a) {
      along[a] = fma(D[a][1], n[1], D[a][0] * n[0]);
      if (Dim == 3) along[a] = fma(D[a][Dim - 1], n[Dim - 1], along[a]);
    }
    double twice = fma(n[1], along[1], n[0] * along[0]);
    if (Dim == 3) twice = fma(n[Dim - 1], along[Dim - 1], twice);
    twice *= 2;
    for (int a = 0; a < Dim; ++a)
      for (int b = a; b < Dim; ++b)
        out[position<Dim>(a, b)] = fma(n[a], fma(twice, n[b], -along[b]), fma(-along[a], n[b], D[a][b]));
  }

private:
  // Half the difference of component a over two cells along b.
  EULASTIC_BODY double across(std::ptrdiff_t i, int a, int b) const noexcept {
    const double *v = velocity[a] + i;
    const std::ptrdiff_t A = stride[a], B = stride[b];
    return 0.25 * ((v[B] + v[A + B]) - (v[-B] + v[A - B]));
  }
};

/// Component a of the divergence of a symmetric tensor at centres, at the face at offset i; b, c: the other directions.
/// The adjoint of the differences above.
template <int Dim>
struct DivergenceFromCentres {
  const double *aa, *ab, *ac;
  std::ptrdiff_t a, b, c;
  double ia, ib, ic;

  EULASTIC_BODY double at(std::ptrdiff_t i) const noexcept {
    const auto across = [this, i](const double *t, std::ptrdiff_t s)
                            EULASTIC_BODY { return 0.25 * ((t[i + s] + t[i + s - a]) - (t[i - s] + t[i - s - a])); };
    double sum = fma(ib, across(ab, b), ia * (aa[i] - aa[i - a]));
    if constexpr (Dim == 3) sum = fma(ic, across(ac, c), sum);
    return sum;
  }
};

inline constexpr double tangential_stress_flops_2d = 36, tangential_stress_flops_3d = 105;
inline constexpr double centred_divergence_flops_2d = 9, centred_divergence_flops_3d = 15;

}  // namespace eulastic::kernels
