#include "boxes/receptors.hpp"

#include "base/philox.hpp"
#include "grid/linear.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

// phi and its gradient at a position, linear between centres. phi is 0 behind walls, so that the surface of a body that
// touches a wall lies on the wall.
struct Level {
  double phi = 0;
  Real3 slope{};
};

// Returns whether a cell lies behind a boundary of the domain.
bool is_behind_side(const Box &box, const Int3 &cell) {
  bool behind = false;
  for (int d = 0; d < box.dimension(); ++d)
    behind = behind || (box.is_wall(d) && (cell[d] < 0 || cell[d] >= box.domain_cells()[d]));
  return behind;
}

Level level_at(const Box &box, const Phase &phase, const Real3 &place) {
  const Layout &layout = box.layout();
  const ConstView phi = phase.fraction[0];
  LinearPoints points(box, at_centre, place.data());
  for (int d = 0; d < box.dimension(); ++d)
    points.keep_between(d, layout.begin[d] - layout.ghosts[d],
                        layout.begin[d] + layout.cells[d] + layout.ghosts[d] - 1);
  Level level;
  points.for_all([&](const LinearPoints::Point &point) {
    if (is_behind_side(box, point.at)) return;
    const Int3 &at = point.at, &begin = layout.begin;
    const double value = phi(at[0] - begin[0], at[1] - begin[1], at[2] - begin[2]);
    level.phi += point.weight * value;
    for (int d = 0; d < box.dimension(); ++d) level.slope[d] += point.slope[d] * value;
  });
  return level;
}

// Interpolates the velocity linearly between the faces of the box.
Real3 velocity_at(const Box &box, const Field &velocity, const Real3 &place) {
  const Int3 &begin = box.layout().begin;
  Real3 sum{};
  for (int a = 0; a < box.dimension(); ++a) {
    const ConstView v = velocity[a];
    LinearPoints points(box, at_face[a], place.data());
    for (int d = 0; d < box.dimension(); ++d)
      points.keep_between(d, begin[d] - box.touches_low(d), begin[d] + box.cells()[d] - 1 + box.touches_high(d));
    points.for_all([&](const LinearPoints::Point &point) {
      sum[a] += point.weight * v(point.at[0] - begin[0], point.at[1] - begin[1], point.at[2] - begin[2]);
    });
  }
  return sum;
}

// Returns the gradient of phi at the centre of the cell of a position, by differences over two cells; it is nonzero one
// cell farther from the surface than that of `level_at`.
Real3 wide_slope(const Box &box, const Phase &phase, const Real3 &place) {
  const Layout &layout = box.layout();
  const ConstView phi = phase.fraction[0];
  int cell[3]{};
  for (int d = 0; d < box.dimension(); ++d)
    cell[d] = std::clamp(static_cast<int>(std::floor(place[d] / box.spacing()[d])) - layout.begin[d],
                         1 - layout.ghosts[d], layout.cells[d] + layout.ghosts[d] - 2);
  Real3 slope{};
  for (int d = 0; d < box.dimension(); ++d) {
    int low[3]{cell[0], cell[1], cell[2]}, high[3]{cell[0], cell[1], cell[2]};
    --low[d];
    ++high[d];
    slope[d] = (phi(high[0], high[1], high[2]) - phi(low[0], low[1], low[2])) / (2 * box.spacing()[d]);
  }
  return slope;
}

double size_of(const Real3 &v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

double shortest_spacing(const Box &box) {
  return *std::min_element(box.spacing().begin(), box.spacing().begin() + box.dimension());
}

// Interpolates phi near the surface; its gradient is that over two cells where the nearest points have none.
Level surface_level_at(const Box &box, const Phase &phase, const Real3 &place) {
  Level level = level_at(box, phase, place);
  if (!(size_of(level.slope) * shortest_spacing(box) > 1e-3)) level.slope = wide_slope(box, phase, place);
  return level;
}

// Interpolates the velocity at a receptor from its attachment, moved by an offset.
Real3 velocity_of(const Box &box, const Field &velocity, const Attachment &attachment, const Real3 &offset) {
  Real3 sum{};
  for (const auto &[place, weight] : attachment) {
    const Real3 at{place[0] + offset[0], place[1] + offset[1], place[2] + offset[2]};
    const Real3 here = velocity_at(box, velocity, at);
    for (int d = 0; d < 3; ++d) sum[d] += weight * here[d];
  }
  return sum;
}

// Returns the area of the surface in a cell: |grad phi| integrated over it, by differences over two cells.
double area_in_cell(const BodyInBox &body, int i, int j, int k) {
  const ConstView phi = std::as_const(body.phase->fraction)[0];
  const Real3 &h = body.box->spacing();
  double squares = std::pow((phi(i + 1, j, k) - phi(i - 1, j, k)) / (2 * h[0]), 2) +
                   std::pow((phi(i, j + 1, k) - phi(i, j - 1, k)) / (2 * h[1]), 2);
  if (body.box->dimension() == 3) squares += std::pow((phi(i, j, k + 1) - phi(i, j, k - 1)) / (2 * h[2]), 2);
  return std::sqrt(squares) * h[0] * h[1] * (body.box->dimension() == 3 ? h[2] : 1);
}

}  // namespace

