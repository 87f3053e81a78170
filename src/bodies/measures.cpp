#include "bodies/measures.hpp"

#include "base/events.hpp"
#include "bodies/body_sums.hpp"
#include "bodies/unwrap.hpp"
#include "field/exact_sum.hpp"
#include "field/sides.hpp"
#include "grid/threads.hpp"
#include "kernels/stencils.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

constexpr double degrees = 180 / 3.14159265358979323846;
// Order of the sums of one body; second moments xx, yy, zz, yz, xz, xy.
constexpr int first_moment = 1, second_moment = 4, momentum = 10, strain = 13, full_cells = 14, mean_tensor = 15;
constexpr int on_open_side = 21, all_sums = 22, position_sums = 4;
constexpr int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
constexpr double full_cell = 0.999;

// Calls visit(phase, slot of the body, phi, i, j, k) for every cell of a part with a label.
template <class Visit>
void for_each_cell(const Grid &grid, const RowPart &part, const std::vector<Phase> &phases, const BodyOwners &owners,
                   Visit &&visit) {
  for (const Phase &phase : phases) {
    const ConstView fraction = phase.fraction[0], label = phase.label[0];
    for (const Segment &whole : part.rows(grid)) {
      const Segment row = phase.rows.within(whole, label);
      for (int i = row.i_begin; i < row.i_end; ++i) {
        const int slot = owners.slot(static_cast<int>(label(i, row.j, row.k)) - 1);
        if (slot >= 0) visit(phase, slot, fraction(i, row.j, row.k), i, row.j, row.k);
      }
    }
  }
}

// Whether an owned cell is at a side that bodies flow out through.
bool is_at_open_side(const Grid &grid, const Int3 &cell) {
  for (int d = 0; d < grid.dimension(); ++d) {
    const int global = cell[d] + grid.layout().begin[d];
    if ((global == 0 && grid.is_open(d, false)) || (global == grid.cells()[d] - 1 && grid.is_open(d, true)))
      return true;
  }
  return false;
}

// Calls visit(slot of the body, phi W, tr B or 0 where phi < 1/2) for every cell of a part with a label.
template <class Visit>
void for_each_strain(const Grid &grid, const RowPart &part, const std::vector<Phase> &phases, const BodyOwners &owners,
                     const RowEnergy &energy, Visit &&visit) {
  std::vector<double> density(grid.owned()[0]);
  for (const Phase &phase : phases) {
    const ConstView fraction = phase.fraction[0], label = phase.label[0], xx = phase.tensor[0], yy = phase.tensor[1],
                    zz = phase.tensor[grid.dimension() == 3 ? 2 : 0];
    for (const Segment &whole : part.rows(grid)) {
      const Segment row = phase.rows.within(whole, label);
      energy(grid, phase, row, density.data());
      for (int i = row.i_begin; i < row.i_end; ++i) {
        const int slot = owners.slot(static_cast<int>(label(i, row.j, row.k)) - 1);
        if (slot < 0) continue;
        const double out_of_plane = grid.dimension() == 3 ? zz(i, row.j, row.k) : 1;
        const double trace = xx(i, row.j, row.k) + yy(i, row.j, row.k) + out_of_plane;
        visit(slot, density[i], fraction(i, row.j, row.k) >= 0.5 ? trace : 0);
      }
    }
  }
}

// Sums of owned bodies, of what add(part, sums) adds in every part of the owned rows to those that are here.
// Collective.
template <class Add>
PetscErrorCode sum_bodies(const Grid &grid, const BodyOwners &owners, const Add &add, BodySums *sums) {
  PetscFunctionBeginUser;
  const int parts = row_parts(grid);
  std::vector<BodySums> others(parts - 1, *sums);
  in_parallel(parts, parts, [&](int part) { add(row_part(grid, part, parts), part == 0 ? *sums : others[part - 1]); });
  for (const BodySums &some : others) sums->add(some);
  PetscCall(sums->reduce(owners));
  PetscFunctionReturn(0);
}

// Eigenvalues of the symmetric matrix xx, yy, zz, yz, xz, xy, descending, by cyclic Jacobi rotations.
Real3 eigenvalues(const std::array<double, 6> &m) {
  double a[3][3] = {{m[0], m[5], m[4]}, {m[5], m[1], m[3]}, {m[4], m[3], m[2]}};
  for (int sweep = 0; sweep < 30; ++sweep)
    for (int p = 0; p < 2; ++p)
      for (int q = p + 1; q < 3; ++q) {
        if (a[p][q] == 0) continue;
        const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double t = std::copysign(1.0, theta) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c, apq = a[p][q];
        const int r = 3 - p - q;
        const double arp = a[r][p], arq = a[r][q];
        a[p][p] -= t * apq;
        a[q][q] += t * apq;
        a[p][q] = a[q][p] = 0;
        a[r][p] = a[p][r] = c * arp - s * arq;
        a[r][q] = a[q][r] = s * arp + c * arq;
      }
  Real3 values{a[0][0], a[1][1], a[2][2]};
  std::sort(values.begin(), values.end(), [](double x, double y) { return x > y; });
  return values;
}

