// Correction of B at the surface of a moving body: the kink of the velocity that follows from traction, and the
// relaxation.
#include "solids/surface_correction.hpp"
#include "kernels/surface.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <type_traits>

using namespace eulastic;

namespace {

template <int Dim>
using Vector = std::array<double, Dim>;
template <int Dim>
using Tensor = std::array<Vector<Dim>, Dim>;

template <int Dim>
kernels::SymmetricTensor kernel_tensor(const Tensor<Dim> &t) {
  if constexpr (Dim == 2)
    return {t[0][0], t[1][1], 1, 0, 0, t[0][1]};
  else
    return {t[0][0], t[1][1], t[2][Dim - 1], t[1][2], t[0][2], t[0][1]};
}
template <int Dim>
double determinant(const Tensor<Dim> &t) {
  return kernels::determinant(kernel_tensor<Dim>(t));
}
template <int Dim>
Tensor<Dim> relax_traction(const Tensor<Dim> &B, const Vector<Dim> &n, double strength) {
  const kernels::Direction normal{n[0], n[1], Dim == 3 ? n[Dim - 1] : 0};
  const kernels::SymmetricTensor k = kernels::relax_traction(kernel_tensor<Dim>(B), normal, strength);
  const double all[3][3] = {{k.xx, k.xy, k.xz}, {k.xy, k.yy, k.yz}, {k.xz, k.yz, k.zz}};
  EXPECT_TRUE(Dim == 3 || (k.zz == 1 && k.xz == 0 && k.yz == 0));
  Tensor<Dim> t;
  for (int a = 0; a < Dim; ++a)
    for (int b = 0; b < Dim; ++b) t[a][b] = all[a][b];
  return t;
}

std::mt19937 &dice() {
  static std::mt19937 engine(35);
  return engine;
}
double draw(double low, double high) { return std::uniform_real_distribution<double>(low, high)(dice()); }

template <int Dim>
Tensor<Dim> product(const Tensor<Dim> &x, const Tensor<Dim> &y) {
  Tensor<Dim> z{};
  for (int a = 0; a < Dim; ++a)
    for (int b = 0; b < Dim; ++b)
      for (int c = 0; c < Dim; ++c) z[a][b] += x[a][c] * y[c][b];
  return z;
}

template <int Dim>
Tensor<Dim> transposed(const Tensor<Dim> &x) {
  Tensor<Dim> z;
  for (int a = 0; a < Dim; ++a)
    for (int b = 0; b < Dim; ++b) z[a][b] = x[b][a];
  return z;
}

// B = F F^T plus a small perturbation.
template <int Dim>
Tensor<Dim> random_tensor() {
  Tensor<Dim> F;
  for (auto &row : F)
    for (double &x : row) x = draw(-1.5, 1.5);
  Tensor<Dim> B = product<Dim>(F, transposed<Dim>(F));
  for (int a = 0; a < Dim; ++a) B[a][a] += 0.05;
  return B;
}

template <int Dim>
Vector<Dim> random_normal() {
  Vector<Dim> n;
  double square = 0;
  for (double &x : n) {
    x = draw(-1, 1);
    square += x * x;
  }
  for (double &x : n) x /= std::sqrt(square);
  return n;
}

// The tangential part of Bn, followed by n.Bn.
template <int Dim>
std::array<double, Dim + 1> traction(const Tensor<Dim> &B, const Vector<Dim> &n) {
  std::array<double, Dim + 1> t{};
  for (int a = 0; a < Dim; ++a)
    for (int b = 0; b < Dim; ++b) {
      t[a] += B[a][b] * n[b];
      t[Dim] += n[a] * B[a][b] * n[b];
    }
  for (int a = 0; a < Dim; ++a) t[a] -= t[Dim] * n[a];
  return t;
}

template <int Dim>
void check_relaxation() {
  for (int trial = 0; trial < 1000; ++trial) {
    const Tensor<Dim> B = random_tensor<Dim>();
    const Vector<Dim> n = random_normal<Dim>();
    const double strength = std::exp(draw(-8, 8));
    const Tensor<Dim> next = relax_traction<Dim>(B, n, strength);
    const double det = determinant<Dim>(B);
    double scale = 1;
    for (int a = 0; a < Dim; ++a) scale *= next[a][a];
    EXPECT_NEAR(determinant<Dim>(next), det, 1e-12 * (scale + det));
    const auto before = traction<Dim>(B, n), after = traction<Dim>(next, n);
    const double left = std::exp(-strength * before[Dim]);
    for (int a = 0; a < Dim; ++a) EXPECT_NEAR(after[a], left * before[a], 1e-12 * (1 + B[0][0] + B[1][1]));
    EXPECT_NEAR(after[Dim], before[Dim], 1e-12 * before[Dim] + 1e-13);
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) EXPECT_EQ(next[a][b], next[b][a]);
    EXPECT_GT(next[0][0], 0);  // and all leading minors
    EXPECT_GT(next[0][0] * next[1][1], next[0][1] * next[0][1]);
  }
}