Real3 way_to_surface(const Box &box, const Phase &phase, const Real3 &place) {
  const Level level = surface_level_at(box, phase, place);
  const double shortest = shortest_spacing(box), steepness = size_of(level.slope);
  if (!(steepness * shortest > 1e-3)) return {};
  const double most = 0.25 * shortest, far = std::clamp((0.5 - level.phi) / steepness, -most, most);
  Real3 way{};
  for (int d = 0; d < box.dimension(); ++d) way[d] = far * level.slope[d] / steepness;
  return way;
}

// At smaller depths a part of the velocity is that of the fluid beside the body, with which receptors would slip.
Attachment attachment_of(const Box &box, const Phase &phase, const Real3 &place) {
  constexpr double near = 1, far = 2;  // cells below the surface
  const Material &material = phase.material;
  const Real3 slope = surface_level_at(box, phase, place).slope;
  const double steepness = size_of(slope);
  if (!material.elastic() || material.is_membrane() || !(steepness > 0)) return {{{{place, 1}}}, 1};
  Attachment attachment{{{{place, far / (far - near)}, {place, -near / (far - near)}}}, 2};
  const double cell = shortest_spacing(box) / steepness;
  for (int d = 0; d < box.dimension(); ++d) {
    attachment.points[0].place[d] += near * cell * slope[d];
    attachment.points[1].place[d] += far * cell * slope[d];
  }
  return attachment;
}

void place_receptors(const BodyInBox &body, double density, std::uint32_t seed, std::vector<Receptor> *receptors) {
  constexpr int approaches = 12;
  const Box &box = *body.box;
  const auto number = static_cast<std::uint32_t>(body.number);
  std::uint32_t cell = 0;
  for_points(box.rows(), [&](int i, int j, int k) {
    ++cell;
    const double wanted = density * area_in_cell(body, i, j, k);
    if (!(wanted > 0)) return;
    const auto random = [&](std::uint32_t which) { return uniform(philox({cell, number, which, 0}, {seed, 1})); };
    const int count = static_cast<int>(wanted + random(0));
    for (int n = 0; n < count; ++n) {
      Receptor receptor;
      const int at[3] = {i, j, k};
      for (int d = 0; d < 3; ++d) {
        const double within = d < box.dimension() ? random(1 + 3 * n + d) : 0.5;
        receptor.place[d] = (box.layout().begin[d] + at[d] + within) * box.spacing()[d];
      }
      for (int turn = 0; turn < approaches; ++turn) {
        const Real3 way = way_to_surface(box, *body.phase, receptor.place);
        for (int d = 0; d < 3; ++d) receptor.place[d] += way[d];
      }
      receptors->push_back(receptor);
    }
  });
}

void move_receptors(const Box &box, double dt, const Field &velocity, const Phase &phase,
                    std::vector<Receptor> *receptors) {
  for (Receptor &receptor : *receptors) {
    Real3 &place = receptor.place;
    const Attachment attachment = attachment_of(box, phase, place);
    Real3 half = velocity_of(box, velocity, attachment, {});
    for (double &way : half) way *= 0.5 * dt;
    const Real3 second = velocity_of(box, velocity, attachment, half);
    for (int d = 0; d < box.dimension(); ++d) {
      place[d] += dt * second[d];
      if (box.is_wall(d)) place[d] = std::clamp(place[d], 0.0, box.domain_shape().length[d]);
    }
    const Real3 way = way_to_surface(box, phase, place);
    for (int d = 0; d < 3; ++d) place[d] += way[d];
  }
}

}  // namespace eulastic
