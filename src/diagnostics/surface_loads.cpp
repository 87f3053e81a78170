#include "diagnostics/surface_loads.hpp"

#include "base/events.hpp"
#include "base/exact_sum.hpp"
#include "diagnostics/edge_stress.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace eulastic {
namespace {

constexpr int per_body = 6;  // force, torque

// Solid fraction and labels of bodies whose loads are measured.
struct Surface {
  const Box &box;
  ConstView phi, label;
  const OccupiedRows *rows = nullptr;  // of phi; null: all rows
};

class SurfaceLoads {
public:
  explicit SurfaceLoads(const std::vector<SurfaceLoad> &loads)
      : loads_(loads), sums_(per_body * static_cast<int>(loads.size())) {
    for (std::size_t b = 0; b < loads.size(); ++b) {
      index_.resize(std::max<std::size_t>(index_.size(), loads[b].label + 1), -1);
      index_[loads[b].label] = static_cast<int>(b);
    }
  }

  // Adds the load of a stress on a surface; normal(a, cell) is at centres, shear(a, b, cell) on low edges.
  template <class Normal, class Shear>
  void add(const Surface &of, const Normal &normal, const Shear &shear) {
    const Box &box = of.box;
    const auto within = [&of](const Segment &row) { return of.rows ? of.rows->within(row) : row; };
    const std::vector<Segment> rows = box.rows();
    for (int a = 0; a < box.dimension(); ++a) {
      for (const Segment &row : rows) add_centres(of, a, within(row), normal);
      for (int b = a + 1; b < box.dimension(); ++b)
        for (int k = 0; k < box.points_end(2, b == 2); ++k)
          for (int j = 0; j < box.points_end(1, a == 1 || b == 1); ++j)
            add_edges(of, a, b, within({0, box.points_end(0, a == 0), j, k}), shear);
    }
  }

  ExactSums &sums() { return sums_; }

private:
  // Adds the forces along a from sigma_aa at the centres of a row, for phi of the cells on both sides.
  template <class Normal>
  void add_centres(const Surface &of, int a, const Segment &row, const Normal &normal) {
    const std::ptrdiff_t step = of.phi.stride(a);
    const double *q = of.phi.row(row.j, row.k);
    for_cut(
        row, [=](int i) { return q[i + step] != q[i - step]; },
        [&](int i) {
          const Int3 cell{i, row.j, row.k};
          const double share = 0.5 * of.box.cell_volume() / of.box.spacing()[a] * normal(a, cell);
          if (share == 0) return;
          for (const int side : {1, -1}) {
            const double part = q[i + side * step];
            if (part == 0) continue;
            Int3 owner = cell;
            owner[a] += side;
            Real3 place{}, force{};
            place[a] = -side;
            force[a] = -side * part * share;
            add(of, owner, place, force);
          }
          end_point();
        });
  }

  // Adds the forces along a and b from sigma_ab on the low edges of a row of cells, for phi of the four cells around.
  template <class Shear>
  void add_edges(const Surface &of, int a, int b, const Segment &row, const Shear &shear) {
    const Box &box = of.box;
    const std::ptrdiff_t sa = of.phi.stride(a), sb = of.phi.stride(b);
    const double *q = of.phi.row(row.j, row.k);
    const auto differs = [=](int i) { return (q[i] != q[i - sa]) | (q[i] != q[i - sb]) | (q[i] != q[i - sa - sb]); };
    for_cut(row, differs, [&](int i) {
      const Int3 cell{i, row.j, row.k};
      const double whole = 0.5 * box.cell_volume() * shear(a, b, cell);
      if (whole == 0) return;
      for (const int low_a : {0, 1})
        for (const int low_b : {0, 1}) {
          const double part = q[i - low_a * sa - low_b * sb];
          if (part == 0) continue;
          Int3 owner = cell;
          owner[a] -= low_a;
          owner[b] -= low_b;
          Real3 place{}, force{};
          place[a] = low_a - 0.5;
          place[b] = low_b - 0.5;
          force[a] = (low_b ? whole : -whole) * part * volume_of_face(box, a, cell) / box.spacing()[b];
          force[b] = (low_a ? whole : -whole) * part * volume_of_face(box, b, cell) / box.spacing()[a];
          add(of, owner, place, force);
        }
      end_point();
    });
  }

