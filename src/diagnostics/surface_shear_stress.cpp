#include "diagnostics/surface_shear_stress.hpp"

#include "base/events.hpp"
#include "field/boundaries.hpp"
#include "kernels/interface_normal.hpp"
#include "kernels/plane.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

constexpr double trace = 1e-3;  // solid fractions below this, or above 1 less this, are no surface

// The plane of the surface in a cell: a point on it, in cells from the centre, and its unit normal out of the solid.
struct SurfacePlane {
  Real3 point{}, normal{};
};

// Numbers of terms of a linear and of a quadratic function.
constexpr int linear_terms(int dimension) { return 1 + dimension; }
constexpr int quadratic_terms(int dimension) { return 1 + dimension + dimension * (dimension + 1) / 2; }

// Evaluates the terms of a quadratic, linear terms first.
template <int Dim>
EULASTIC_INLINE void terms(const Real3 &r, double *t) {
  int n = 0;
  t[n++] = 1;
  for (int d = 0; d < Dim; ++d) t[n++] = r[d];
  for (int d = 0; d < Dim; ++d)
    for (int e = d; e < Dim; ++e) t[n++] = r[d] * r[e];
}

// Least-squares fit of several functions at the same points, by normal equations.
template <int Terms, int Functions>
struct Fit {
  double gram[Terms][Terms]{}, right[Functions][Terms]{};
  int determined = 0;  // number of coefficients that the points determine

  EULASTIC_INLINE void add(const double *t, double weight, const double *values) {
    for (int a = 0; a < Terms; ++a) {
      const double scaled = weight * t[a];
      for (int f = 0; f < Functions; ++f) right[f][a] += scaled * values[f];
      for (int b = 0; b <= a; ++b) gram[a][b] += scaled * t[b];
    }
  }

  // Replaces the matrix by its Cholesky factor. If the points do not determine all coefficients, solve() returns those
  // of a linear function, or none.
  void factor(int linear) {
    constexpr double least = 1e-8;  // relative size of a diagonal element after elimination that counts as 0
    int n = 0;
    for (; n < Terms; ++n) {
      const double whole = gram[n][n];
      for (int b = 0; b <= n; ++b) {
        double sum = gram[n][b];
        for (int c = 0; c < b; ++c) sum -= gram[n][c] * gram[b][c];
        if (b < n)
          gram[n][b] = sum / gram[b][b];
        else
          gram[n][n] = sum > least * whole ? std::sqrt(sum) : 0;
      }
      if (gram[n][n] == 0) break;
    }
    determined = n == Terms ? n : n >= linear ? linear : 0;
  }

  // Computes the coefficients of a function, after factor().
  void solve(int function, double *x) const {
    std::fill_n(x, Terms, 0.0);
    for (int a = 0; a < determined; ++a) {
      x[a] = right[function][a];
      for (int b = 0; b < a; ++b) x[a] -= gram[a][b] * x[b];
      x[a] /= gram[a][a];
    }
    for (int a = determined - 1; a >= 0; --a) {
      for (int b = a + 1; b < determined; ++b) x[a] -= gram[b][a] * x[b];
      x[a] /= gram[a][a];
    }
  }
};

// The cells that a surface cuts.
class CutCells {
public:
  CutCells(const Box &box, ConstView solid) : box_(box), dimension_(box.dimension()), solid_(solid) {}

  // Adds the tangential part of traction(cell, plane) to `stress` in all cut cells.
  template <class Traction>
  void add_to(Field &stress, const Traction &traction) const {
    for_points(box_.rows(), [&](int i, int j, int k) {
      const Int3 cell{i, j, k};
      SurfacePlane plane;
      if (!is_cut(cell) || !find_plane(cell, &plane)) return;
      const Real3 t = traction(cell, plane), &n = plane.normal;
      const double along = t[0] * n[0] + t[1] * n[1] + t[2] * n[2];
      for (int c = 0; c < dimension_; ++c) stress[c](i, j, k) += t[c] - along * n[c];
    });
  }