// If B is sheared by the mixture's L = L_s + (1 - phi) (G/mu) t n^T and corrected, it is the B that L_s of the solid
// yields.
template <int Dim>
double error_of_step(const Tensor<Dim> &B, const Vector<Dim> &n, const Tensor<Dim> &solid, double share, double dt) {
  constexpr double rate = 1.7;  // G/mu
  const auto t = traction<Dim>(B, n);
  Tensor<Dim> mixture = solid;
  for (int a = 0; a < Dim; ++a)
    for (int b = 0; b < Dim; ++b) mixture[a][b] += (1 - share) * rate * t[a] * n[b];
  const auto sheared = [&](const Tensor<Dim> &L) {
    Tensor<Dim> F = L;
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) F[a][b] = (a == b) + dt * L[a][b];
    return product<Dim>(product<Dim>(F, B), transposed<Dim>(F));
  };
  const Tensor<Dim> found = relax_traction<Dim>(sheared(mixture), n, (1 - share) * rate * dt);
  const Tensor<Dim> exact = sheared(solid);
  double sum = 0;
  for (int a = 0; a < Dim; ++a)
    for (int b = 0; b < Dim; ++b) sum += (found[a][b] - exact[a][b]) * (found[a][b] - exact[a][b]);
  return std::sqrt(sum);
}

template <int Dim>
void check_gradient() {
  for (int trial = 0; trial < 50; ++trial) {
    const Tensor<Dim> B = random_tensor<Dim>();
    const Vector<Dim> n = random_normal<Dim>();
    Tensor<Dim> L;
    for (auto &row : L)
      for (double &x : row) x = draw(-1, 1);
    const double coarse = error_of_step<Dim>(B, n, L, 0.6, 2e-4), fine = error_of_step<Dim>(B, n, L, 0.6, 1e-4);
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.05);
  }
}

// 2-D: solid left of column 8, of which `share` is filled; du/dy = shear.
struct Wall {
  static constexpr int column = 8;
  Domain domain;
  Phase phase;
  Field velocity, work;

  Wall(double share, double shear) {
    GridSpec spec;
    spec.cells = {16, 16, 1};
    spec.boundary = {Boundary::wall, Boundary::wall, Boundary::wall};
    EXPECT_EQ(domain.create(PETSC_COMM_SELF, spec), 0);
    phase.empty(domain, false);
    phase.material.shear_modulus = 1;
    velocity = Field(domain, 2);
    work = Field(domain, 3);
    for (int j = -5; j < 21; ++j)
      for (int i = -5; i < 21; ++i) {
        phase.fraction[0](i, j, 0) = i < column ? 1 : i == column ? share : 0;
        velocity[0](i, j, 0) = shear * j * domain.spacing()[1];
      }
  }
  void apply(double dt) {
    Fluid fluid;  // nu = 1 damps waves of a cell
    EXPECT_EQ(surface.apply(domain, {dt, fluid, sides}, velocity, phase, work), 0);
  }
  SurfaceCorrection surface;
  BoundaryConditions sides{};
};

}  // namespace

TEST(SurfaceCorrection, RelaxesTheTractionAndKeepsTheDeterminant) {
  check_relaxation<2>();
  check_relaxation<3>();
}

TEST(SurfaceCorrection, RecoversTheGradientOfTheSolid) {
  check_gradient<2>();
  check_gradient<3>();
}