  // Calls visit(i) where cut(i) holds.
  template <class Cut, class Visit>
  void for_cut(const Segment &row, const Cut &cut, const Visit &visit) {
    flags_.resize(std::max<std::size_t>(flags_.size(), row.i_end));
    unsigned char *flags = flags_.data();
    for (int i = row.i_begin; i < row.i_end; ++i) flags[i] = cut(i);
    for (int i = row.i_begin; i < row.i_end; ++i)
      if (flags[i]) visit(i);
  }

  // Control volume of a face in cells: half of one on a boundary of the box.
  static double volume_of_face(const Box &box, int a, const Int3 &cell) {
    const int at = box.layout().begin[a] + cell[a];
    return box.is_wall(a) && (at == 0 || at == box.domain_cells()[a]) ? 0.5 : 1;
  }

  // Adds a force and its torque to those of the same body at this point. `place`: where it acts, in cells from the
  // centre of the cell whose phi it belongs to.
  void add(const Surface &of, const Int3 &cell, const Real3 &place, const Real3 &force) {
    const Box &box = of.box;
    const auto label = static_cast<std::size_t>(of.label(cell[0], cell[1], cell[2]));
    if (force == Real3{} || label >= index_.size() || index_[label] < 0) return;
    if (index_[label] != body_) end_point();
    body_ = index_[label];
    Real3 arm{};
    for (int d = 0; d < box.dimension(); ++d) {
      const double h = box.spacing()[d], length = box.domain_shape().length[d];
      arm[d] = (box.layout().begin[d] + cell[d] + 0.5) * h - loads_[index_[label]].centre[d];
      if (!box.is_wall(d)) arm[d] -= length * std::round(arm[d] / length);
      arm[d] += place[d] * h;
    }
    for (int d = 0; d < 3; ++d) {
      const int e = (d + 1) % 3, g = (d + 2) % 3;
      load_[d] += force[d];
      load_[3 + d] += arm[e] * force[g] - arm[g] * force[e];
    }
  }

  void end_point() {
    for (int s = 0; s < per_body && body_ >= 0; ++s)
      if (load_[s] != 0) sums_.add(per_body * body_ + s, load_[s]);
    body_ = -1;
    load_ = {};
  }

  const std::vector<SurfaceLoad> &loads_;
  ExactSums sums_;
  std::vector<int> index_;  ///< index in loads_ of every label, -1: none
  std::vector<unsigned char> flags_;
  int body_ = -1;                        ///< index in loads_ of the body at the present point, -1: none
  std::array<double, per_body> load_{};  ///< on it
};

}  // namespace

PetscErrorCode measure_surface_loads(MPI_Comm comm, const EdgeViscosity &viscosity, const Field &velocity,
                                     const Field &pressure, const std::vector<Phase> &phases,
                                     const std::vector<const Field *> &labels,
                                     const std::vector<BodyAtSurfaces> &bodies, std::vector<SurfaceLoad> *loads) {
  PetscFunctionBeginUser;
  if (loads->empty()) PetscFunctionReturn(0);
  const EventScope scope(Event::sums);
  SurfaceLoads surfaces(*loads);
  const TotalStress stress{viscosity, velocity, phases};
  for (std::size_t p = 0; p < phases.size(); ++p)
    if (labels[p])
      surfaces.add(
          {viscosity.box, phases[p].fraction[0], (*labels[p])[0], &phases[p].rows},
          [&](int a, const Int3 &c) { return stress.normal(a, c) - pressure[0](c[0], c[1], c[2]); },
          [&](int a, int b, const Int3 &c) { return stress.shear(a, b, c); });
  for (const BodyAtSurfaces &body : bodies) {
    const Int3 &o = body.first;
    const int dimension = body.box.dimension();
    for (const Field &surface : body.surfaces)
      surfaces.add(
          {body.box, surface[1], surface[0]},
          [&](int a, const Int3 &c) {
            return centre_stress(dimension, *body.phase, a, o[0] + c[0], o[1] + c[1], o[2] + c[2]);
          },
          [&](int a, int b, const Int3 &c) {
            return edge_stress(body.box, *body.phase, a, b, o[0] + c[0], o[1] + c[1], o[2] + c[2]);
          });
  }
  std::vector<double> total(per_body * loads->size());
  PetscCall(surfaces.sums().reduce(comm, total.data()));
  for (std::size_t b = 0; b < loads->size(); ++b)
    for (int d = 0; d < 3; ++d) {
      (*loads)[b].force[d] = total[per_body * b + d];
      (*loads)[b].torque[d] = total[per_body * b + 3 + d];
    }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