// Of the ellipsoid (ellipse) with these central second moments per volume, longest first.
Real3 semi_axes(const std::array<double, 6> &moments, int dimension) {
  Real3 squares = eigenvalues(moments);
  if (dimension == 2) {  // the xy block alone
    const double mean = (moments[0] + moments[1]) / 2, half = (moments[0] - moments[1]) / 2;
    const double radius = std::sqrt(half * half + moments[5] * moments[5]);
    squares = {mean + radius, mean - radius, 0};
  }
  Real3 axes{};
  for (int d = 0; d < dimension; ++d) axes[d] = std::sqrt((dimension + 2) * std::max(squares[d], 0.0));
  return axes;
}

double taylor_deformation(const Real3 &axes, int dimension) {
  const double a = axes[0], c = axes[dimension - 1];
  return a + c > 0 ? (a - c) / (a + c) : 0;
}

// What stretch B = V V makes of moments M, undone: V^-1 M V^-1 has the eigenvalues of K^-1 M K^-T, B = K K^T
// (Cholesky).
std::array<double, 6> undo_stretch(const std::array<double, 6> &moments, const std::array<double, 6> &B) {
  double K[3][3] = {}, M[3][3];
  for (int c = 0; c < 6; ++c) {
    const auto [p, q] = pairs[c];
    M[p][q] = M[q][p] = moments[c];
    K[q][p] = B[c];  // below the diagonal
  }
  for (int p = 0; p < 3; ++p)
    for (int q = p; q < 3; ++q) {
      for (int m = 0; m < p; ++m) K[q][p] -= K[q][m] * K[p][m];
      K[q][p] = p == q ? std::sqrt(K[p][p]) : K[q][p] / K[p][p];
    }
  for (const bool rows : {true, false})  // K^-1 from the left, then from the right
    for (int q = 0; q < 3; ++q)
      for (int p = 0; p < 3; ++p) {
        const auto at = [&](int n) -> double & { return rows ? M[n][q] : M[q][n]; };
        for (int m = 0; m < p; ++m) at(p) -= K[p][m] * at(m);
        at(p) /= K[p][p];
      }
  std::array<double, 6> undone;
  for (int c = 0; c < 6; ++c) undone[c] = M[pairs[c][0]][pairs[c][1]];
  return undone;
}

// Lengths, deformations and inclination from central second moments per volume and the mean of B.
void set_lengths(const std::array<double, 6> &moments, const std::array<double, 6> &B, int dimension,
                 BodyMeasure *body) {
  body->semi_axes = semi_axes(moments, dimension);
  body->taylor_deformation = taylor_deformation(body->semi_axes, dimension);
  body->rest_deformation = taylor_deformation(semi_axes(undo_stretch(moments, B), dimension), dimension);
  const double angle = std::atan2(2 * moments[5], moments[0] - moments[1]) / 2 * degrees;
  body->inclination = angle > -90 ? angle : 90;
}

// Scales of the fixed-point numbers, and the largest tr B of every owned body.
struct Largest {
  double speed = 0, energy = 0;
  std::vector<double> trace;
};

BodyMeasure evaluate(const Grid &grid, const BodySums &sums, int b, const Int3 &reference, const Largest &largest) {
  BodyMeasure body;
  const Real3 &h = grid.spacing();
  const double cells = sums.value(b, 0);
  body.volume = cells * grid.cell_volume();
  body.leaves = grid.any_open() && (body.volume == 0 || sums.value(b, on_open_side) > 0);
  Real3 mean{};
  for (int d = 0; d < 3; ++d) {
    mean[d] = cells > 0 ? sums.value(b, first_moment + d) / cells : 0;
    body.centroid[d] = (reference[d] + 0.5 + mean[d]) * h[d];
    body.velocity[d] = cells > 0 ? sums.value(b, momentum + d) / cells * largest.speed : 0;
  }
  body.elastic_energy = sums.value(b, strain) * largest.energy * grid.cell_volume();
  body.trace_max = std::max(largest.trace[b], 3.0);  // det B = 1
  if (!(cells > 0)) return body;
  std::array<double, 6> moments{}, B{1, 1, 1, 0, 0, 0};
  const double full = sums.value(b, full_cells);
  for (int c = 0; c < 6; ++c) {
    const int p = pairs[c][0], q = pairs[c][1];
    if (std::max(p, q) >= grid.dimension()) continue;
    if (full > 0) B[c] = sums.value(b, mean_tensor + c) / full;
    const double central = sums.value(b, second_moment + c) / cells - mean[p] * mean[q];
    moments[c] = (central - (p == q ? 1.0 / 12 : 0.0)) * h[p] * h[q];
  }
  set_lengths(moments, B, grid.dimension(), &body);
  return body;
}

}  // namespace

