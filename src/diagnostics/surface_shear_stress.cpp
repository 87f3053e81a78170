#include "diagnostics/surface_shear_stress.hpp"

#include "base/events.hpp"
#include "field/sides.hpp"
#include "kernels/interface_normal.hpp"
#include "kernels/plane.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

constexpr double trace = 1e-3;  // of solid that makes no surface
constexpr int most_terms = 10;

// The surface in a cell: a point of it, from the cell's centre in cells, and its normal out of the solid.
struct SurfacePlane {
  Real3 point{}, normal{};
};

// Terms of a quadratic, the linear ones first.
int terms(int dimension, const Real3 &r, double *t) {
  int n = 0;
  t[n++] = 1;
  for (int d = 0; d < dimension; ++d) t[n++] = r[d];
  for (int d = 0; d < dimension; ++d)
    for (int e = d; e < dimension; ++e) t[n++] = r[d] * r[e];
  return n;
}

// Least squares: the normal equations of one fit.
struct Fit {
  int count = 0;
  double gram[most_terms][most_terms]{}, right[most_terms]{};

  void add(const double *t, int n, double weight, double value) {
    count = n;
    for (int a = 0; a < n; ++a) {
      const double scaled = weight * t[a];
      right[a] += scaled * value;
      for (int b = 0; b <= a; ++b) gram[a][b] += scaled * t[b];
    }
  }

  // Coefficients of the quadratic; where the points do not determine it those of a linear function, or 0.
  void solve(int linear, double *x) {
    constexpr double least = 1e-8;  // of a diagonal element that is left of it
    std::fill_n(x, most_terms, 0.0);
    int n = 0;
    for (; n < count; ++n) {
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
    if (n < count) n = n >= linear ? linear : 0;
    for (int a = 0; a < n; ++a) {
      x[a] = right[a];
      for (int b = 0; b < a; ++b) x[a] -= gram[a][b] * x[b];
      x[a] /= gram[a][a];
    }
    for (int a = n - 1; a >= 0; --a) {
      for (int b = a + 1; b < n; ++b) x[a] -= gram[b][a] * x[b];
      x[a] /= gram[a][a];
    }
  }
};

class SurfaceCells {
public:
  SurfaceCells(const Box &box, ConstView solid) : box_(box), dimension_(box.dimension()), solid_(solid) {}

  // Adds traction(cell, plane), which need not be tangential.
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

  // visit(r, cell) for points of a field within `radius` cells of the surface, but those on sides: r from there, in
  // cells.
  template <class Visit>
  void for_places(const Staggering &at, int reach, double radius, const Int3 &cell, const SurfacePlane &plane,
                  const Visit &visit) const {
    Int3 low{}, high{};
    for (int d = 0; d < dimension_; ++d) {
      const int here = box_.layout().begin[d] + cell[d];
      low[d] = -reach + at[d];
      high[d] = reach;
      if (!box_.is_wall(d)) continue;
      low[d] = std::max(low[d], at[d] - here);
      high[d] = std::min(high[d], box_.domain_cells()[d] - 1 - here);
    }
    for (int k = low[2]; k <= high[2]; ++k)
      for (int j = low[1]; j <= high[1]; ++j)
        for (int i = low[0]; i <= high[0]; ++i) {
          const Int3 offset{i, j, k};
          Real3 r{};
          double square = 0;
          for (int d = 0; d < dimension_; ++d) {
            r[d] = offset[d] - (at[d] ? 0.5 : 0) - plane.point[d];
            square += r[d] * r[d];
          }
          if (square <= radius * radius) visit(r, Int3{cell[0] + i, cell[1] + j, cell[2] + k});
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

  // Of the surface in a cell the plane that leaves the cell its volume of solid.
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

// The components of the stress at the places where somebody asks for them, found once.
class KnownStress {
public:
  explicit KnownStress(const WholeStress &whole)
      : whole_(whole), known_(whole.viscosity.box, whole.viscosity.box.dimension() == 3 ? 6 : 3) {
    for (int c = 0; c < known_.count(); ++c) known_.fill(c, std::nan(""));
  }

  double at(int a, int b, const Int3 &place) {
    double &value = known_[a == b ? a : known_.count() == 3 ? 2 : 2 + a + b](place[0], place[1], place[2]);
    if (std::isnan(value)) value = a == b ? whole_.normal(a, place) : whole_.shear(a, b, place);
    return value;
  }

private:
  const WholeStress &whole_;
  Field known_;
};

}  // namespace

// From the fluid's side: quadratics through its velocity, the closer the further from the surface it is.
void add_rigid_surface_stress(const Box &box, double viscosity, ConstView solid, const Field &velocity, Field &stress) {
  const VerbScope scope(Verb::sums);
  const SurfaceCells cells(box, solid);
  const int dimension = box.dimension();
  const Real3 &h = box.spacing();
  const double finest = dimension == 2 ? std::min(h[0], h[1]) : std::min({h[0], h[1], h[2]});
  cells.add_to(stress, [&](const Int3 &cell, const SurfacePlane &plane) {
    double gradient[3][3]{};
    for (int a = 0; a < dimension; ++a) {
      Fit fit;
      cells.for_places(at_face[a], 3, 3.5, cell, plane, [&](const Real3 &r, const Int3 &place) {
        const double *q = &solid(place[0], place[1], place[2]);
        double distance = 0;
        for (int d = 0; d < dimension; ++d) distance += r[d] * h[d] * plane.normal[d] / finest;
        if (distance <= 0 || q[0] + q[-solid.stride(a)] >= 1) return;
        double t[most_terms];
        const int n = terms(dimension, r, t);
        fit.add(t, n, distance * distance, velocity[a](place[0], place[1], place[2]));
      });
      double x[most_terms];
      fit.solve(dimension + 1, x);
      for (int d = 0; d < dimension; ++d) gradient[a][d] = x[1 + d] / h[d];
    }
    Real3 traction{};
    for (int a = 0; a < dimension; ++a)
      for (int d = 0; d < dimension; ++d)
        traction[a] += viscosity * (gradient[a][d] + gradient[d][a]) * plane.normal[d];
    return traction;
  });
}

// Through the surface: what the momentum equation passes on there, viscous and elastic, goes from one side to the
// other.
void add_elastic_surface_stress(const WholeStress &whole, ConstView solid, Field &stress) {
  const VerbScope scope(Verb::sums);
  const Box &box = whole.viscosity.box;
  const SurfaceCells cells(box, solid);
  const int dimension = box.dimension();
  KnownStress known(whole);
  cells.add_to(stress, [&](const Int3 &cell, const SurfacePlane &plane) {
    Real3 traction{};
    for (int a = 0; a < dimension; ++a)
      for (int b = a; b < dimension; ++b) {
        Fit fit;
        cells.for_places(a == b ? at_centre : at_edge(a, b), 2, 2, cell, plane, [&](const Real3 &r, const Int3 &place) {
          const double t[] = {1, r[0], r[1], r[2]};
          fit.add(t, dimension + 1, 1, known.at(a, b, place));
        });
        double x[most_terms];
        fit.solve(dimension + 1, x);
        traction[a] += x[0] * plane.normal[b];
        if (b != a) traction[b] += x[0] * plane.normal[a];
      }
    return traction;
  });
}

}  // namespace eulastic
