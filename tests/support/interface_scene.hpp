// A solid fraction carried by a given velocity, without a solver.
#pragma once

#include "base/exact_sum.hpp"
#include "bodies/volume_fraction.hpp"
#include "field/boundaries.hpp"
#include "field/ghost_exchange.hpp"
#include "solids/interface.hpp"

#include <cmath>
#include <functional>

namespace eulastic::test {

using Position = std::function<double(const Real3 &)>;
/// A velocity as the curl of a vector potential, x, y, z: its discrete divergence is round-off.
using Potential = std::array<Position, 3>;

/// Part of the cell of size h around `x` where the signed distance `level` is negative.
inline double cell_fraction(const Position &level, const Real3 &x, const Real3 &h, int dimension, int depth = 4) {
  const double size = dimension == 2 ? std::hypot(h[0], h[1]) : std::hypot(h[0], h[1], h[2]);
  const double distance = level(x);
  if (std::abs(distance) > size) return distance < 0;
  Real3 slopes{};
  double sum = 0;
  if (depth == 0) {
    for (int d = 0; d < dimension; ++d) {
      Real3 low = x, high = x;
      low[d] -= h[d] / 2;
      high[d] += h[d] / 2;
      slopes[d] = level(high) - level(low);
    }
    return half_space_fraction(distance, slopes);
  }
  for (int part = 0; part < 1 << dimension; ++part) {
    Real3 centre = x, half = h;
    for (int d = 0; d < dimension; ++d) {
      half[d] = h[d] / 2;
      centre[d] += (part >> d & 1 ? 0.25 : -0.25) * h[d];
    }
    sum += cell_fraction(level, centre, half, dimension, depth - 1);
  }
  return sum / (1 << dimension);
}

/// Distance to the sphere (disc) of the given radius, and to its nearest image in a periodic unit box.
inline Position ball(const Real3 &centre, double radius, int dimension, bool periodic = false) {
  return [=](const Real3 &x) {
    double sum = 0;
    for (int d = 0; d < dimension; ++d) {
      const double r = x[d] - centre[d], nearest = periodic ? r - std::round(r) : r;
      sum += nearest * nearest;
    }
    return std::sqrt(sum) - radius;
  };
}

/// About the distance to an ellipsoid (ellipse), to first order.
inline Position ellipsoid(const Real3 &centre, const Real3 &axes, int dimension) {
  return [=](const Real3 &x) {
    double square = 0, slope = 0;
    for (int d = 0; d < dimension; ++d) {
      const double q = (x[d] - centre[d]) / axes[d];
      square += q * q;
      slope += q * q / (axes[d] * axes[d]);
    }
    const double level = std::sqrt(square);
    return level > 0 ? (level - 1) * level / std::sqrt(slope) : -axes[dimension - 1];
  };
}

class InterfaceScene {
public:
  Domain domain;
  Field velocity, fraction;
  long step = 0;

  PetscErrorCode create(MPI_Comm comm, const GridSpec &spec) {
    PetscFunctionBeginUser;
    PetscCall(domain.create(comm, spec));
    velocity = Field(domain, domain.dimension());
    fraction = Field(domain, 1);
    exchange_ = std::make_unique<GhostExchange>(domain);
    work_ = Field(domain, InterfaceTransport::work_fields);
    PetscFunctionReturn(0);
  }

  /// Position of a point at local (i, j, k), `at` half a cell along the directions that are true; wrapped into the box.
  Real3 position(const Int3 &local, const std::array<bool, 3> &at) const {
    Real3 x{};
    for (int d = 0; d < 3; ++d) {
      const int n = domain.domain_cells()[d], g = domain.layout().begin[d] + local[d];
      const int wrapped = domain.is_wall(d) ? g : ((g % n) + n) % n;
      x[d] = (wrapped + (at[d] ? 0.5 : 0.0)) * domain.spacing()[d];
    }
    return x;
  }

  void set_fraction(const Position &level) {
    each_owned([&](int i, int j, int k) {
      fraction[0](i, j, k) =
          cell_fraction(level, position({i, j, k}, {true, true, true}), domain.spacing(), domain.dimension());
    });
  }

  PetscErrorCode set_velocity(const Potential &potential) {
    const Real3 &h = domain.spacing();
    PetscFunctionBeginUser;
    for (int a = 0; a < domain.dimension(); ++a)
      for (int e = 0; e < 2; ++e) {  // u_a = d_b A_c - d_c A_b
        const int b = (a + 1 + e) % 3, c = 3 - a - b;
        if (!potential[c] || b >= domain.dimension()) continue;
        std::array<bool, 3> edge{};
        edge[c] = true;
        for (int k = 0; k < domain.points_end(2, a == 2); ++k)
          for (int j = 0; j < domain.points_end(1, a == 1); ++j)
            for (int i = 0; i < domain.points_end(0, a == 0); ++i) {
              Int3 next{i, j, k};
              ++next[b];
              const double difference = potential[c](position(next, edge)) - potential[c](position({i, j, k}, edge));
              velocity[a](i, j, k) += (e == 0 ? difference : -difference) / h[b];
            }
      }
    PetscCall(update_velocity_ghosts());
    PetscFunctionReturn(0);
  }

  PetscErrorCode update_velocity_ghosts() {
    PetscFunctionBeginUser;
    PetscCall(exchange_->update_ghosts(velocity, 3));
    fill_wall_ghosts_velocity(domain, BoundaryConditions{}, 0, velocity, 3);
    PetscFunctionReturn(0);
  }

  /// Uniform velocity in a periodic box.
  void set_velocity(const Real3 &uniform) {
    for (int d = 0; d < domain.dimension(); ++d) velocity.fill(d, uniform[d]);
  }

  PetscErrorCode advance(double dt) {
    PetscFunctionBeginUser;
    PetscCall(exchange_->update_ghosts(fraction, InterfaceTransport::ghosts));
    PetscCall(transport_.advance(domain, dt, velocity, step++, {}, fraction, work_));
    PetscFunctionReturn(0);
  }

  double band_cells() const { return transport_.band_cells(); }

  template <class F>
  void each_owned(F &&f) const {
    const Int3 &n = domain.cells();
    for (int k = 0; k < n[2]; ++k)
      for (int j = 0; j < n[1]; ++j)
        for (int i = 0; i < n[0]; ++i) f(i, j, k);
  }

  /// Sum over the owned cells of f(phi), not rounded on the way.
  double sum(const std::function<double(double)> &f = [](double q) { return q; }) const {
    Superaccumulator total;
    each_owned([&](int i, int j, int k) { total.add(f(fraction[0](i, j, k))); });
    return total.value();
  }

  /// Integral of |phi - exact| over the volume of `exact`.
  double shape_error(const Position &level) const {
    double error = 0, volume = 0;
    each_owned([&](int i, int j, int k) {
      const double exact =
          cell_fraction(level, position({i, j, k}, {true, true, true}), domain.spacing(), domain.dimension());
      error += std::abs(fraction[0](i, j, k) - exact);
      volume += exact;
    });
    return error / volume;
  }

  Real3 centroid() const {
    Real3 moment{};
    double volume = 0;
    each_owned([&](int i, int j, int k) {
      const Real3 x = position({i, j, k}, {true, true, true});
      for (int d = 0; d < 3; ++d) moment[d] += fraction[0](i, j, k) * x[d];
      volume += fraction[0](i, j, k);
    });
    return {moment[0] / volume, moment[1] / volume, moment[2] / volume};
  }

private:
  std::unique_ptr<GhostExchange> exchange_;
  Field work_;
  InterfaceTransport transport_;
};

}  // namespace eulastic::test
