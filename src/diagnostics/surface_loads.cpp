#include "diagnostics/surface_loads.hpp"

#include "base/events.hpp"
#include "base/exact_sum.hpp"
#include "diagnostics/edge_stress.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

constexpr int per_body = 6;  // force, torque

class SurfaceLoads {
public:
  SurfaceLoads(const EdgeViscosity &viscosity, const Field &velocity, const Field &pressure,
               const std::vector<Phase> &phases, const std::vector<const Field *> &labels,
               const std::vector<SurfaceLoad> &loads)
      : box_(viscosity.box),
        stress_{viscosity, velocity, phases},
        pressure_(pressure),
        phases_(phases),
        labels_(labels),
        loads_(loads) {
    for (std::size_t b = 0; b < loads.size(); ++b) {
      index_.resize(std::max<std::size_t>(index_.size(), loads[b].label + 1), -1);
      index_[loads[b].label] = static_cast<int>(b);
    }
  }

  // The forces along a that sigma_aa at the centres of a row are, by the phi of the cells on both sides.
  void add_centres(std::size_t p, int a, const Segment &row, ExactSums *sums) {
    const ConstView phi = phases_[p].fraction[0];
    const std::ptrdiff_t step = phi.stride(a);
    const double *q = phi.row(row.j, row.k);
    for_cut(
        row, [=](int i) { return q[i + step] != q[i - step]; },
        [&](int i) {
          const Int3 cell{i, row.j, row.k};
          const double stress = stress_.normal(a, cell) - pressure_[0](i, row.j, row.k);
          const double share = 0.5 * box_.cell_volume() / box_.spacing()[a] * stress;
          for (const int side : {1, -1}) {
            Int3 owner = cell;
            owner[a] += side;
            Real3 place{};
            for (int d = 0; d < box_.dimension(); ++d) place[d] = d == a ? -side : 0;
            add(p, owner, place, a, -side * q[i + side * step] * share, sums);
          }
        });
  }

  // The forces along a and b that sigma_ab on the low edges of a row of cells are, by the phi of the four cells around.
  void add_edges(std::size_t p, int a, int b, const Segment &row, ExactSums *sums) {
    const ConstView phi = phases_[p].fraction[0];
    const std::ptrdiff_t sa = phi.stride(a), sb = phi.stride(b);
    const double *q = phi.row(row.j, row.k);
    const auto differs = [=](int i) { return (q[i] != q[i - sa]) | (q[i] != q[i - sb]) | (q[i] != q[i - sa - sb]); };
    for_cut(row, differs, [&](int i) {
      const Int3 cell{i, row.j, row.k};
      const double whole = 0.5 * box_.cell_volume() * stress_.shear(a, b, cell);
      for (const int low_a : {0, 1})
        for (const int low_b : {0, 1}) {
          Int3 owner = cell;
          owner[a] -= low_a;
          owner[b] -= low_b;
          Real3 place{};
          place[a] = low_a - 0.5;
          place[b] = low_b - 0.5;
          const double part = whole * q[i - low_a * sa - low_b * sb];
          add(p, owner, place, a, (low_b ? part : -part) * volume_of_face(a, cell) / box_.spacing()[b], sums);
          add(p, owner, place, b, (low_a ? part : -part) * volume_of_face(b, cell) / box_.spacing()[a], sums);
        }
    });
  }

private:
  // visit(i) where cut(i).
  template <class Cut, class Visit>
  void for_cut(const Segment &row, const Cut &cut, const Visit &visit) {
    flags_.resize(std::max<std::size_t>(flags_.size(), row.i_end));
    unsigned char *flags = flags_.data();
    for (int i = row.i_begin; i < row.i_end; ++i) flags[i] = cut(i);
    for (int i = row.i_begin; i < row.i_end; ++i)
      if (flags[i]) visit(i);
  }

  // In cells: a face on a side of the box has half of one.
  double volume_of_face(int a, const Int3 &cell) const {
    const int at = box_.layout().begin[a] + cell[a];
    return box_.is_wall(a) && (at == 0 || at == box_.domain_cells()[a]) ? 0.5 : 1;
  }

  // `place`: of the force, in cells from the centre of the cell whose phi it comes from.
  void add(std::size_t phase, const Int3 &cell, const Real3 &place, int a, double push, ExactSums *sums) const {
    const auto label = static_cast<std::size_t>((*labels_[phase])[0](cell[0], cell[1], cell[2]));
    if (push == 0 || label >= index_.size() || index_[label] < 0) return;
    const int first = per_body * index_[label];
    Real3 arm{}, force{};
    for (int d = 0; d < box_.dimension(); ++d) {
      const double h = box_.spacing()[d], length = box_.domain_shape().length[d];
      arm[d] = (box_.layout().begin[d] + cell[d] + 0.5) * h - loads_[index_[label]].centre[d];
      if (!box_.is_wall(d)) arm[d] -= length * std::round(arm[d] / length);
      arm[d] += place[d] * h;
    }
    force[a] = push;
    sums->add(first + a, push);
    for (int d = 0; d < 3; ++d) {
      const int e = (d + 1) % 3, g = (d + 2) % 3;
      if (e == a || g == a) sums->add(first + 3 + d, arm[e] * force[g] - arm[g] * force[e]);
    }
  }

  const Box &box_;
  WholeStress stress_;
  const Field &pressure_;
  const std::vector<Phase> &phases_;
  const std::vector<const Field *> &labels_;
  const std::vector<SurfaceLoad> &loads_;
  std::vector<int> index_;  ///< of every label
  std::vector<unsigned char> flags_;
};

}  // namespace

PetscErrorCode measure_surface_loads(MPI_Comm comm, const EdgeViscosity &viscosity, const Field &velocity,
                                     const Field &pressure, const std::vector<Phase> &phases,
                                     const std::vector<const Field *> &labels, std::vector<SurfaceLoad> *loads) {
  PetscFunctionBeginUser;
  if (loads->empty()) PetscFunctionReturn(0);
  const VerbScope scope(Verb::sums);
  const Box &box = viscosity.box;
  SurfaceLoads surface(viscosity, velocity, pressure, phases, labels, *loads);
  ExactSums sums(per_body * static_cast<int>(loads->size()));
  const std::vector<Segment> rows = box.rows();
  for (std::size_t p = 0; p < phases.size(); ++p)
    for (int a = 0; labels[p] && a < box.dimension(); ++a) {
      for (const Segment &row : rows) surface.add_centres(p, a, phases[p].rows.within(row), &sums);
      for (int b = a + 1; b < box.dimension(); ++b)
        for (int k = 0; k < box.points_end(2, b == 2); ++k)
          for (int j = 0; j < box.points_end(1, a == 1 || b == 1); ++j)
            surface.add_edges(p, a, b, phases[p].rows.within({0, box.points_end(0, a == 0), j, k}), &sums);
    }
  std::vector<double> total(per_body * loads->size());
  PetscCall(sums.reduce(comm, total.data()));
  for (std::size_t b = 0; b < loads->size(); ++b)
    for (int d = 0; d < 3; ++d) {
      (*loads)[b].force[d] = total[per_body * b + d];
      (*loads)[b].torque[d] = total[per_body * b + 3 + d];
    }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