  // Calls visit(r, cell) for the points of a field within `radius` cells of the surface point, except for those on
  // boundaries; r is the offset from it, in cells.
  template <class Visit>
  void for_points_near(const Staggering &at, int reach, double radius, const Int3 &cell, const SurfacePlane &plane,
                       const Visit &visit) const {
    Int3 low{}, high{};
    for (int d = 0; d < dimension_; ++d) {
      const int index = box_.layout().begin[d] + cell[d];
      low[d] = -reach + at[d];
      high[d] = reach;
      if (!box_.is_wall(d)) continue;
      low[d] = std::max(low[d], at[d] - index);
      high[d] = std::min(high[d], box_.domain_cells()[d] - 1 - index);
    }
    const auto away = [&](int d, int offset) {
      return d < dimension_ ? offset - (at[d] ? 0.5 : 0) - plane.point[d] : 0.0;
    };
    for (int k = low[2]; k <= high[2]; ++k)
      for (int j = low[1]; j <= high[1]; ++j) {
        Real3 r{0, away(1, j), away(2, k)};
        if (r[1] * r[1] + r[2] * r[2] > radius * radius) continue;
        for (int i = low[0]; i <= high[0]; ++i) {
          r[0] = away(0, i);
          if (r[0] * r[0] + r[1] * r[1] + r[2] * r[2] <= radius * radius)
            visit(r, Int3{cell[0] + i, cell[1] + j, cell[2] + k});
        }
      }
  }

private:
  bool is_cut(const Int3 &cell) const {
    const double *q = &solid_(cell[0], cell[1], cell[2]);
    if (*q > trace) return *q < 1 - trace;
    for (int d = 0; d < dimension_; ++d)
      if (std::max(q[solid_.stride(d)], q[-solid_.stride(d)]) >= 1 - trace) return true;
    return false;
  }

  // Finds the plane that cuts the solid fraction of the cell from it.
  bool find_plane(const Int3 &cell, SurfacePlane *plane) const {
    const double *q = &solid_(cell[0], cell[1], cell[2]);
    const std::ptrdiff_t sy = solid_.stride(1), sz = solid_.stride(2);
    const bool flat = dimension_ == 2;
    const kernels::InterfaceNormal m =
        flat ? kernels::interface_normal<2>(q, 1, sy, sz) : kernels::interface_normal<3>(q, 1, sy, sz);
    const Real3 inward{m.a, m.b, m.c}, &h = box_.spacing();
    if (inward == Real3{}) return false;
    const double a = std::fabs(m.a), b = std::fabs(m.b), c = std::fabs(m.c), phi = std::clamp(*q, 0.0, 1.0);
    const double constant = flat ? kernels::plane_constant<2>(phi, a, b, c) : kernels::plane_constant<3>(phi, a, b, c);
    double square = 0;
    for (int d = 0; d < dimension_; ++d) square += inward[d] * inward[d] / (h[d] * h[d]);
    for (int d = 0; d < dimension_; ++d) {
      plane->normal[d] = -inward[d] / (h[d] * std::sqrt(square));
      plane->point[d] = (0.5 - constant) * inward[d] / (h[d] * h[d] * square);
    }
    return true;
  }

  const Box &box_;
  int dimension_;
  ConstView solid_;
};

// Components of the stress, computed where they are needed and stored.
class CachedStress {
public:
  explicit CachedStress(const TotalStress &whole)
      : whole_(whole), known_(whole.viscosity.box, whole.viscosity.box.dimension() == 3 ? 6 : 3) {
    for (int c = 0; c < known_.count(); ++c) known_.fill(c, std::nan(""));
  }

  double at(int a, int b, const Int3 &place) {
    double &value = known_[a == b ? a : known_.count() == 3 ? 2 : 2 + a + b](place[0], place[1], place[2]);
    if (std::isnan(value)) value = a == b ? whole_.normal(a, place) : whole_.shear(a, b, place);
    return value;
  }

private:
  const TotalStress &whole_;
  Field known_;
};