TEST(SurfaceCorrection, GradientAndStrainRateOfLinearFieldsAreExact) {
  constexpr std::ptrdiff_t stride[3] = {1, 8, 64}, middle = 4 + 8 * 4 + 64 * 4;
  const double spacing[3] = {0.5, 0.25, 1}, inverse[3] = {2, 4, 1}, slope[3] = {0.3, -0.4, 1.2};
  const double L[3][3] = {{0.5, 1.5, -0.25}, {0.75, -2, 3}, {1, -0.5, 1.5}};  // of the velocity, whose values
  std::vector<double> phi(512), v[3];                                         // lie on the low faces
  for (std::vector<double> &component : v) component.resize(512);
  for (int k = 0; k < 8; ++k)
    for (int j = 0; j < 8; ++j)
      for (int i = 0; i < 8; ++i) {
        const int n = i + 8 * j + 64 * k;
        const double x[3] = {spacing[0] * i, spacing[1] * j, spacing[2] * k};
        for (int d = 0; d < 3; ++d) {
          phi[n] += slope[d] * x[d];
          for (int e = 0; e < 3; ++e) v[d][n] += L[d][e] * x[e];
        }
      }
  const double *velocity[3] = {v[0].data(), v[1].data(), v[2].data()};
  const auto check = [&](auto dimension) {
    constexpr int Dim = decltype(dimension)::value;
    const double norm = Dim == 3 ? 1.3 : 0.5;
    double g[3] = {};
    for (int d = 0; d < Dim; ++d) g[d] = kernels::fraction_slope<Dim>(&phi[middle], d, stride, inverse);
    const kernels::Direction n = kernels::unit({g[0], g[1], g[2]});
    EXPECT_NEAR(n.x, slope[0] / norm, 1e-14);
    EXPECT_NEAR(n.y, slope[1] / norm, 1e-14);
    EXPECT_NEAR(n.z, Dim == 3 ? slope[2] / norm : 0, 1e-14);
    double twice = 0;  // 2 D:D
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) twice += 0.5 * (L[a][b] + L[b][a]) * (L[a][b] + L[b][a]);
    EXPECT_NEAR(kernels::strain_rate<Dim>(velocity, middle, stride, inverse), std::sqrt(twice), 1e-13);
  };
  check(std::integral_constant<int, 2>());
  check(std::integral_constant<int, 3>());
}

TEST(SurfaceCorrection, WhatLiesAtTheSurfaceFadesWithStrain) {
  Wall wall(0.75, 0.2);
  for (int j = 0; j < 16; ++j)
    for (int i = 0; i < 16; ++i) {
      wall.phase.tensor.field[0](i, j, 0) = i < Wall::column ? 2 : 3;
      wall.phase.tensor.field[1](i, j, 0) = i < Wall::column ? 0.5 : 0.4;
    }
  double left = 1;
  for (const double dt : {0.1, 0.5, 0.25}) {
    wall.apply(dt);
    left *= std::exp(-3 * 0.2 * dt);  // sqrt(2 D:D) of a shear is its rate
    for (int j = 2; j < 14; ++j) {
      EXPECT_EQ(wall.phase.tensor.field[0](Wall::column - 2, j, 0), 2);
      EXPECT_NEAR(wall.phase.tensor.field[0](Wall::column, j, 0), 2 + left, 1e-14);
      EXPECT_NEAR(wall.phase.tensor.field[1](Wall::column, j, 0), 0.5 - 0.1 * left, 1e-14);
      EXPECT_EQ(wall.phase.tensor.field[0](Wall::column + 1, j, 0), 3);  // does not evolve
    }
  }
}

TEST(SurfaceCorrection, DoesNotFadeToASmallDeterminant) {
  for (const double inside : {0.9, 0.8}) {  // det B = .81, .64
    Wall wall(0.75, 1);
    for (int j = 0; j < 16; ++j)
      for (int i = 0; i < Wall::column; ++i)
        for (int f = 0; f < 2; ++f) wall.phase.tensor.field[f](i, j, 0) = inside;
    wall.apply(3);
    const double found = wall.phase.tensor.field[0](Wall::column, 8, 0);
    if (inside > 0.85)
      EXPECT_NEAR(found, 0.9, 1e-3);
    else
      EXPECT_EQ(found, 1);
  }
}

TEST(SurfaceCorrection, ShearOfACutColumnRelaxesAtTheRateOfTheMissingFluid) {
  constexpr double share = 0.6, dt = 0.05, shear = 0.3;
  Wall wall(share, 0);  // at rest: nothing is relaxed
  for (int j = 0; j <= 16; ++j)
    for (int i = 0; i <= 16; ++i) {
      wall.phase.tensor.field[0](i, j, 0) = wall.phase.tensor.field[1](i, j, 0) = std::sqrt(1 + shear * shear);
      wall.phase.tensor.field[2](i, j, 0) = shear;
    }
  wall.apply(dt);
  const double h = 1. / 16, k = h / (1 + h / 16);  // mu = G = rho = 1; viscosity damps waves of a cell: a share of h
  const double edge = (1 + share) / 2;             // solid fraction of the edges left of the column
  const double across = std::sqrt(1 + shear * shear);  // n.Bn
  EXPECT_NEAR(wall.phase.tensor.field[2](Wall::column, 8, 0), shear * std::exp(-(1 - edge) * k * across * dt), 1e-14);
  EXPECT_EQ(wall.phase.tensor.field[2](Wall::column - 1, 8, 0), shear);
  EXPECT_EQ(wall.phase.tensor.field[0](Wall::column, 8, 0), across);  // n.Bn does not change
}
