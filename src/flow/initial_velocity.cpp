#include "flow/initial_velocity.hpp"

#include <cmath>
#include <random>

namespace eulastic {
namespace {

constexpr double pi = 3.14159265358979323846;

// psi_c is a sum over modes, each a product of one factor per direction: cos(2 pi m x/L + phase) in a periodic
// direction, or sin^2(pi m x/L) between walls, so that the curl of psi vanishes there; 1 in z in 2-D.
struct Mode {
  double coefficient;
  Int3 number;
  Real3 phase;
};
using Modes = std::array<std::vector<Mode>, 3>;

// Returns the factor of direction d at x, and its derivative.
std::array<double, 2> factor(const DomainShape &domain, const Mode &mode, int d, double x) {
  if (d >= domain.dimension()) return {1.0, 0.0};
  const double k = 2 * pi * mode.number[d] / domain.length[d];
  if (domain.is_wall(d)) return {0.5 - 0.5 * std::cos(k * x), 0.5 * k * std::sin(k * x)};
  return {std::cos(k * x + mode.phase[d]), -k * std::sin(k * x + mode.phase[d])};
}

Modes random_modes(const DomainShape &domain, double amplitude) {
  constexpr int count = 6;
  std::mt19937 generator(20131117);  // its raw output is fixed by the language standard
  const auto uniform = [&] { return generator() / 4294967296.0; };
  Modes modes;
  for (auto &list : modes)
    for (int m = 0; m < count; ++m) {
      Mode mode{};
      double k = 0;
      for (int d = 0; d < 3; ++d) {
        mode.number[d] = 1 + static_cast<int>(3 * uniform());
        mode.phase[d] = 2 * pi * uniform();
        if (d < domain.dimension()) k = std::max(k, 2 * pi * mode.number[d] / domain.length[d]);
      }
      mode.coefficient = amplitude * (2 * uniform() - 1) / k;
      list.push_back(mode);
    }
  return modes;
}

// Returns the derivative of a component of psi at x.
double derivative(const DomainShape &domain, const std::vector<Mode> &modes, int direction, const Real3 &x) {
  double sum = 0;
  for (const Mode &mode : modes) {
    double term = mode.coefficient;
    for (int d = 0; d < 3; ++d) term *= factor(domain, mode, d, x[d])[d == direction];
    sum += term;
  }
  return sum;
}

// Returns velocity component c at x.
struct Pointwise {
  DomainShape domain;
  InitialFlow flow;
  Real3 wall_low, wall_high;  // of the walls in y, at t = 0
  Modes modes;

  double operator()(int c, const Real3 &x) const {
    const double A = flow.amplitude;
    const Real3 &L = domain.length;
    const Real3 k{2 * pi / L[0], 2 * pi / L[1], 2 * pi / L[2]};
    switch (flow.kind) {
      case InitialVelocity::zero:
      case InitialVelocity::uniform:
        return 0;
      case InitialVelocity::taylor_green:
        return c == 0   ? A * std::sin(k[0] * x[0]) * std::cos(k[1] * x[1])
               : c == 1 ? -A * L[1] / L[0] * std::cos(k[0] * x[0]) * std::sin(k[1] * x[1])
                        : 0;
      case InitialVelocity::taylor_green_3d:
        return c == 0   ? A * std::sin(k[0] * x[0]) * std::cos(k[1] * x[1]) * std::cos(k[2] * x[2])
               : c == 1 ? -A * L[1] / L[0] * std::cos(k[0] * x[0]) * std::sin(k[1] * x[1]) * std::cos(k[2] * x[2])
                        : 0;
      case InitialVelocity::shear_layer: {
        const double y = x[1] / L[1];
        return c == 0   ? A * std::tanh(30 * (y <= 0.5 ? y - 0.25 : 0.75 - y))
               : c == 1 ? 0.05 * A * std::sin(k[0] * x[0])
                        : 0;
      }
      case InitialVelocity::couette:
        return wall_low[c] + (wall_high[c] - wall_low[c]) * (x[1] / L[1]);
      case InitialVelocity::poiseuille:
        return c == 0 ? 4 * A * x[1] * (L[1] - x[1]) / (L[1] * L[1]) : 0;
      case InitialVelocity::random: {
        const int a = (c + 1) % 3, b = (c + 2) % 3;  // curl: u_c = d_a psi_b - d_b psi_a; only psi_z in 2-D
        const double first = domain.dimension() == 2 && b != 2 ? 0 : derivative(domain, modes[b], a, x);
        const double second = domain.dimension() == 2 && a != 2 ? 0 : derivative(domain, modes[a], b, x);
        return first - second;
      }
      default: {
        const auto [component, along] = shear_wave_directions(flow.kind);
        return c == component ? A * std::sin((domain.is_wall(along) ? 0.5 : 1.0) * k[along] * x[along]) : 0;
      }
    }
  }
};

}  // namespace

const std::vector<std::string> &initial_velocity_names() {
  static const std::vector<std::string> names{"zero",          "uniform",       "taylor_green",  "taylor_green_3d",
                                              "shear_layer",   "couette",       "poiseuille",    "shear_wave_xy",
                                              "shear_wave_xz", "shear_wave_yx", "shear_wave_yz", "shear_wave_zx",
                                              "shear_wave_zy", "random"};
  return names;
}

std::array<int, 2> shear_wave_directions(InitialVelocity kind) {
  if (kind < InitialVelocity::shear_wave_xy || kind > InitialVelocity::shear_wave_zy) return {-1, -1};
  const std::string &name = initial_velocity_names()[static_cast<int>(kind)];
  return {name[name.size() - 2] - 'x', name.back() - 'x'};
}

void set_initial_velocity(const Box &box, const BoundaryConditions &sides, const InitialFlow &flow, Field &velocity) {
  const Pointwise value{
      box.domain_shape(), flow, sides[1][0].motion.at(0), sides[1][1].motion.at(0),
      flow.kind == InitialVelocity::random ? random_modes(box.domain_shape(), flow.amplitude) : Modes{}};
  const Layout &layout = box.layout();
  for (int c = 0; c < velocity.count(); ++c) {
    Int3 end = layout.cells;
    if (box.is_open(c, true)) end[c] = box.points_end(c, true);
    for_points({{0, 0, 0}, end}, [&](int i, int j, int k) {
      const Int3 cell{layout.begin[0] + i, layout.begin[1] + j, layout.begin[2] + k};
      Real3 x{};  // z = 0 in 2-D
      for (int d = 0; d < box.dimension(); ++d) x[d] = (cell[d] + (d == c ? 0.0 : 0.5)) * box.spacing()[d];
      velocity[c](i, j, k) = value(c, x) + flow.mean[c];
    });
  }
}

}  // namespace eulastic
