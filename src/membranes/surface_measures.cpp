#include "membranes/surface_measures.hpp"

#include "base/events.hpp"
#include "base/exact_sum.hpp"
#include "bodies/body_sums.hpp"
#include "bodies/unwrap.hpp"
#include "kernels/plane.hpp"

#include <petscblaslapack.h>
#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

// Sums of one body: the weight delta h, its first and second moments in cells, momentum, velocity times position,
// energies.
constexpr int weight = 0, first_moment = 1, second_moment = 4, momentum = 10, moment_of_velocity = 13, energies = 22;
constexpr int area = 25, weight_at_rest = 26, all_sums = 27;
constexpr int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};

using Matrix = std::array<Real3, 3>;

// Solves x M = C by Cholesky's decomposition of the symmetric, positive semidefinite M. Returns false if M is singular.
bool divide(Matrix C, Matrix M, int dimension, Matrix *quotient) {
  const PetscBLASInt n = dimension, stride = 3;  // LAPACK stores columns where Matrix has rows
  PetscBLASInt info;
  LAPACKpotrf_("L", &n, M[0].data(), &stride, &info);
  for (int p = 0; p < dimension; ++p)
    if (info != 0 || !(M[p][p] * M[p][p] > 1e-9)) return false;
  LAPACKpotrs_("L", &n, &n, M[0].data(), &stride, C[0].data(), &stride, &info);
  *quotient = C;
  return true;
}

double turning_rate(const BodySums &sums, int b, const Real3 &spacing, int dimension, double speed) {
  const double all = sums.value(b, weight);
  if (!(all > 0)) return 0;
  Matrix M{}, C{}, A{};
  const auto mean = [&](int s) { return sums.value(b, s) / all; };
  for (int c = 0; c < 6; ++c) {
    const auto [p, q] = pairs[c];
    M[p][q] = M[q][p] = mean(second_moment + c) - mean(first_moment + p) * mean(first_moment + q);
  }
  for (int v = 0; v < dimension; ++v)
    for (int x = 0; x < dimension; ++x)
      C[v][x] = mean(moment_of_velocity + 3 * v + x) - mean(momentum + v) * mean(first_moment + x);
  if (!divide(C, M, dimension, &A)) return 0;
  const double xx = A[0][0] / spacing[0], xy = A[0][1] / spacing[1], yx = A[1][0] / spacing[0],
               yy = A[1][1] / spacing[1];
  const double strain = 0.5 * (xx - yy), square = -(strain * strain + xy * yx);
  return square > 0 ? std::copysign(std::sqrt(square), yx - xy) * speed : 0;
}

// Area of the surface in a labelled cell: that of its plane, or of faces between full and empty cells.
template <int Dim>
double area_of(ConstView phi, const double *q, const Real3 &h) {
  const std::ptrdiff_t stride[3] = {1, phi.sy, phi.sz};
  double sum = 0, face[3];
  for (int d = 0; d < Dim; ++d) {
    face[d] = (Dim == 2 ? 1 : h[(d + 2) % 3]) * h[(d + 1) % Dim];
    for (const std::ptrdiff_t s : {-stride[d], stride[d]})
      if (*q == 1 && q[s] == 0) sum += face[d];
  }
  return *q > 0 && *q < 1 ? kernels::plane_area<Dim>(q, stride, face) : sum;
}

// Largest values over all samples, which scale the sums.
struct Scales {
  double speed, shear, area, bending;
  explicit Scales(const std::vector<double> &v) : speed(v[0]), shear(v[1]), area(v[2]), bending(v[3]) {}
};

std::vector<double> largest_of(const std::vector<SurfaceSample> &samples, int dim) {
  std::vector<double> found(4, 0.0);
  for (const SurfaceSample &s : samples) {
    for (int d = 0; d < dim; ++d) found[0] = std::max(found[0], std::fabs(s.velocity[d]));
    found[1] = std::max(found[1], std::fabs(s.shear_energy));
    found[2] = std::max(found[2], std::fabs(s.area_energy));
    found[3] = std::max(found[3], std::fabs(s.bending_energy));
  }
  return found;
}

double scaled(double value, double scale) { return scale > 0 ? value / scale : 0; }

// Units in which areas are summed, from the smallest spacing.
struct Units {
  double face = 0, area = 1;
  explicit Units(const Box &box) {
    const Real3 &h = box.spacing();
    face = *std::min_element(h.begin(), h.begin() + box.dimension());
    for (int d = 0; d < box.dimension() - 1; ++d) area *= face;
  }
};

