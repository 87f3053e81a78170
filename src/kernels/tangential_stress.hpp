// The additional viscous stress of strain along a surface in cells that it cuts, relative to harmonic means of the
// viscosity; docs/method.md, (29a).
#pragma once

#include "kernels/tensor.hpp"

namespace eulastic::kernels {

/// Data around centres: velocity on faces, strides and inverse spacings of the directions, excess of the viscosity and
/// unit normal of the surface. 2-D does not use z. Differences along a direction are compact; those across it span two
/// cells, the mean of the four edges.
template <int Dim>
struct TangentialStress {
  const double *u, *v, *w, *excess, *nx, *ny, *nz;
  std::ptrdiff_t x, y, z;
  double ix, iy, iz;

  /// A symmetric tensor; 2-D does not use components of z.
  struct Rate {
    double xx, yy, zz, yz, xz, xy;
  };

  /// Returns twice the deviatoric strain rate at the centre at offset i, without shear between normal and tangents.
  EULASTIC_BODY Rate rate(std::ptrdiff_t i) const noexcept {
    Rate D{2 * ix * (u[i + x] - u[i]),
           2 * iy * (v[i + y] - v[i]),
           0,
           0,
           0,
           fma(iy, across(u + i, x, y), ix * across(v + i, y, x))};
    double third = D.xx + D.yy;
    if constexpr (Dim == 3) {
      D.zz = 2 * iz * (w[i + z] - w[i]);
      D.xz = fma(iz, across(u + i, x, z), ix * across(w + i, z, x));
      D.yz = fma(iz, across(v + i, y, z), iy * across(w + i, z, y));
      third += D.zz;
    }
    third *= Dim == 2 ? 0.5 : 1. / 3;
    D.xx -= third;
    D.yy -= third;
    D.zz -= third;
    const double a = nx[i], b = ny[i], c = Dim == 3 ? nz[i] : 0;  // the normal; p, q, r: D n
    double p = fma(D.xy, b, D.xx * a), q = fma(D.yy, b, D.xy * a), r = 0;
    if constexpr (Dim == 3) {
      p = fma(D.xz, c, p);
      q = fma(D.yz, c, q);
      r = fma(D.zz, c, fma(D.yz, b, D.xz * a));
    }
    double twice = fma(b, q, a * p);
    if constexpr (Dim == 3) twice = fma(c, r, twice);
    twice *= 2;
    const auto less = [twice](double d, double n, double Dn, double m, double Dm)
                          EULASTIC_BODY { return fma(n, fma(twice, m, -Dm), fma(-Dn, m, d)); };
    Rate out{less(D.xx, a, p, a, p), less(D.yy, b, q, b, q), 0, 0, 0, less(D.xy, a, p, b, q)};
    if constexpr (Dim == 3) {
      out.zz = less(D.zz, c, r, c, r);
      out.yz = less(D.yz, b, q, c, r);
      out.xz = less(D.xz, a, p, c, r);
    }
    return out;
  }

private:
  // Half the difference over two cells along b of the velocity component along a.
  EULASTIC_BODY static double across(const double *v, std::ptrdiff_t a, std::ptrdiff_t b) noexcept {
    return 0.25 * ((v[b] + v[a + b]) - (v[-b] + v[a - b]));
  }
};

/// Component a of the divergence of a symmetric tensor at centres, at the face at offset i; b and c are the other
/// directions. It is the adjoint of the differences of TangentialStress.
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
