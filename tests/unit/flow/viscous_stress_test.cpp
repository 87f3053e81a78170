// The stress with variable viscosity: its force on polynomials, its spectrum, and the viscosity of mixed cells.
#include "flow/viscous_stress.hpp"
#include "flow/limits.hpp"
#include "support/polynomials.hpp"
#include "support/solid_box.hpp"

using namespace eulastic;
using namespace eulastic::test;

namespace {

struct Flow {
  Domain domain;
  Field velocity, force;
  LocalViscosity viscosity;

  explicit Flow(bool flat, const Int3 &cells = {11, 6, 5}) {
    EXPECT_EQ(domain.create(PETSC_COMM_SELF, uneven_box(flat, cells)), 0);
    velocity = Field(domain, domain.dimension());
    force = Field(domain, domain.dimension());
    viscosity = LocalViscosity(domain);
  }
  template <class Value>
  void set_viscosity(const Value &value) {
    const int dim = domain.dimension();
    fill_everywhere(domain, viscosity.fields[0], at_centre, value);
    for (int a = 0; a < dim; ++a)
      for (int b = a + 1; b < dim; ++b)
        fill_everywhere(domain, viscosity.fields[viscosity_of_edge(dim, a, b)], at_edge(a, b), value);
  }
  void find_force() {
    force.clear();
    EXPECT_EQ(add_viscous_force(domain, viscosity, 1, velocity, force), 0);
  }
};

TEST(ViscousStress, IsExactForLinearViscosityAndQuadraticVelocity) {
  for (const bool flat : {false, true}) {
    Flow flow(flat);
    const int dim = flow.domain.dimension();
    Random random(7);
    Polynomial v[3], nu(random, 1);
    for (int a = 0; a < dim; ++a) {
      v[a] = Polynomial(random, 2);
      fill_everywhere(flow.domain, flow.velocity[a], at_face[a], v[a]);
    }
    flow.set_viscosity(nu);
    flow.find_force();
    for (int a = 0; a < dim; ++a) {
      const auto exact = [&](const Point &x) {
        double sum = 0;
        for (int b = 0; b < dim; ++b) {
          double rate = v[a].slope(b, x) + v[b].slope(a, x), change = v[a].h[b][b] + v[b].h[a][b];
          for (int c = 0; c < dim && b == a; ++c) {
            rate -= (flat ? 1 : 2. / 3) * v[c].slope(c, x);
            change -= (flat ? 1 : 2. / 3) * v[c].h[c][a];
          }
          sum += nu.g[b] * rate + nu(x) * change;
        }
        return sum;
      };
      EXPECT_LT(largest_error(flow.domain, flow.force[a], at_face[a], exact), 1e-12) << "xyz"[a];
    }
  }
}

TEST(ViscousStress, IsTheLaplacianOfSolenoidalFlowInUniformViscosity) {
  for (const bool flat : {false, true}) {
    Flow flow(flat);
    Random random(3);
    randomise_solenoidal(flow.domain, flow.velocity, random);
    flow.set_viscosity([](const Point &) { return 0.7; });
    flow.find_force();
    for (int a = 0; a < flow.domain.dimension(); ++a)
      for (const Segment &row : flow.domain.rows())
        for (int i = 0; i < row.i_end; ++i) {
          const double *q = &flow.velocity[a](i, row.j, row.k);
          double laplacian = 0;
          for (int d = 0; d < flow.domain.dimension(); ++d) {
            const std::ptrdiff_t s = flow.velocity[a].stride(d);
            laplacian += (q[s] - 2 * *q + q[-s]) / (flow.domain.spacing()[d] * flow.domain.spacing()[d]);
          }
          EXPECT_NEAR(flow.force[a](i, row.j, row.k), 0.7 * laplacian, 1e-12);
        }
  }
}

// Returns the largest eigenvalue of the force, by the power method.
double stiffest(Flow &flow) {
  Random random(5);
  randomise(flow.domain, flow.velocity, random);
  GhostExchange exchange(flow.domain);
  double eigenvalue = 0;
  for (int n = 0; n < 400; ++n) {
    flow.find_force();
    double square = 0, product = 0;
    const auto each = [&](const auto &use) {
      for (int a = 0; a < flow.domain.dimension(); ++a)
        for (const Segment &row : flow.domain.rows())
          for (int i = 0; i < row.i_end; ++i) use(flow.velocity[a](i, row.j, row.k), flow.force[a](i, row.j, row.k));
    };
    each([&](double &v, const double &f) { square += v * v, product -= v * f; });
    eigenvalue = product / square;
    EXPECT_GE(eigenvalue, 0);
    each([&](double &v, const double &f) { v = -f / (eigenvalue * std::sqrt(square)); });
    EXPECT_EQ(exchange.update_ghosts(flow.velocity, 2), 0);
  }
  return eigenvalue;
}

TEST(ViscousStress, SpectrumEndsWhereTheTimeStepLimitSays) {
  for (const bool flat : {false, true}) {
    Flow flow(flat, {8, 6, 4});
    const Real3 &h = flow.domain.spacing();
    double S = 0;
    for (int d = 0; d < flow.domain.dimension(); ++d) S += 1 / (h[d] * h[d]);
    const double most = 0.9, limit = (flat ? 4 : 16. / 3) * most * S;
    flow.set_viscosity([&](const Point &) { return most; });
    EXPECT_NEAR(stiffest(flow), limit, 1e-3 * limit);
    Random random(8);
    GhostExchange exchange(flow.domain);
    std::vector<Phase> phases(1);
    phases[0].fraction = Field(flow.domain, 1);
    phases[0].material.viscosity = most;
    for_points(flow.domain, phases[0].fraction[0], at_centre,
               [&](double &phi, double, double, double) { phi = std::clamp(0.5 + random(), 0.0, 1.0); });
    EXPECT_EQ(exchange.update_ghosts(phases[0].fraction, 2), 0);
    EXPECT_EQ(phases[0].rows.find(flow.domain, phases[0].fraction[0]), 0);
    Fluid thin;
    thin.viscosity = 0.01 * most;
    EXPECT_EQ(compute_viscosity(flow.domain, thin, {}, phases, &flow.viscosity), 0);
    EXPECT_FALSE(flow.viscosity.cut.all().empty());
    EXPECT_LT(stiffest(flow), limit);
    EXPECT_GT(stiffest(flow), 0.3 * limit);

    Fluid fluid;
    fluid.density = 1.7;
    fluid.viscosity = 0.1 * most * fluid.density;
    ViscosityContrast contrast(fluid);
    Material stiff{2.0}, soft{0.5};
    stiff.viscosity = most * fluid.density;
    contrast.add(stiff, 2);
    contrast.add(soft, 0.5);
    FlowExtremes extremes;
    extremes.stiffness = 2;
    const TimeStepLimits limits = time_step_limits(flow.domain, fluid, contrast, {}, extremes, {true, true});
    EXPECT_NEAR(limits.viscous, 2 / limit, 1e-12);
    EXPECT_NEAR(limits.kelvin_voigt, 2 * std::min(4 * fluid.viscosity * 0.9 / 2, fluid.viscosity / 0.5), 1e-12);
  }
}

TEST(Viscosity, IsTheHarmonicMeanAtCentresAndOnEdges) {
  for (const bool flat : {false, true}) {
    Flow flow(flat);
    const int dim = flow.domain.dimension();
    Fluid fluid;
    fluid.density = 2;
    fluid.viscosity = 0.8;
    std::vector<Phase> phases(2);
    phases[0].material.viscosity = 4;
    const double part[2][2] = {{0.25, 0.5}, {0.75, 0.75}};  // fractions in cells with even and odd i
    for (int p = 0; p < 2; ++p) {
      phases[p].fraction = Field(flow.domain, 1);
      EXPECT_EQ(phases[p].rows.find(flow.domain, phases[p].fraction[0]), 0);
    }
    const Int3 &n = flow.domain.cells();
    const auto odd = [](int i) { return i & 1; };
    for (int p = 0; p < 2; ++p)
      for (int k = flat ? 0 : -1; k < n[2] + !flat; ++k)
        for (int j = -1; j < n[1] + 1; ++j)
          for (int i = -1; i < n[0] + 1; ++i) phases[p].fraction[0](i, j, k) = part[odd(i)][p];
    for (Phase &phase : phases) EXPECT_EQ(phase.rows.find(flow.domain, phase.fraction[0]), 0);
    EXPECT_EQ(compute_viscosity(flow.domain, fluid, {}, phases, &flow.viscosity), 0);
    // 1/nu: 2/.8 in the fluid and the second phase, 2/4 in the first; fractions with a sum above 1 are normalised.
    const double even = 0.75 * 2.5 + 0.25 * 0.5, full = 0.5 * 2.5 + 0.5 * 0.5;
    for (int k = 0; k < n[2]; ++k)
      for (int j = -1; j < n[1] + 1; ++j)
        for (int i = -1; i < n[0] + 1; ++i)
          EXPECT_NEAR(flow.viscosity.fields[0](i, j, k), 1 / (odd(i) ? full : even), 1e-14);
    for (int i = 0; i < n[0] + 1; ++i) {
      EXPECT_NEAR(flow.viscosity.fields[viscosity_of_edge(dim, 0, 1)](i, n[1], 0), 2 / (full + even), 1e-14);
      if (flat) continue;
      EXPECT_NEAR(flow.viscosity.fields[viscosity_of_edge(dim, 1, 2)](i, 0, n[2]), 1 / (odd(i) ? full : even), 1e-14);
    }
  }
}

// A surface in the middle of a layer of cells: strain along it is resisted by the excess of the arithmetic over the
// harmonic means, shear across it is not.
TEST(Viscosity, CutCellsResistStrainAlongTheSurfaceAlone) {
  for (const bool flat : {false, true}) {
    Flow flow(flat);
    const int dim = flow.domain.dimension();
    const double thin = 0.5, thick = 4, h = flow.domain.spacing()[1];
    Fluid fluid;
    fluid.density = 2;
    fluid.viscosity = thin * fluid.density;
    std::vector<Phase> phases(1);
    phases[0].material.viscosity = thick * fluid.density;
    phases[0].fraction = Field(flow.domain, 1);
    fill_everywhere(flow.domain, phases[0].fraction[0], at_centre,
                    [h](const Point &x) { return std::clamp(x[1] / h - 2, 0.0, 1.0); });  // 1/2 where j = 2
    EXPECT_EQ(phases[0].rows.find(flow.domain, phases[0].fraction[0]), 0);
    EXPECT_EQ(compute_viscosity(flow.domain, fluid, {}, phases, &flow.viscosity), 0);
    const auto more = [&](double phi) { return thin + phi * (thick - thin) - 1 / ((1 - phi) / thin + phi / thick); };
    const double beside = (more(0.25) + more(0.75)) / 2, here = more(0.5);  // edges across and along the surface
    const double excess = flat ? (here + beside) / 2 : (3 * here + 2 * here + 4 * beside) / 9;
    const int along = viscosity_along_surface(dim), at = flow.domain.cells()[0] / 2;
    EXPECT_NEAR(flow.viscosity.fields[along](at, 2, 0), excess, 1e-14);
    EXPECT_NEAR(flow.viscosity.fields[along + 2](at, 2, 0), 1, 1e-14);
    for (const int j : {1, 3}) EXPECT_EQ(flow.viscosity.fields[along](at, j, 0), 0);

    fill_everywhere(flow.domain, flow.velocity[0], at_face[0], [](const Point &x) { return x[0] + 7 * x[1]; });
    fill_everywhere(flow.domain, flow.velocity[1], at_face[1], [&](const Point &x) { return flat ? -x[1] : 0; });
    if (!flat)
      fill_everywhere(flow.domain, flow.velocity[2], at_face[2], [](const Point &x) { return 5 * x[1] - x[2]; });
    flow.find_force();
    for (const TensorComponent &component : tensor_components(dim)) {
      const bool diagonal = component.a == component.b;
      const double rate = !diagonal ? 0 : component.a == 0 ? 2 : component.a == dim - 1 ? -2 : 0;
      const int c = dim == 2 && !diagonal ? 2 : diagonal ? component.a : 6 - component.a - component.b;
      EXPECT_NEAR(flow.viscosity.stress[c](at, 2, 0), rate * excess, 1e-13) << flat << c;
      EXPECT_EQ(flow.viscosity.stress[c](at, 3, 0), 0);
    }
  }
}

}  // namespace
