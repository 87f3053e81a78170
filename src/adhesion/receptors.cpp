#include "adhesion/receptors.hpp"

#include "base/philox.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

// phi and its gradient at a place, linear between centres. Behind walls there is nothing of the body: where it touches
// one its surface is the wall.
struct Level {
  double phi = 0;
  Real3 slope{};
};

// Whether a cell of a box lies outside of the domain.
bool is_behind_side(const Box &box, const Int3 &cell) {
  bool behind = false;
  for (int d = 0; d < box.dimension(); ++d) {
    const int at = box.layout().begin[d] + cell[d];
    behind = behind || (box.is_wall(d) && (at < 0 || at >= box.domain_cells()[d]));
  }
  return behind;
}

Level level_at(const BodyInBox &body, const double place[3]) {
  const Box &box = *body.box;
  const Layout &layout = box.layout();
  const int dimension = box.dimension();
  const ConstView phi = std::as_const(body.phase->fraction)[0];
  int first[3]{};
  double part[3]{};
  for (int d = 0; d < dimension; ++d) {
    const double at = place[d] / box.spacing()[d] - 0.5 - layout.begin[d], low = std::floor(at);
    first[d] = std::clamp(static_cast<int>(low), -layout.ghosts[d], layout.cells[d] + layout.ghosts[d] - 2);
    part[d] = std::clamp(at - first[d], 0.0, 1.0);
  }
  Level level;
  for (int corner = 0; corner < (dimension == 3 ? 8 : 4); ++corner) {
    int step[3]{};
    double weight[3]{1, 1, 1}, all = 1;
    for (int d = 0; d < dimension; ++d) {
      step[d] = corner >> d & 1;
      weight[d] = step[d] ? part[d] : 1 - part[d];
      all *= weight[d];
    }
    const double value = is_behind_side(box, {first[0] + step[0], first[1] + step[1], first[2] + step[2]})
                             ? 0
                             : phi(first[0] + step[0], first[1] + step[1], first[2] + step[2]);
    level.phi += all * value;
    for (int d = 0; d < dimension; ++d) {
      double across = (step[d] ? 1 : -1) / box.spacing()[d];
      for (int e = 0; e < dimension; ++e)
        if (e != d) across *= weight[e];
      level.slope[d] += across * value;
    }
  }
  return level;
}

// The gradient of phi at the centre of the cell of a place, by differences over two cells: it sees the surface from a
// cell farther away than `level_at`.
Real3 wide_slope(const BodyInBox &body, const double place[3]) {
  const Box &box = *body.box;
  const Layout &layout = box.layout();
  const ConstView phi = std::as_const(body.phase->fraction)[0];
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

double density_of(const AdhesionSpec &spec, int species) {
  double density = 0;
  for (const AdhesionPair &pair : spec.pairs)
    if (pair.has(species)) density = std::max(density, pair.density);
  return density;
}

// Area of the surface in a cell: |grad phi| integrated over it, by differences of phi over two cells.
double area_in_cell(const BodyInBox &body, int i, int j, int k) {
  const ConstView phi = std::as_const(body.phase->fraction)[0];
  const Real3 &h = body.box->spacing();
  double squares = std::pow((phi(i + 1, j, k) - phi(i - 1, j, k)) / (2 * h[0]), 2) +
                   std::pow((phi(i, j + 1, k) - phi(i, j - 1, k)) / (2 * h[1]), 2);
  if (body.box->dimension() == 3) squares += std::pow((phi(i, j, k + 1) - phi(i, j, k - 1)) / (2 * h[2]), 2);
  return std::sqrt(squares) * h[0] * h[1] * (body.box->dimension() == 3 ? h[2] : 1);
}

void place_on(const AdhesionSpec &spec, const BodyInBox &body, std::vector<Receptor> *receptors) {
  const Box &box = *body.box;
  const Layout &layout = box.layout();
  const double density = density_of(spec, body.species);
  if (!(density > 0)) return;
  const auto number = static_cast<std::uint32_t>(body.number), seed = static_cast<std::uint32_t>(spec.seed);
  std::uint32_t cell = 0;
  for_points(box.rows(), [&](int i, int j, int k) {
    ++cell;
    const double wanted = density * area_in_cell(body, i, j, k);
    if (!(wanted > 0)) return;
    const auto random = [&](std::uint32_t which) { return uniform(philox({cell, number, which, 0}, {seed, 1})); };
    const int count = static_cast<int>(wanted + random(0));
    for (int n = 0; n < count; ++n) {
      Receptor receptor{double(body.number), double(body.species), {}};
      const int at[3] = {i, j, k};
      for (int d = 0; d < 3; ++d) {
        const double within = d < box.dimension() ? random(1 + 3 * n + d) : 0.5;
        receptor.place[d] = (layout.begin[d] + at[d] + within) * box.spacing()[d];
      }
      for (int turn = 0; turn < 12; ++turn) {
        const Real3 way = way_to_surface(body, receptor.place);
        for (int d = 0; d < 3; ++d) receptor.place[d] += way[d];
      }
      receptors->push_back(receptor);
    }
  });
}

}  // namespace

Real3 way_to_surface(const BodyInBox &body, const double place[3]) {
  Level level = level_at(body, place);
  const Real3 &h = body.box->spacing();
  const double shortest = *std::min_element(h.begin(), h.begin() + body.box->dimension());
  const auto size_of = [](const Real3 &v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); };
  if (!(size_of(level.slope) * shortest > 1e-3)) level.slope = wide_slope(body, place);
  const double steepness = size_of(level.slope);
  if (!(steepness * shortest > 1e-3)) return {};
  const double most = 0.25 * shortest, far = std::clamp((0.5 - level.phi) / steepness, -most, most);
  Real3 way{};
  for (int d = 0; d < body.box->dimension(); ++d) way[d] = far * level.slope[d] / steepness;
  return way;
}

PetscErrorCode place_receptors(const AdhesionSpec &spec, const Domain &domain, const std::vector<BodyInBox> &bodies,
                               std::vector<Receptor> *receptors) {
  constexpr int numbers = sizeof(Receptor) / sizeof(double);
  std::vector<Receptor> own;
  std::vector<int> counts(domain.ranks()), starts(domain.ranks());
  PetscFunctionBeginUser;
  for (const BodyInBox &body : bodies) place_on(spec, body, &own);
  int count, all = 0;
  PetscCall(PetscIntCast(static_cast<PetscInt64>(own.size()) * numbers, &count));
  PetscCallMPI(MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, domain.comm()));
  for (int r = 0; r < domain.ranks(); ++r) starts[r] = std::exchange(all, all + counts[r]);
  receptors->resize(static_cast<std::size_t>(all) / numbers);
  PetscCallMPI(MPI_Allgatherv(own.data(), count, MPI_DOUBLE, receptors->data(), counts.data(), starts.data(),
                              MPI_DOUBLE, domain.comm()));
  std::stable_sort(receptors->begin(), receptors->end(),
                   [](const Receptor &one, const Receptor &other) { return one.body < other.body; });
  PetscFunctionReturn(0);
}

}  // namespace eulastic
