#include "bodies/stretch_force.hpp"

#include "bodies/body_sums.hpp"
#include "bodies/unwrap.hpp"
#include "field/exact_sum.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

constexpr int bins_per_cell = 4, margin = 6;  // cells: surfaces lie up to five beside the cells that know them

// The surface of every body by its x: what a point has is split between the two bins that it lies between.
class Bins {
public:
  Bins(const Grid &grid, const std::vector<Int3> &references)
      : grid_(grid),
        near_(within_box(grid, references)),
        count_((grid.cells()[0] + 2 * margin) * bins_per_cell + 1),
        sums_(static_cast<int>(references.size()), count_),
        face_(*std::min_element(grid.spacing().begin(), grid.spacing().begin() + grid.dimension())) {}

  struct Place {
    int body, bin;
    double above;  ///< the share of the next bin
  };
  /// Whether the sample is pulled, and where it lies.
  bool find(const SurfaceSample &s, Place *place) const {
    const int b = s.label - 1;
    if (b < 0 || b >= static_cast<int>(near_.size()) || !(s.material->stretch_force.force > 0)) return false;
    const double low = grid_.is_wall(0) ? -near_[b][0] : -(grid_.cells()[0] / 2);
    const double x = (offset(grid_, near_[b], s.place)[0] - low + s.surface_x + margin) * bins_per_cell;
    const double at = std::clamp(x, 0.0, double(count_ - 2));  // NaN: of a run that has gone wrong
    *place = {b, at >= 0 ? static_cast<int>(at) : 0, 0};
    place->above = at - place->bin;
    return true;
  }
  double weight(const SurfaceSample &s) const { return s.spread * face_; }
  void add(const SurfaceSample &s) {
    Place at;
    if (!find(s, &at)) return;
    sums_.add(at.body, at.bin, weight(s) * (1 - at.above));
    sums_.add(at.body, at.bin + 1, weight(s) * at.above);
  }
  PetscErrorCode reduce(MPI_Comm comm) { return sums_.reduce(comm); }

  /// 1 in the bins of the last part of the surface, -1 in those of the first, less in those where they end; per part
  /// of the surface that is pulled.
  std::vector<double> pull(int body, double part) const {
    double all = 0;
    for (int i = 0; i < count_; ++i) all += sums_.value(body, i);
    const double target = part * all;
    std::vector<double> pull(count_, 0.0);
    for (const double sign : {1.0, -1.0}) {
      double left = target;
      for (int n = 0; n < count_ && left > 0; ++n) {
        const int i = sign > 0 ? count_ - 1 - n : n;
        const double here = sums_.value(body, i), taken = std::min(here, left);
        pull[i] += here != 0 ? sign * (taken / here) / target : 0;
        left -= taken;
      }
    }
    return pull;
  }

private:
  const Grid &grid_;
  std::vector<Int3> near_;
  int count_;
  BodySums sums_;
  double face_;
};

}  // namespace

bool bodies_are_stretched(const std::vector<Phase> &phases) {
  return std::any_of(phases.begin(), phases.end(),
                     [](const Phase &phase) { return phase.material.stretch_force.force > 0; });
}

PetscErrorCode find_stretch_forces(const Grid &grid, const std::vector<SurfaceSample> &samples,
                                   const std::vector<Int3> &references, std::vector<double> *forces) {
  PetscFunctionBeginUser;
  Bins bins(grid, references);
  for (const SurfaceSample &s : samples) bins.add(s);
  PetscCall(bins.reduce(grid.comm()));
  std::vector<std::vector<double>> pulls(references.size());
  forces->assign(samples.size(), 0);
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const SurfaceSample &s = samples[n];
    Bins::Place at;
    if (!bins.find(s, &at)) continue;
    const StretchForce &stretch = s.material->stretch_force;
    std::vector<double> &pull = pulls[at.body];
    if (pull.empty()) pull = bins.pull(at.body, stretch.area);
    const double share = (1 - at.above) * pull[at.bin] + at.above * pull[at.bin + 1];
    (*forces)[n] = stretch.force * (share * bins.weight(s)) / grid.cell_volume();
  }
  PetscFunctionReturn(0);
}

PetscErrorCode add_stretch_forces(const Grid &grid, GhostExchange &exchange, const std::vector<SurfaceSample> &samples,
                                  const std::vector<double> &forces, double scale, FieldBlock &scratch,
                                  FieldBlock &rate) {
  PetscFunctionBeginUser;
  scratch.fill(0, 0);
  const View at_centres = scratch[0];
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const Int3 &cell = samples[n].place;
    at_centres(cell[0], cell[1], cell[2]) += forces[n];
  }
  PetscCall(exchange.update(scratch, 1));
  for (const Segment &row : grid.rows()) {
    const double *f = at_centres.row(row.j, row.k);
    double *out = rate[0].row(row.j, row.k);
    for (int i = row.i_begin; i < row.i_end; ++i) out[i] += 0.5 * scale * (f[i - 1] + f[i]);
  }
  PetscFunctionReturn(0);
}

PetscErrorCode stretch_power(const Grid &grid, const std::vector<SurfaceSample> &samples,
                             const std::vector<double> &forces, double *power) {
  PetscFunctionBeginUser;
  ExactSums sum(1);
  for (std::size_t n = 0; n < samples.size(); ++n) sum.add(0, forces[n] * samples[n].velocity[0]);
  PetscCall(sum.reduce(grid.comm(), power));
  *power *= grid.cell_volume();
  PetscFunctionReturn(0);
}

}  // namespace eulastic
