// Mooney-Rivlin: stress and energy in every component, the bound of its stiffness, and the stress on edges with two
// viscosities.
#include "diagnostics/edge_stress.hpp"
#include "diagnostics/energy_rates.hpp"
#include "flow/limits.hpp"
#include "support/all_segments.hpp"
#include "support/materials.hpp"
#include "support/solid_box.hpp"

using namespace eulastic;
using namespace eulastic::test;

namespace {

using Matrix = std::array<Real3, 3>;

const Material rubber = test::mooney_rivlin(0.7, 0.4, 0.3);

Matrix product(const Matrix &a, const Matrix &b) {
  Matrix c{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) c[i][j] += a[i][k] * b[k][j];
  return c;
}

Matrix transposed(const Matrix &a) {
  Matrix t{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) t[i][j] = a[j][i];
  return t;
}

double trace(const Matrix &a) { return a[0][0] + a[1][1] + a[2][2]; }

double energy(const Material &m, const Matrix &B) {
  const double I = trace(B), II = 0.5 * (I * I - trace(product(B, B)));
  return m.c1 * (I - 3) + m.c2 * (II - 3) + m.c3 * (I - 3) * (I - 3);
}

// dev(2 c1 B + 2 c2 (tr(B) B - B.B) + 4 c3 (tr B - 3) B).
Matrix stress(const Material &m, const Matrix &B) {
  const Matrix BB = product(B, B);
  Matrix s{};
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      s[a][b] = (2 * m.c1 + 4 * m.c3 * (trace(B) - 3)) * B[a][b] + 2 * m.c2 * (trace(B) * B[a][b] - BB[a][b]);
  const double third = trace(s) / 3;
  for (int a = 0; a < 3; ++a) s[a][a] -= third;
  return s;
}

// A uniform B in the field of a solid.
void fill_uniform(Solid &solid, const Matrix &B) {
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      solid.B[a][b] = Polynomial{};
      solid.B[a][b].c = B[a][b];
    }
  solid.phi = Polynomial{};
  solid.phi.c = 1;
  solid.fill();
}

Matrix random_tensor(Random &random, bool flat) {
  Matrix F{Real3{1, 0, 0}, Real3{0, 1, 0}, Real3{0, 0, 1}};
  for (int a = 0; a < (flat ? 2 : 3); ++a)
    for (int b = 0; b < (flat ? 2 : 3); ++b) F[a][b] += 0.6 * random();
  return product(F, transposed(F));
}

// The stress components at their own positions in the middle of the box.
double computed_stress(const Solid &solid, int a, int b) {
  const Phase &phase = solid.phases[0];
  const int dim = solid.domain.dimension(), k = dim == 3 ? 2 : 0;
  if (a != b) return edge_stress(solid.domain, phase, a, b, 5, 3, k);
  const CellTensor B(phase.tensor.field, 5, 3, k);
  const ConstView q = phase.tensor.field[0];
  const std::ptrdiff_t stride[3] = {q.stride(0), q.stride(1), q.stride(2)};
  return with_law(phase.material, [&](const auto &law) {
    return dim == 2 ? law.normal_stress(1, kernels::tensor_at<2>(B.component, stride, a, 1 - a), 0)
                    : law.normal_stress(1, kernels::tensor_at<3>(B.component, stride, a, (a + 1) % 3), 0);
  });
}

TEST(MooneyRivlin, StressOfUniformStrain) {
  Random random(3);
  for (const bool flat : {false, true})
    for (int seed = 0; seed < 4; ++seed) {
      Solid solid(flat, 0, 1);
      const Matrix B = random_tensor(random, flat);
      solid.phases[0].material = rubber;
      fill_uniform(solid, B);
      const Matrix expected = stress(rubber, B);
      for (int a = 0; a < (flat ? 2 : 3); ++a)
        for (int b = 0; b < (flat ? 2 : 3); ++b)
          EXPECT_NEAR(computed_stress(solid, a, b), expected[a][b], 1e-13) << a << b;
    }
}

TEST(MooneyRivlin, SimpleShearIsCubic) {
  for (const double g : {-1.5, 0.3, 2.0})
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        if (a == b) continue;
        Matrix B{Real3{1, 0, 0}, Real3{0, 1, 0}, Real3{0, 0, 1}};
        B[a][a] += g * g;
        B[a][b] = B[b][a] = g;
        for (const bool flat : {false, true}) {
          if (flat && a + b != 1) continue;
          Solid solid(flat, 0, 1);
          for (const Material &m : {rubber, test::mooney_rivlin(0, 0.5, 0), test::mooney_rivlin(0, 0, 0.25)}) {
            solid.phases[0].material = m;
            fill_uniform(solid, B);
            EXPECT_NEAR(computed_stress(solid, a, b), 2 * (m.c1 + m.c2) * g + 4 * m.c3 * g * g * g, 1e-13);
          }
        }
      }
}