PetscErrorCode BodyTracker::follow(const Grid &grid, const std::vector<Phase> &phases) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::bodies);
  BodyOwners owners;
  std::vector<Int3> references;
  PetscCall(connect(grid, phases, {}, &owners, &references));
  BodySums sums(references.size(), position_sums);
  const auto add = [&](const RowPart &part, BodySums &some) {
    for_each_cell(grid, part, phases, owners, [&](const Phase &, int b, double phi, int i, int j, int k) {
      const Real3 x = offset(grid, references[b], {i, j, k});
      some.add(b, 0, phi);
      for (int d = 0; d < grid.dimension(); ++d) some.add(b, first_moment + d, phi * x[d]);
    });
  };
  PetscCall(sum_bodies(grid, owners, add, &sums));
  for (int b = 0; b < owners.owned().size(); ++b)
    for (int d = 0; d < grid.dimension(); ++d) {
      const double mean = sums.value(b, 0) > 0 ? sums.value(b, first_moment + d) / sums.value(b, 0) : 0;
      // A body that fills a periodic direction has a mean of -1/2 there and must stay.
      if (std::abs(mean) > 0.75 && std::abs(mean) < 0x1p20) references_[b][d] += static_cast<int>(std::lround(mean));
    }
  PetscFunctionReturn(0);
}

PetscErrorCode BodyTracker::measure(const Grid &grid, const std::vector<Phase> &phases, const FieldBlock &velocity,
                                    const RowEnergy &energy, std::vector<BodyMeasure> *result) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::bodies);
  const int dimension = grid.dimension();
  const auto centred = [&](int d, int i, int j, int k) {
    const double *face = &velocity[d](i, j, k);
    return (face[0] + face[velocity[d].stride(d)]) / 2;
  };
  BodyOwners owners;
  std::vector<Int3> references;
  PetscCall(connect(grid, phases, {}, &owners, &references));
  // Speed and energy density of all, tr B of every body.
  std::vector<std::vector<double>> found(row_parts(grid), std::vector<double>(2, 0.0));
  std::vector<std::vector<double>> traces(found.size(), std::vector<double>(references.size(), 0.0));
  in_row_parts(grid, [&](const RowPart &part) {
    std::vector<double> &some = found[part.number], &trace_of = traces[part.number];
    for_each_cell(grid, part, phases, owners, [&](const Phase &, int, double, int i, int j, int k) {
      for (int d = 0; d < dimension; ++d) some[0] = std::max(some[0], std::abs(centred(d, i, j, k)));
    });
    for_each_strain(grid, part, phases, owners, energy, [&](int b, double density, double trace) {
      some[1] = std::max(some[1], std::abs(density));
      trace_of[b] = std::max(trace_of[b], trace);
    });
  });
  std::vector<double> most;
  PetscCall(reduce_maxima(grid.comm(), found, &most));
  Largest largest{most[0], most[1], std::vector<double>(static_cast<std::size_t>(owners.owned().size()), 0.0)};
  for (const std::vector<double> &some : traces)
    for (std::size_t b = 0; b < some.size(); ++b) traces[0][b] = std::max(traces[0][b], some[b]);
  PetscCall(owners.reduce(1, MPI_MAX, traces[0], &largest.trace));
  const bool opens = grid.any_open();
  BodySums sums(references.size(), all_sums);
  const auto add = [&](const RowPart &part, BodySums &some) {
    for_each_cell(grid, part, phases, owners, [&](const Phase &phase, int b, double phi, int i, int j, int k) {
      const Real3 x = offset(grid, references[b], {i, j, k});
      some.add(b, 0, phi);
      for (int d = 0; d < dimension; ++d) {
        some.add(b, first_moment + d, phi * x[d]);
        some.add(b, second_moment + d, phi * x[d] * x[d]);
        if (largest.speed > 0) some.add(b, momentum + d, phi * (centred(d, i, j, k) / largest.speed));
      }
      some.add(b, second_moment + 3, phi * x[1] * x[2]);
      some.add(b, second_moment + 4, phi * x[0] * x[2]);
      some.add(b, second_moment + 5, phi * x[0] * x[1]);
      if (opens && is_at_open_side(grid, {i, j, k})) some.add(b, on_open_side, phi);
      if (!(phi > full_cell) || phase.material.is_membrane()) return;  // B_s says nothing of the inside
      some.add(b, full_cells, 1);
      for (int f = 0; f < phase.tensor.count(); ++f) {
        const auto [p, q] = tensor_components(dimension)[f];
        const ConstView B = phase.tensor[f];
        const double value = p == q ? B(i, j, k) : kernels::average4(&B(i, j, k), B.stride(p), B.stride(q));
        some.add(b, mean_tensor + (p == q ? p : 6 - p - q), value);
      }
    });
    for_each_strain(grid, part, phases, owners, energy, [&](int b, double density, double) {
      if (largest.energy > 0) some.add(b, strain, density / largest.energy);
    });
  };
  PetscCall(sum_bodies(grid, owners, add, &sums));
  result->clear();
  for (int b = 0; b < owners.owned().size(); ++b) {
    result->push_back(evaluate(grid, sums, b, references_[b], largest));
    result->back().label = owners.owned().begin + b + 1;
    result->back().species = species_[result->back().label - 1];
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
