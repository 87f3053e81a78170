// The pressure that maintains a film of fluid between membranes and walls.
#include "membranes/wall_film.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

constexpr double h = 0.25, modulus = 2, largest = 4 * modulus;  // neo-Hookean: G_s (1 + 3)
constexpr int cells_x = 24, cells_y = 12;

struct Film {
  Domain domain;
  Phase phase, floor;
  Field scratch, force;
  WallFilm film;

  // A floor below row `bottom`: a boundary of the box, or a rigid body in a periodic box.
  explicit Film(int bottom, BoundaryKind side = BoundaryKind::wall) {
    GridSpec spec;
    spec.cells = {cells_x, cells_y, 1};
    spec.length = {cells_x * h, cells_y * h, h};
    spec.boundary[1] = bottom == 0 ? Boundary::wall : Boundary::periodic;
    EXPECT_EQ(domain.create(PETSC_COMM_SELF, spec), 0);
    phase.material.law = Law::membrane;
    phase.material.membrane.shear_modulus = modulus;
    phase.fraction = Field(domain, 1);
    floor.fraction = Field(domain, 1);
    scratch = Field(domain, WallFilm::work_fields);
    force = Field(domain, 2);
    BoundaryConditions sides;
    for (auto &one : sides[1]) one.kind = side;
    for (int j = 0; j < bottom; ++j) std::fill_n(floor.fraction[0].row(j, 0), cells_x, 1.0);
    const ConstView floor_fraction = std::as_const(floor).fraction[0];
    const std::vector<ConstView> rigid(bottom > 0 ? 1 : 0, floor_fraction);
    GhostExchange exchange(domain);
    EXPECT_EQ(exchange.update_ghosts(floor.fraction, 5), 0);
    film.find(domain, sides, rigid, scratch);
  }
  // A body that fills the box above a film with the part 1 - beside(i) of row `bottom`.
  void fill(int bottom, const std::function<double(int)> &beside) {
    for (int j = bottom; j < bottom + 4; ++j)
      for (int i = -5; i < cells_x + 5; ++i) phase.fraction[0](i, j, 0) = j == bottom ? beside(i) : 1;
  }
  // Minus the power of the force, and the stored energy.
  std::array<double, 2> energy(const Field &velocity) {
    ExactSums sums(2);
    film.add_power(phase, velocity, 0, &sums);
    film.add_energy(phase, 1, &sums);
    std::array<double, 2> found{};
    EXPECT_EQ(sums.reduce(PETSC_COMM_SELF, found.data()), 0);
    return found;
  }
};

// (27b): a flat body presses with P (phi - phi^2/2), and with 0 if the row beside the wall is free.
TEST(WallFilm, PushesABodyOffTheWall) {
  for (const int bottom : {0, 2}) {
    Film scene(bottom);
    scene.fill(bottom, [](int i) { return i < 12 ? 0.0 : 0.4; });
    scene.film.add_force(scene.phase, scene.force);
    const double pressure = largest / h;
    for (int j = 0; j < cells_y; ++j)
      for (int i = 0; i < cells_x; ++i) {
        EXPECT_EQ(scene.force[0](i, j, 0), 0) << i << " " << j;
        const double pushed = i < 12 || j != bottom + 1 ? 0 : pressure * (0.4 - 0.08) / h;
        EXPECT_NEAR(scene.force[1](i, j, 0), pushed, 1e-13 * pressure / h) << i << " " << j;
      }
  }
}

// For any flow, with central fluxes of phi along the wall, and the face above entirely in the body.
TEST(WallFilm, StoresWhatTheFlowGivesToIt) {
  Film scene(0);
  const auto beside = [](int i) { return 0.5 + 0.4 * std::sin(2 * M_PI * i / cells_x); };
  Field velocity(scene.domain, 2);
  const auto u = [](int i) { return 0.3 + std::cos(4 * M_PI * i / cells_x) + 0.2 * std::sin(6 * M_PI * i / cells_x); };
  const auto rate = [&](int i) {
    const auto flux = [&](int face) { return u(face) * 0.5 * (beside(face - 1) + beside(face)); };
    return (u(i + 1) - u(i) - (flux(i + 1) - flux(i))) / h;
  };
  for (int i = 0; i < cells_x; ++i) {
    velocity[0](i, 0, 0) = u(i);
    velocity[1](i, 1, 0) = u(i) - u(i + 1);
  }
  constexpr double dt = 1e-3;
  std::array<std::array<double, 2>, 3> found{};
  for (const int n : {-1, 0, 1}) {
    scene.fill(0, [&](int i) { return beside(i) + n * dt * rate(i); });
    found[n + 1] = scene.energy(velocity);
  }
  EXPECT_GT(std::fabs(found[1][0]), 1);
  EXPECT_NEAR((found[2][1] - found[0][1]) / (2 * dt), found[1][0], 1e-10 * found[1][1]);
}

TEST(WallFilm, IsNotAtPlanesOfSymmetryAndOpenSides) {
  for (const BoundaryKind side : {BoundaryKind::symmetry, BoundaryKind::pressure, BoundaryKind::outflow}) {
    Film scene(0, side);
    scene.fill(0, [](int) { return 0.4; });
    scene.film.add_force(scene.phase, scene.force);
    for (int j = 0; j < cells_y; ++j)
      for (int i = 0; i < cells_x; ++i) EXPECT_EQ(scene.force[1](i, j, 0), 0);
  }
}

}  // namespace