// Traction from the fluid side of a rigid surface: quadratics are fitted to the fluid velocity with the squared
// distance from the surface as the weight.
template <int Dim>
Real3 rigid_traction(const CutCells &cells, const Box &box, double viscosity, ConstView solid, const Field &velocity,
                     const Int3 &cell, const SurfacePlane &plane) {
  constexpr int count = quadratic_terms(Dim);
  const Real3 &h = box.spacing();
  const double finest = Dim == 2 ? std::min(h[0], h[1]) : std::min({h[0], h[1], h[2]});
  double gradient[3][3]{};
  for (int a = 0; a < Dim; ++a) {
    Fit<count, 1> fit;
    cells.for_points_near(at_face[a], 3, 3.5, cell, plane, [&](const Real3 &r, const Int3 &place) {
      const double *q = &solid(place[0], place[1], place[2]);
      double distance = 0;
      for (int d = 0; d < Dim; ++d) distance += r[d] * h[d] * plane.normal[d] / finest;
      if (distance <= 0 || q[0] + q[-solid.stride(a)] >= 1) return;
      double t[count];
      terms<Dim>(r, t);
      fit.add(t, distance * distance, &velocity[a](place[0], place[1], place[2]));
    });
    double x[count];
    fit.factor(linear_terms(Dim));
    fit.solve(0, x);
    for (int d = 0; d < Dim; ++d) gradient[a][d] = x[1 + d] / h[d];
  }
  Real3 traction{};
  for (int a = 0; a < Dim; ++a)
    for (int d = 0; d < Dim; ++d) traction[a] += viscosity * (gradient[a][d] + gradient[d][a]) * plane.normal[d];
  return traction;
}

// Traction on an elastic surface: linear functions are fitted to viscous plus elastic stress on both sides, because the
// traction is continuous.
template <int Dim>
Real3 elastic_traction(const CutCells &cells, CachedStress &known, const Int3 &cell, const SurfacePlane &plane) {
  constexpr int count = linear_terms(Dim);
  double stress[Dim][Dim], x[count];
  Fit<count, Dim> normal;
  cells.for_points_near(at_centre, 2, 2, cell, plane, [&](const Real3 &r, const Int3 &place) {
    const double t[] = {1, r[0], r[1], r[2]};
    double values[Dim];
    for (int a = 0; a < Dim; ++a) values[a] = known.at(a, a, place);
    normal.add(t, 1, values);
  });
  normal.factor(count);
  for (int a = 0; a < Dim; ++a) {
    normal.solve(a, x);
    stress[a][a] = x[0];
    for (int b = a + 1; b < Dim; ++b) {
      Fit<count, 1> shear;
      cells.for_points_near(at_edge(a, b), 2, 2, cell, plane, [&](const Real3 &r, const Int3 &place) {
        const double t[] = {1, r[0], r[1], r[2]}, value = known.at(a, b, place);
        shear.add(t, 1, &value);
      });
      shear.factor(count);
      shear.solve(0, x);
      stress[a][b] = x[0];
    }
  }
  Real3 traction{};
  for (int a = 0; a < Dim; ++a)
    for (int b = a; b < Dim; ++b) {
      traction[a] += stress[a][b] * plane.normal[b];
      if (b != a) traction[b] += stress[a][b] * plane.normal[a];
    }
  return traction;
}

}  // namespace

void add_rigid_surface_stress(const Box &box, double viscosity, ConstView solid, const Field &velocity, Field &stress) {
  const EventScope scope(Event::sums);
  const CutCells cells(box, solid);
  const auto traction = box.dimension() == 2 ? rigid_traction<2> : rigid_traction<3>;
  cells.add_to(stress, [&](const Int3 &cell, const SurfacePlane &plane) {
    return traction(cells, box, viscosity, solid, velocity, cell, plane);
  });
}

void add_elastic_surface_stress(const TotalStress &whole, ConstView solid, Field &stress) {
  const EventScope scope(Event::sums);
  const CutCells cells(whole.viscosity.box, solid);
  const auto traction = whole.viscosity.box.dimension() == 2 ? elastic_traction<2> : elastic_traction<3>;
  CachedStress known(whole);
  cells.add_to(stress,
               [&](const Int3 &cell, const SurfacePlane &plane) { return traction(cells, known, cell, plane); });
}

}  // namespace eulastic