TEST(MooneyRivlin, EnergyOfUniaxialExtension) {
  for (const double l : {0.5, 1.0, 2.0}) {
    const Matrix B{Real3{l * l, 0, 0}, Real3{0, 1 / l, 0}, Real3{0, 0, 1 / l}};
    Solid solid(false, 0, 1);
    solid.phases[0].material = rubber;
    fill_uniform(solid, B);
    std::vector<double> row(solid.domain.cells()[0]);
    strain_energy(solid.domain, solid.phases[0], solid.domain.rows()[7], row.data());
    const double first = l * l + 2 / l - 3, second = 2 * l + 1 / (l * l) - 3;
    EXPECT_NEAR(row[4], 0.7 * first + 0.4 * second + 0.3 * first * first, 1e-14);
  }
}

// -rho div(sigma) times dt at faces of all directions, for random fields.
double predicted_force(Solid &solid, const Material &material, Field &force) {
  solid.phases[0].material = material;
  Field zero(solid.domain, solid.domain.dimension());
  EXPECT_EQ(predict(solid.domain, solid.fluid, 0, 1, zero, solid.pressure, solid.phases, force), 0);
  double largest = 0;
  for (int a = 0; a < force.count(); ++a)
    largest = std::max(largest, largest_error(solid.domain, force[a], at_face[a], [](const Point &) { return 0.0; }));
  return largest;
}

TEST(MooneyRivlin, FirstCoefficientAloneIsNeoHookean) {
  for (const bool flat : {false, true}) {
    Solid solid(flat, 0, 1);
    Random random(7);
    randomise(solid.domain, solid.phases[0].fraction, random, 1.5);
    randomise(solid.domain, solid.phases[0].tensor.field, random);
    Field a(solid.domain, solid.domain.dimension()), b(solid.domain, solid.domain.dimension());
    const double size = predicted_force(solid, Material{1.4}, a);
    predicted_force(solid, test::mooney_rivlin(0.7, 0, 0), b);
    for (int d = 0; d < a.count(); ++d)
      for (const Segment &s : solid.domain.rows())
        for (int i = 0; i < s.i_end; ++i) EXPECT_NEAR(a[d](i, s.j, s.k), b[d](i, s.j, s.k), 1e-14 * size);
  }
}

TEST(MooneyRivlin, NoForceWithoutStrain) {
  for (const bool flat : {false, true}) {
    Solid solid(flat, 2, 5);
    const auto phi = solid.phi;
    fill_uniform(solid, {Real3{1, 0, 0}, Real3{0, 1, 0}, Real3{0, 0, 1}});
    fill_everywhere(solid.domain, solid.phases[0].fraction[0], at_centre, phi);
    Field force(solid.domain, solid.domain.dimension());
    EXPECT_EQ(predicted_force(solid, rubber, force), 0);
  }
}

// The error of div sigma of a smooth B decreases with the square of the spacing.
double force_error(bool flat, int cells) {
  Domain domain;
  GridSpec spec = uneven_box(flat, {cells, cells - 2, cells + 3});
  EXPECT_EQ(domain.create(PETSC_COMM_SELF, spec), 0);
  const auto &components = tensor_components(domain.dimension());
  const auto tensor = [&](const Point &x) {
    Matrix B{};
    const double k[3] = {2 * M_PI / spec.length[0], 2 * M_PI / spec.length[1], flat ? 0 : 2 * M_PI / spec.length[2]};
    for (const auto [a, b, at] : components)
      B[a][b] = B[b][a] = (a == b) + 0.3 * std::sin(k[0] * x[0] + a) * std::cos(k[1] * x[1] + 2 * b + k[2] * x[2]);
    if (flat) B[2][2] = 1;
    return B;
  };
  const auto fraction = [&](const Point &x) { return 1 + 0.5 * std::cos(2 * M_PI * x[1] / spec.length[1]); };
  std::vector<Phase> phases(1);
  Phase &phase = phases[0];
  phase.material = rubber;
  phase.fraction = Field(domain, 1);
  phase.tensor.field = Field(domain, static_cast<int>(components.size()));
  build_all(domain, &phase.tensor.evolving);
  build_all(domain, &phase.tensor.stressed);
  fill_everywhere(domain, phase.fraction[0], at_centre, fraction);
  for (int c = 0; c < phase.tensor.field.count(); ++c)
    fill_everywhere(domain, phase.tensor.field[c], components[c].at,
                    [&](const Point &x) { return tensor(x)[components[c].a][components[c].b]; });
  Field force(domain, domain.dimension());
  EXPECT_EQ(compute_elastic_force(domain, 1, phases, force), 0);
  double largest = 0;
  for (int a = 0; a < domain.dimension(); ++a)
    largest = std::max(largest, largest_error(domain, force[a], at_face[a], [&](const Point &x) {
                         double sum = 0;
                         for (int d = 0; d < domain.dimension(); ++d) {
                           Point low = x, high = x;
                           low[d] -= 1e-4, high[d] += 1e-4;
                           sum += (fraction(high) * stress(rubber, tensor(high))[a][d] -
                                   fraction(low) * stress(rubber, tensor(low))[a][d]) /
                                  2e-4;
                         }
                         return sum;
                       }));
  return largest;
}