// Adds a sample at x cells from the reference cell of body b.
void add_sample(const SurfaceSample &s, int b, const Real3 &x, int dim, double face, const Scales &scale,
                BodySums *sums) {
  const double w = s.delta * face;
  sums->add(b, weight, w);
  sums->add(b, weight_at_rest, s.rest * face);
  for (int d = 0; d < dim; ++d) {
    const double v = scaled(s.velocity[d], scale.speed);
    sums->add(b, first_moment + d, w * x[d]);
    sums->add(b, momentum + d, w * v);
    for (int e = 0; e < dim; ++e) sums->add(b, moment_of_velocity + 3 * d + e, w * (v * x[e]));
  }
  for (int c = 0; c < 6; ++c) sums->add(b, second_moment + c, w * (x[pairs[c][0]] * x[pairs[c][1]]));
  sums->add(b, energies, scaled(s.shear_energy, scale.shear));
  sums->add(b, energies + 1, scaled(s.area_energy, scale.area));
  sums->add(b, energies + 2, scaled(s.bending_energy, scale.bending));
}

SurfaceMeasure evaluate(const Box &box, const BodySums &sums, int b, const Scales &scale, double largest_stretch) {
  const double at_rest = sums.value(b, weight_at_rest);
  return {sums.value(b, area) * Units(box).area,
          sums.value(b, energies) * scale.shear,
          sums.value(b, energies + 1) * scale.area,
          sums.value(b, energies + 2) * scale.bending,
          turning_rate(sums, b, box.spacing(), box.dimension(), scale.speed),
          at_rest > 0 ? sums.value(b, weight) / at_rest - 1 : 0,
          largest_stretch};
}

}  // namespace

PetscErrorCode measure_surfaces(const Domain &domain, const std::vector<Phase> &phases,
                                const std::vector<SurfaceSample> &samples, const BodyOwners &owners,
                                const std::vector<Int3> &references, std::vector<SurfaceMeasure> *result) {
  PetscFunctionBeginUser;
  EventScope scope(Event::bodies);
  const int dim = domain.dimension();
  const Real3 &h = domain.spacing();
  const Units units(domain);
  std::vector<double> most;
  PetscCall(reduce_maxima(domain.comm(), {largest_of(samples, dim)}, &most));
  const Scales scale(most);
  BodySums sums(references.size(), all_sums);
  std::vector<double> stretch(references.size(), 1.0), largest_stretch;
  for (const SurfaceSample &s : samples) {
    const int b = owners.slot(s.label - 1);
    if (b < 0) continue;
    stretch[b] = std::max(stretch[b], s.stretch);
    add_sample(s, b, offset(domain, references[b], s.place), dim, units.face, scale, &sums);
  }
  for (const Phase &phase : phases) {
    if (!phase.material.is_membrane() || !phase.label) continue;
    const ConstView phi = phase.fraction[0], label = phase.label[0];
    for (const Segment &row : domain.rows()) {
      if (phase.rows.idle(row.j, row.k)) continue;
      const double *q = phi.row(row.j, row.k);
      for (int i = row.i_begin; i < row.i_end; ++i) {
        const int b = owners.slot(static_cast<int>(label(i, row.j, row.k)) - 1);
        if (b >= 0) sums.add(b, area, (dim == 2 ? area_of<2> : area_of<3>)(phi, q + i, h) / units.area);
      }
    }
  }
  PetscCall(sums.reduce(owners));
  const int owned = owners.owned().size();
  largest_stretch.assign(owned, 1.0);
  PetscCall(owners.reduce(1, MPI_MAX, stretch, &largest_stretch));
  result->assign(owned, {});
  for (int b = 0; b < owned; ++b) (*result)[b] = evaluate(domain, sums, b, scale, largest_stretch[b]);
  PetscFunctionReturn(0);
}

SurfaceMeasure measure_surface_in_box(const BodyInBox &body, const std::vector<SurfaceSample> &samples) {
  const Box &box = *body.box;
  const int dim = box.dimension();
  const Real3 &h = box.spacing();
  const Units units(box);
  const Scales scale(largest_of(samples, dim));
  const Int3 middle = body.phase->extent(box).middle();
  BodySums sums(1, all_sums);
  double stretch = 1;
  for (const SurfaceSample &s : samples) {
    Real3 x{};
    for (int d = 0; d < dim; ++d) x[d] = s.place[d] - middle[d];
    stretch = std::max(stretch, s.stretch);
    add_sample(s, 0, x, dim, units.face, scale, &sums);
  }
  const ConstView phi = body.phase->fraction[0];
  for (const Segment &whole : box.rows()) {
    const Segment row = body.phase->filled(whole);
    for (int i = row.i_begin; i < row.i_end; ++i)
      sums.add(0, area, (dim == 2 ? area_of<2> : area_of<3>)(phi, &phi(i, row.j, row.k), h) / units.area);
  }
  return evaluate(box, sums, 0, scale, stretch);
}

}  // namespace eulastic
