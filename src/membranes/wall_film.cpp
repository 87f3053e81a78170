#include "membranes/wall_film.hpp"

#include "field/open_boundaries.hpp"
#include "grid/row_scratch.hpp"
#include "membranes/smooth_row.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

constexpr double full = 1 - 1e-12;  // solid fraction of a cell inside a wall

// Part of a face that a body covers, from phi on both sides: exact where the surface is parallel to the face, normal to
// it, or at 45 degrees.
double covered(double one, double other) {
  const double root_less = std::sqrt(std::min(one, other)),
               root_missing = std::sqrt(std::max(1 - std::max(one, other), 0.0));
  return root_less > 0 ? root_less / (root_less + root_missing) : 0;
}

// The function chi of the smoothed solid fraction of walls: 1 in the cells beside a flat wall, 0 in the next ones.
double nearness(double smoothed) { return std::clamp(4 * smoothed - 0.25, 0.0, 1.0); }

}  // namespace

void WallFilm::find(const Box &box, const BoundaryConditions &sides, const std::vector<ConstView> &rigid,
                    Field &scratch) {
  const Layout &layout = box.layout();
  const int dim = box.dimension(), reach = 1 + smooth_reach, layers_z = dim == 3 ? 1 : 0;
  const View solid = scratch[0], near = scratch[1];
  const auto behind_wall = [&](int d, int i) {
    const int global = layout.begin[d] + i;
    if (!box.is_wall(d) || (global >= 0 && global < box.domain_cells()[d])) return false;
    return is_solid(sides[d][global >= 0].kind);
  };
  const Int3 &n = box.cells();
  for (int k = -reach * layers_z; k < n[2] + reach * layers_z; ++k)
    for (int j = -reach; j < n[1] + reach; ++j)
      for (int i = -reach; i < n[0] + reach; ++i) {
        double sum = 0;
        for (const ConstView &phi : rigid) sum += phi(i, j, k);
        const bool wall = behind_wall(0, i) || behind_wall(1, j) || behind_wall(2, k);
        solid(i, j, k) = wall ? 1 : std::min(sum, 1.0);
      }
  RowScratch row(box, 1);
  for (int k = -layers_z; k < n[2] + layers_z; ++k)
    for (int j = -1; j < n[1] + 1; ++j) {
      smooth_row(dim, solid, j, k, -1, n[0] + 1, row.row(0), near.row(j, k));
      for (int i = -1; i < n[0] + 1; ++i) near(i, j, k) = nearness(near(i, j, k));
    }
  const Real3 &h = box.spacing();
  longest_spacing_ = *std::max_element(h.begin(), h.begin() + dim);
  cells_.clear();
  faces_.clear();
  for_points(box.rows(), [&](int i, int j, int k) {
    const double *centre = &near(i, j, k);
    const std::ptrdiff_t at = centre - near.origin;
    if (*centre > 0 && solid(i, j, k) < full) cells_.push_back({at, *centre});
    for (int a = 0; a < dim; ++a) {
      const std::ptrdiff_t s = near.stride(a);
      const bool on_side = box.is_wall(a) && layout.begin[a] + Int3{i, j, k}[a] == 0;
      if (on_side || centre[0] == centre[-s]) continue;
      const bool up = centre[0] > centre[-s];
      faces_.push_back({a, at, up ? at : at - s, up ? at - s : at, (centre[0] - centre[-s]) / box.spacing()[a]});
    }
  });
}

// Force per volume on a face, (27b).
double WallFilm::force_on(const Face &face, double pressure, const double *phi) {
  const double beside = phi[face.near];
  return -pressure * beside * (covered(beside, phi[face.far]) - 0.5 * beside) * face.towards;
}

// The pressure P, as stiff as the time step of the membrane permits.
double WallFilm::pressure_of(const Phase &phase) const {
  return phase.material.membrane.largest_modulus() / longest_spacing_;
}

void WallFilm::add_force(const Phase &phase, Field &force) const {
  const double *phi = phase.fraction[0].origin, pressure = pressure_of(phase);
  for (const Face &face : faces_)
    if (phi[face.near] > 0) force[face.component].origin[face.at] += force_on(face, pressure, phi);
}

void WallFilm::add_power(const Phase &phase, const Field &velocity, int which, ExactSums *sums) const {
  const double *phi = phase.fraction[0].origin, pressure = pressure_of(phase);
  for (const Face &face : faces_)
    if (phi[face.near] > 0) sums->add(which, -velocity[face.component].origin[face.at] * force_on(face, pressure, phi));
}

void WallFilm::add_energy(const Phase &phase, int which, ExactSums *sums) const {
  const double *phi = phase.fraction[0].origin, pressure = pressure_of(phase);
  for (const Cell &cell : cells_)
    if (phi[cell.at] > 0) sums->add(which, 0.5 * pressure * cell.nearness * (phi[cell.at] * phi[cell.at]));
}

}  // namespace eulastic