TEST(MooneyRivlin, ForceIsOfSecondOrder) {
  for (const bool flat : {false, true}) {
    const double coarse = force_error(flat, 16), fine = force_error(flat, 32);
    EXPECT_GT(order(coarse, fine), 1.7) << coarse << " " << fine;
  }
}

// A solid and a fluid in layers under uniform shear, with B_xy = 0.3 in the solid. An edge that both share has the
// stress of the layers: the part without elasticity is viscous. Where the surface is at 45 degrees the stress of the
// edge is along it, and both layers have the same strain.
TEST(ElasticStress, OfLayersOfTwoViscosities) {
  const double modulus = 0.7, fluid = 0.4, strain = 0.3, rate = 0.9;
  for (const double contrast : {0.1, 1.0, 5.0})
    for (const double share : {0.125, 0.5, 0.875}) {
      Solid solid(true, 0, 1);
      Phase &phase = solid.phases[0];
      phase.material = Material{modulus};
      phase.tensor.rule.viscosity_excess = contrast - 1;
      fill_uniform(solid, {Real3{1 + strain * strain, strain, 0}, Real3{strain, 1, 0}, Real3{0, 0, 1}});
      const Real3 &h = solid.domain.spacing();
      const auto surface_along = [&](double x, double y) {
        fill_everywhere(solid.domain, phase.fraction[0], at_centre,
                        [&](const Point &p) { return share + 0.1 * (x * (p[0] - 5 * h[0]) + y * (p[1] - 3 * h[1])); });
      };
      surface_along(0, 1);
      // Both layers have the same stress, and their rates of shear add up to that of the edge.
      const double body = contrast * fluid, viscosity = 1 / (share / body + (1 - share) / fluid);
      const double stress = (rate + share * modulus * strain / body) * viscosity;
      EXPECT_NEAR(computed_stress(solid, 0, 1), stress - viscosity * rate, 1e-14) << contrast << " " << share;
      surface_along(1, 1);
      EXPECT_NEAR(computed_stress(solid, 0, 1), share * modulus * strain, 1e-14) << contrast << " " << share;
    }
}

// rho c^2 of a wave along n that moves along m is the second derivative of W for F -> (1 + e m n) F.
TEST(LargestStiffness, BoundsEveryWave) {
  Random random(5);
  double closest = 0;
  for (int n = 0; n < 20000; ++n) {
    const double l1 = std::exp(1.2 * random()), l2 = std::exp(1.2 * random());
    const Real3 l{l1 * l1, l2 * l2, 1 / (l1 * l1 * l2 * l2)};
    const Matrix B{Real3{l[0], 0, 0}, Real3{0, l[1], 0}, Real3{0, 0, l[2]}};
    const double angle = 4 * random(), tilt = 4 * random(), turn = 4 * random();
    const Real3 along{std::cos(angle) * std::cos(tilt), std::sin(angle) * std::cos(tilt), std::sin(tilt)};
    const Real3 e1{-std::sin(angle), std::cos(angle), 0};
    const Real3 e2{-std::cos(angle) * std::sin(tilt), -std::sin(angle) * std::sin(tilt), std::cos(tilt)};
    const Material m = test::mooney_rivlin(std::fabs(random()), std::fabs(random()), std::fabs(random()));
    const double d = 1e-3;
    double w[3];
    for (int s = -1; s <= 1; ++s) {
      Matrix F{Real3{1, 0, 0}, Real3{0, 1, 0}, Real3{0, 0, 1}};
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) F[a][b] += s * d * (std::cos(turn) * e1[a] + std::sin(turn) * e2[a]) * along[b];
      w[s + 1] = energy(m, product(product(F, B), transposed(F)));
    }
    const double stiffness = (w[2] - 2 * w[1] + w[0]) / (d * d), bound = largest_stiffness(m, trace(B), 3);
    ASSERT_LE(stiffness, bound * (1 + 1e-3));
    closest = std::max(closest, stiffness / bound);
  }
  EXPECT_GT(closest, 0.8);  // not much too restrictive
}

TEST(LargestStiffness, KnownValues) {
  for (const int dim : {2, 3}) {
    EXPECT_NEAR(largest_stiffness(rubber, 3, dim), rubber.shear_modulus, 1e-12);
    EXPECT_EQ(largest_stiffness(Material{2}, 5, dim), 2 * stretch_squared(5, dim));
    for (const double g : {0.5, 2.0})  // the slope of the cubic of simple shear
      EXPECT_GE(largest_stiffness(rubber, 3 + g * g, dim), 2 * (0.7 + 0.4) + 12 * 0.3 * g * g);
  }
  EXPECT_NEAR(inverse_stretch_squared(2 * 4 + 1. / 16, 3), 16, 1e-12);  // B = diag(4, 4, 1/16)
  EXPECT_NEAR(inverse_stretch_squared(4 + 0.25 + 1, 2), 4, 1e-12);
}

}  // namespace
