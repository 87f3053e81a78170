// Markers of membranes: the strain they determine, their motion, and the ranks that own them.
#include "membranes/surface_markers.hpp"
#include "kernels/surface_fit.hpp"
#include "membranes/membrane_tensor.hpp"
#include "support/interface_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>

using namespace eulastic;
using namespace eulastic::test;

namespace {

// A ball in a periodic box, across its boundaries, with an undeformed membrane.
struct MarkedBall : InterfaceScene {
  static constexpr int cells = 24;
  static constexpr double radius = 0.3;
  const Real3 centre{0.05, 0.49, 0.505};
  Phase phase;
  std::unique_ptr<GhostExchange> exchange;
  BoundaryConditions sides;
  std::unique_ptr<SurfaceCells> surface;
  std::unique_ptr<SurfaceMarkers> markers;
  Field smooth;
  std::vector<SurfaceMarker> all;
  int dim;

  explicit MarkedBall(int dimension) : dim(dimension) {
    GridSpec spec;
    spec.cells = {cells, cells, dim == 2 ? 1 : cells};
    spec.length = {1, 1, dim == 2 ? 1. / cells : 1};
    spec.ghosts = 5;
    EXPECT_EQ(create(PETSC_COMM_SELF, spec), 0);
    set_fraction(ball(centre, radius, dim, true));
    exchange = std::make_unique<GhostExchange>(domain);
    phase.fraction = std::move(fraction);
    phase.tensor.field = Field(domain, dim == 2 ? 3 : 6);
    phase.material.law = Law::membrane;
    EXPECT_EQ(exchange->update_ghosts(phase.fraction, 5), 0);
    EXPECT_EQ(phase.rows.find(domain, phase.fraction[0]), 0);
    smooth = Field(domain, SurfaceCells::work_fields);
    surface = std::make_unique<SurfaceCells>(PhaseDomain{&domain, &sides, exchange.get()});
    EXPECT_EQ(surface->find(phase, smooth), 0);
    markers = std::make_unique<SurfaceMarkers>(domain);
  }
  std::size_t owned_nearest_count() const {
    return std::count_if(surface->all().begin(), surface->all().begin() + surface->nearest_count(),
                         [](const SurfaceCells::Cell &cell) { return cell.owned; });
  }
  template <int Dim>
  void set_strain(double stretch) {
    for (std::size_t c = 0; c < surface->nearest_count(); ++c) {
      const SurfaceCells::Cell &cell = surface->all()[c];
      kernels::Tensor<Dim> P = kernels::tangential<Dim>(normal_of<Dim>(cell.normal));
      for (auto &row : P)
        for (double &value : row) value *= stretch;
      set_tensor<Dim>(phase.tensor.field, cell.at, P);
    }
  }
};

// Undeformed positions are moved as x = F X, so that B_s = F P_0 F^T, times s if the membrane was stretched before. The
// body crosses the boundaries of the box: positions differ by less than half of it.
template <int Dim>
void tells_the_strain(double stretch) {
  MarkedBall ball(Dim);
  ball.set_strain<Dim>(stretch);
  ball.markers->place(*ball.surface, ball.smooth, ball.phase, 0, 0, &ball.all);
  EXPECT_GT(ball.all.size(), Dim == 2 ? 50u : 1000u);
  Field velocity(ball.domain, Dim);
  const double F[3][3] = {
      {1.1, 0.2, Dim == 3 ? -0.1 : 0.}, {0.05, 0.9, Dim == 3 ? 0.1 : 0.}, {0, 0, Dim == 3 ? 1.05 : 1}};
  const double minor = F[0][0] * F[1][1] - F[0][1] * F[1][0];
  for (SurfaceMarker &marker : ball.all) {  // x = F X from the centre, F upper but for one entry
    Real3 x;
    for (int d = 0; d < 3; ++d) x[d] = std::remainder(marker.rest[d] - ball.centre[d], 1.0);
    const double z = Dim == 3 ? x[2] / F[2][2] : 0, a = x[0] - F[0][2] * z, b = x[1] - F[1][2] * z;
    marker.rest = {ball.centre[0] + (F[1][1] * a - F[0][1] * b) / minor,
                   ball.centre[1] + (F[0][0] * b - F[1][0] * a) / minor, ball.centre[2] + z};
  }
  ASSERT_EQ(ball.markers->move(0, velocity, &ball.all), 0);
  std::vector<SurfaceMarkers::Strain> strains;
  ball.markers->find_strain(*ball.surface, 0, &strains);
  EXPECT_EQ(strains.size(), ball.owned_nearest_count());
  EXPECT_GT(strains.size(), Dim == 2 ? 50u : 1000u);
  kernels::Tensor<Dim> B{};
  for (int x = 0; x < Dim; ++x)
    for (int y = 0; y < Dim; ++y)
      for (int k = 0; k < Dim; ++k) B[x][y] += stretch * F[x][k] * F[y][k];
  for (const SurfaceMarkers::Strain &strain : strains) {
    const SurfaceCells::Cell &cell = ball.surface->all()[strain.cell];
    const kernels::Tensor<Dim> expected = kernels::surface_tensor<Dim>(B, normal_of<Dim>(cell.normal));
    for (int x = 0; x < Dim; ++x)
      for (int y = x; y < Dim; ++y) EXPECT_NEAR(strain.B[kernels::position<Dim>(x, y)], expected[x][y], 0.01 * stretch);
  }
}

TEST(SurfaceMarkers, TellTheStrain) {
  for (const double stretch : {1.0, 1.3}) {
    tells_the_strain<2>(stretch);
    tells_the_strain<3>(stretch);
  }
}

TEST(SurfaceMarkers, AtRestTellThatToRoundOff) {
  MarkedBall ball(3);
  ball.set_strain<3>(1);
  ball.markers->place(*ball.surface, ball.smooth, ball.phase, 0, 0, &ball.all);
  Field velocity(ball.domain, 3);
  ASSERT_EQ(ball.markers->move(0, velocity, &ball.all), 0);
  std::vector<SurfaceMarkers::Strain> strains;
  ball.markers->find_strain(*ball.surface, 0, &strains);
  for (const SurfaceMarkers::Strain &strain : strains) {
    const auto P = kernels::tangential<3>(normal_of<3>(ball.surface->all()[strain.cell].normal));
    for (int x = 0; x < 3; ++x)
      for (int y = x; y < 3; ++y) EXPECT_NEAR(strain.B[kernels::position<3>(x, y)], P[x][y], 1e-12);
  }
}

TEST(SurfaceMarkers, AreSilentWhereThereAreNone) {
  MarkedBall ball(2);
  ball.set_strain<2>(1);
  ball.markers->place(*ball.surface, ball.smooth, ball.phase, 0, 0, &ball.all);
  Field velocity(ball.domain, 2);
  ball.all.resize(ball.all.size() / 2);
  ASSERT_EQ(ball.markers->move(0, velocity, &ball.all), 0);
  std::vector<SurfaceMarkers::Strain> strains;
  ball.markers->find_strain(*ball.surface, 0, &strains);
  EXPECT_GT(strains.size(), 10u);
  EXPECT_LT(strains.size() + 10, ball.owned_nearest_count());
}

TEST(SurfaceMarkers, MoveWithALinearFlowAndAcrossTheBox) {
  MarkedBall ball(3);
  ball.set_strain<3>(1);
  ball.markers->place(*ball.surface, ball.smooth, ball.phase, 0, 0, &ball.all);
  Field velocity(ball.domain, 3);
  const Real3 mean{0.7, -0.4, 0.1};
  for (int d = 0; d < 3; ++d)
    std::fill_n(velocity[d].origin - ball.domain.layout().origin, ball.domain.layout().size, mean[d]);
  const std::vector<SurfaceMarker> before = ball.all;
  constexpr double dt = 0.05;  // up to .84 cells
  ASSERT_EQ(ball.markers->move(dt, velocity, &ball.all), 0);
  ASSERT_EQ(ball.all.size(), before.size());
  for (std::size_t m = 0; m < before.size(); ++m)
    for (int d = 0; d < 3; ++d) {
      const auto place = [&](const SurfaceMarker &marker) { return (marker.cell[d] + marker.offset[d]) / ball.cells; };
      EXPECT_NEAR(std::remainder(place(ball.all[m]) - place(before[m]) - dt * mean[d], 1.0), 0, 1e-14);
      EXPECT_GE(ball.all[m].cell[d], 0);
      EXPECT_LT(ball.all[m].cell[d], ball.cells);
      EXPECT_LE(std::fabs(ball.all[m].offset[d]), 0.5);
    }
}

TEST(SurfaceMarkers, ComeBackToTheSurfaceAndAreTakenOutFarFromIt) {
  MarkedBall ball(3);
  ball.set_strain<3>(1);
  ball.markers->place(*ball.surface, ball.smooth, ball.phase, 0, 0, &ball.all);
  const std::size_t count = ball.all.size();
  const auto radius_of = [&](const SurfaceMarker &marker) {
    double square = 0;
    for (int d = 0; d < 3; ++d) {
      const double x = std::remainder((marker.cell[d] + 0.5 + marker.offset[d]) / ball.cells - ball.centre[d], 1.0);
      square += x * x;
    }
    return std::sqrt(square);
  };
  for (int d = 0; d < 3; ++d) ball.all[0].offset[d] += 0.3 * ball.all[0].normal[d];
  const double away = std::fabs(radius_of(ball.all[0]) - ball.radius);
  ball.all[1].cell = {12, 12, 12};  // opposite to the ball, whose centre is near x = 0
  ball.markers->pull_to_surface(*ball.surface, ball.smooth, 0, &ball.all);
  EXPECT_EQ(ball.all.size(), count - 1);
  EXPECT_NEAR(std::fabs(radius_of(ball.all[0]) - ball.radius), 0.8 * away, 0.05 * away);
}

TEST(SurfaceMarkers, ArePackedExactly) {
  MarkedBall ball(3);
  ball.set_strain<3>(1.3);
  ball.markers->place(*ball.surface, ball.smooth, ball.phase, 2, 0, &ball.all);
  for (const SurfaceMarker &marker : ball.all) {
    const auto values = marker.packed();
    EXPECT_EQ(SurfaceMarker::unpacked(values.data()).packed(), values);
    EXPECT_EQ(marker.phase, 2);
  }
}

}  // namespace
