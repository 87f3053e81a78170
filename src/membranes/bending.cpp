#include "membranes/bending.hpp"

#include "field/boundaries.hpp"
#include "grid/row_scratch.hpp"
#include "grid/threads.hpp"
#include "kernels/bending.hpp"
#include "membranes/smooth_row.hpp"

#include <algorithm>

namespace eulastic {
namespace {

constexpr double negligible = 1e-3;  // of the smoothed fraction psi and of 1 - psi
// Ghost layers: the force needs curvatures in one more layer, and these need the level in a further one.
constexpr int force_ghosts = 0, curvature_ghosts = 1, level_ghosts = 2, mean_ghosts = 1;
constexpr double least_radius = 2;  // radius of curvature, in cells

// Strides and inverse spacings of differences, and the largest curvature.
struct Differences {
  std::ptrdiff_t stride[3];
  double inverse[3], largest_curvature;
  Differences(const Box &box, ConstView q) {
    const Real3 &h = box.spacing();
    double longest = 0;
    for (int d = 0; d < 3; ++d) {
      stride[d] = q.stride(d);
      inverse[d] = 1 / h[d];
      if (d < box.dimension()) longest = std::max(longest, h[d]);
    }
    largest_curvature = 1 / (least_radius * longest);
  }
};

EULASTIC_CLONES void level_row(const double *psi, int begin, int end, double *level) {
#pragma omp simd
  for (int i = begin; i < end; ++i) level[i] = kernels::surface_level(psi[i]);
}

struct ForceRows {
  const double *psi, *force, *weight, *delta;
};
EULASTIC_CLONES void force_of_row(const ForceRows &rows, std::ptrdiff_t s, double factor, int n, double *out) {
  const double *psi = rows.psi, *force = rows.force, *weight = rows.weight, *delta = rows.delta;
#pragma omp simd
  for (int i = 0; i < n; ++i) {
    const double f = factor * ((force[i] + force[i - s]) / (weight[i] + weight[i - s])) * (psi[i - s] - psi[i]);
    out[i] = delta[i] > 0 && delta[i - s] > 0 ? f : 0;
  }
}

// Whether one of the rows up to `across` rows and `layers_z` planes away is not idle.
bool any_row_near(const OccupiedRows &rows, int j, int k, int across, int layers_z) {
  for (int m = -layers_z; m <= layers_z; ++m)
    for (int o = -across; o <= across; ++o)
      if (!rows.idle(j + o, k + m)) return true;
  return false;
}

}  // namespace

// The cells of this rank with `ghosts` layers around them, also behind walls.
MembraneBending::CellBlock MembraneBending::block_around(const Phase &phase, int ghosts) const {
  CellBlock box;
  for (int d = 0; d < 3; ++d) {
    const bool alone = phase.rows.inside() && !(d == 0 && place_.box->wraps_x());
    const int near = d < place_.box->dimension() && !alone ? ghosts : 0;
    box.range[d] = {-near, place_.box->cells()[d] + near};
  }
  return box;
}

template <int Dim>
void MembraneBending::find_curvature(const Phase &phase, Field &fields) {
  const Differences local(*place_.box, fields[smoothed]);
  const View psi = fields[smoothed];
  const CellBlock box = block_around(phase, curvature_ghosts), forced = block_around(phase, force_ghosts);
  cells_.clear();
  for (int k = box.range[2].begin; k < box.range[2].end; ++k)
    for (int j = box.range[1].begin; j < box.range[1].end; ++j) {
      const OccupiedRows::Span s = phase.rows.span(j, k);
      const double *row = psi.row(j, k);
      for (int i = std::max(s.begin, box.range[0].begin); i < std::min(s.end, box.range[0].end); ++i)
        if (row[i] > negligible && row[i] < 1 - negligible)
          cells_.push_back({row + i - psi.origin, forced.holds({i, j, k})});
    }
  const kernels::Membrane &membrane = phase.material.membrane;
  const double *level_of = fields[level].origin;
  double *curvature_of = fields[curvature].origin, *delta_of = fields[delta].origin, *force_of = fields[force].origin;
  const int parts = row_parts(*place_.box);
  in_parallel(parts, parts, [&](int part) {
    const Piece piece(cells_.size(), part, parts);
    for (std::size_t c = piece.begin; c < piece.end; ++c) {
      const std::ptrdiff_t at = cells_[c].at;
      double square = 0;
      for (int d = 0; d < Dim; ++d) {
        const double *p = psi.origin + at, g = 0.5 * local.inverse[d] * (p[local.stride[d]] - p[-local.stride[d]]);
        square += g * g;
      }
      const kernels::Curvatures found =
          kernels::surface_curvatures<Dim>(level_of + at, local.stride, local.inverse, local.largest_curvature);
      curvature_of[at] = found.sum;
      delta_of[at] = __builtin_sqrt(square);
      force_of[at] = delta_of[at] * kernels::bending_pressure(found, membrane.spontaneous_curvature);
    }
  });
}

// Computes E_b (div(delta P grad kappa) + delta ...) in cells whose faces all have a flux; (27).
template <int Dim>
void MembraneBending::find_force(const Phase &phase, Field &fields) {
  const Differences local(*place_.box, fields[smoothed]);
  const double *level_of = fields[level].origin, *curvature_of = fields[curvature].origin,
               *delta_of = fields[delta].origin;
  double *force_of = fields[force].origin;
  const double modulus = phase.material.membrane.bending_modulus;
  const int parts = row_parts(*place_.box);
  in_parallel(parts, parts, [&](int part) {
    const Piece piece(cells_.size(), part, parts);
    for (std::size_t c = piece.begin; c < piece.end; ++c) {
      const std::ptrdiff_t at = cells_[c].at;
      if (!cells_[c].forced) continue;
      double sum = 0;
      for (int a = 0; a < Dim; ++a) {
        const auto flux = [&](std::ptrdiff_t o) {
          return kernels::curvature_flux<Dim>(level_of + o, curvature_of + o, delta_of + o, a, local.stride,
                                              local.inverse);
        };
        sum += local.inverse[a] * (flux(at + local.stride[a]) - flux(at));
      }
      force_of[at] = modulus * (sum + force_of[at]);
    }
  });
}

// Averages force and delta like phi, because noise of the curvature at waves as short as cells would drive a flow
// forever.
PetscErrorCode MembraneBending::smooth_force(const Phase &phase, Field &fields) {
  PetscFunctionBeginUser;
  const int far = mean_ghosts + smooth_reach, dim = place_.box->dimension();
  Field both = fields.part(delta, 2);
  PetscCall(place_.exchange_ghosts(both, far, &phase.rows));
  for (const int f : {delta, force}) fill_wall_ghosts_even(*place_.box, at_centre, fields[f], far, &phase.rows);
  const Int3 &n = place_.box->cells();
  const int layers_z = dim == 3 ? mean_ghosts : 0, rows = n[1] + 2 * mean_ghosts, planes = n[2] + 2 * layers_z;
  const int parts = row_parts(*place_.box);
  in_parallel(parts, parts, [&](int part) {
    RowScratch scratch(*place_.box, 1);
    const Piece piece(std::size_t(rows) * planes, part, parts);
    for (std::size_t r = piece.begin; r < piece.end; ++r) {
      const int j = static_cast<int>(r % rows) - mean_ghosts, k = static_cast<int>(r / rows) - layers_z;
      if (!any_row_near(phase.rows, j, k, 1, layers_z)) continue;
      for (const auto &[from, to] : {std::pair{force, mean}, {delta, weight}})
        smooth_row(dim, fields[from], j, k, -mean_ghosts, n[0] + mean_ghosts, scratch.row(0), fields[to].row(j, k));
    }
  });
  PetscFunctionReturn(0);
}

PetscErrorCode MembraneBending::find(const Phase &phase, ConstView smooth, Field &fields) {
  PetscFunctionBeginUser;
  const int dim = place_.box->dimension();
  const CellBlock box = block_around(phase, level_ghosts);
  for (const int f : {delta, force}) clear_near_rows(*place_.box, phase.rows, mean_ghosts + smooth_reach, fields[f]);
  const int rows = box.range[1].end - box.range[1].begin, planes = box.range[2].end - box.range[2].begin;
  const int parts = row_parts(*place_.box);
  in_parallel(parts, parts, [&](int part) {
    RowScratch scratch(*place_.box, 1);
    const Piece piece(std::size_t(rows) * planes, part, parts);
    for (std::size_t r = piece.begin; r < piece.end; ++r) {
      const int j = box.range[1].begin + static_cast<int>(r % rows),
                k = box.range[2].begin + static_cast<int>(r / rows);
      const OccupiedRows::Span s = phase.rows.span(j, k);
      const int begin = std::max(s.begin, box.range[0].begin), end = std::min(s.end, box.range[0].end);
      if (begin >= end) continue;
      smooth_row(dim, smooth, j, k, begin, end, scratch.row(0), fields[smoothed].row(j, k));
      level_row(fields[smoothed].row(j, k), begin, end, fields[level].row(j, k));
    }
  });
  if (dim == 2) {
    find_curvature<2>(phase, fields);
    find_force<2>(phase, fields);
  } else {
    find_curvature<3>(phase, fields);
    find_force<3>(phase, fields);
  }
  PetscCall(smooth_force(phase, fields));
  PetscFunctionReturn(0);
}

void MembraneBending::force_row(const Field &fields, int a, int j, int k, double *out) const {
  const ForceRows rows{fields[smoothed].row(j, k), fields[mean].row(j, k), fields[weight].row(j, k),
                       fields[delta].row(j, k)};
  force_of_row(rows, fields[smoothed].stride(a), 1 / place_.box->spacing()[a], place_.box->cells()[0], out);
}

double MembraneBending::energy(const Material &material, const Field &fields, std::ptrdiff_t at) {
  if (!(fields[delta].origin[at] > 0)) return 0;
  const double k = fields[curvature].origin[at] - material.membrane.spontaneous_curvature;
  return 0.5 * material.membrane.bending_modulus * (k * k);
}

}  // namespace eulastic
