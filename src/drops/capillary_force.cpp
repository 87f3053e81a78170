#include "drops/capillary_force.hpp"

#include "base/events.hpp"
#include "field/boundaries.hpp"
#include "grid/blocks.hpp"
#include "kernels/height_curvature.hpp"
#include "kernels/plane.hpp"
#include "kernels/stencils.hpp"

#include <algorithm>

namespace eulastic {
namespace {

// Scratch fields: weight times curvature, and the weight of a cell, phi (1 - phi) plus a small number for full cells
// beside empty ones. Cells without a curvature have weight 0.
enum Scratch { weighted, weight };
constexpr double least_weight = 1e-16;

// A list of cells whose curvatures are computed in one vector loop.
struct CellList {
  static constexpr int capacity = 128;
  std::ptrdiff_t at[capacity];
  kernels::ColumnFrame frame[capacity];
  int count = 0;
};

// Views of the fields that the curvature is computed from and stored in.
struct Curvature {
  const Box &box;
  ConstView phi;
  View sum, weight;  // by Scratch
  std::ptrdiff_t stride[3];

  Curvature(const Box &g, ConstView fraction, Field &fields)
      : box(g), phi(fraction), sum(fields[weighted]), weight(fields[Scratch::weight]) {
    for (int d = 0; d < 3; ++d) stride[d] = phi.stride(d);
  }

  // Whether the interface is in this cell or on one of its faces.
  EULASTIC_INLINE bool cut(const double *q) const {
    if (*q > 0 && *q < 1) return true;
    bool jump = false;
    for (int d = 0; d < box.dimension(); ++d) jump = jump || q[stride[d]] == 1 - *q || q[-stride[d]] == 1 - *q;
    return jump;
  }
  EULASTIC_INLINE static double weight_of(double q) { return q * (1 - q) + least_weight; }
};

// Computes and stores the curvatures of a list of cells, and empties the list.
template <int Dim>
EULASTIC_INLINE void process_list(const Curvature &c, CellList &cells) {
#pragma omp simd
  for (int n = 0; n < cells.count; ++n) {
    const std::ptrdiff_t at = cells.at[n];
    const kernels::HeightCurvature found = kernels::height_curvature<Dim>(c.phi.origin + at, cells.frame[n]);
    const double w = found.whole ? Curvature::weight_of(c.phi.origin[at]) : 0;
    c.weight.origin[at] = w;
    c.sum.origin[at] = found.whole ? w * found.value : 0;
  }
  cells.count = 0;
}

// Computes curvatures from heights in the owned cells of segments. Returns their number.
template <int Dim>
EULASTIC_INLINE long from_heights(const Curvature &c, const Segment *begin, const Segment *end) {
  const Int3 n = c.box.cells();
  const Real3 h = c.box.spacing();
  CellList cells;
  long count = 0;
  for (const Segment *s = begin; s < end; ++s) {
    if (s->j < 0 || s->j >= n[1] || s->k < 0 || s->k >= n[2]) continue;
    const double *q = c.phi.row(s->j, s->k);
    for (int i = std::max(s->i_begin, 0); i < std::min(s->i_end, n[0]); ++i) {
      if (!c.cut(q + i) || !kernels::column_frame<Dim>(q + i, c.stride, h.data(), &cells.frame[cells.count])) continue;
      cells.at[cells.count++] = q + i - c.phi.origin;
      ++count;
      if (cells.count == CellList::capacity) process_list<Dim>(c, cells);
    }
  }
  process_list<Dim>(c, cells);
  return count;
}

EULASTIC_CLONES long from_heights_2d(const Curvature &c, const Segment *begin, const Segment *end) {
  return from_heights<2>(c, begin, end);
}
EULASTIC_CLONES long from_heights_3d(const Curvature &c, const Segment *begin, const Segment *end) {
  return from_heights<3>(c, begin, end);
}

// A cell whose curvature is the mean of its neighbours'.
struct AveragedCell {
  std::ptrdiff_t at;
  double sum, weight;
};

// Lists cells without heights with the mean curvature of the cells around that have one. The values are written after
// all cells have read.
template <int Dim>
EULASTIC_INLINE void average_neighbours(const Curvature &c, const Segment *begin, const Segment *end,
                                        std::vector<AveragedCell> *averaged) {
  for (const Segment *s = begin; s < end; ++s) {
    const double *q = c.phi.row(s->j, s->k);
    for (int i = s->i_begin; i < s->i_end; ++i) {
      const std::ptrdiff_t at = q + i - c.phi.origin;
      if (!c.cut(q + i) || c.weight.origin[at] > 0) continue;
      const double total = kernels::sum_around<Dim>(c.weight.origin + at, c.stride), w = Curvature::weight_of(q[i]);
      if (total > 0) averaged->push_back({at, w * (kernels::sum_around<Dim>(c.sum.origin + at, c.stride) / total), w});
    }
  }
}

// The force on faces of component d in the band of a phase: calls add(i, force) for each face of a segment.
struct Faces {
  Curvature curvature;
  int d;
  double factor;  // scale sigma/h

  template <class Add>
  EULASTIC_INLINE void row(const Segment &s, Add add) const {
    const double *q = curvature.phi.row(s.j, s.k), *k = curvature.sum.row(s.j, s.k),
                 *w = curvature.weight.row(s.j, s.k);
    const std::ptrdiff_t step = curvature.stride[d];
    const double f = factor;
#pragma omp simd
    for (int i = s.i_begin; i < s.i_end; ++i) {
      const double jump = q[i] - q[i - step], total = w[i] + w[i - step];
      const double force = f * jump * ((k[i] + k[i - step]) / total);
      add(i, jump != 0 && total > 0 ? force : 0);
    }
  }
};

EULASTIC_CLONES void force_row(const Faces &faces, const Segment &s, double *force) {
  faces.row(s, [=](int i, double f) EULASTIC_BODY { force[i] += f; });
}

EULASTIC_CLONES void power_row(const Faces &faces, const Segment &s, const double *v, double *power) {
  faces.row(s, [=](int i, double f) EULASTIC_BODY { power[i] = kernels::fma(-f, v[i], power[i]); });
}

// Area in a cell: that of its plane if the surface cuts it, and of its low faces between full and empty cells.
template <int Dim>
EULASTIC_INLINE double area_at(const Curvature &c, const double *q) {
  const Real3 h = c.box.spacing();
  double area = 0, face[3];
  for (int d = 0; d < Dim; ++d) {
    face[d] = (Dim == 2 ? 1 : h[(d + 2) % 3]) * h[(d + 1) % Dim];
    if (__builtin_fabs(*q - q[-c.stride[d]]) == 1) area += face[d];
  }
  return *q > 0 && *q < 1 ? area + kernels::plane_area<Dim>(q, c.stride, face) : area;
}

// Calls work(segment) for the owned parts of the band in a row.
template <class Work>
void for_owned(const Box &box, const ActiveSegments &band, int j, int k, const Work &work) {
  for (const Segment &s : band.row(j, k)) {
    const Segment owned{std::max(s.i_begin, 0), std::min(s.i_end, box.cells()[0]), j, k};
    if (owned.size() > 0) work(owned);
  }
}

}  // namespace

// The curvature is found in the cells of the band, including one ghost layer.
PetscErrorCode CapillaryForce::find(const Phase &phase, ConstView phi, Field &work) {
  PetscFunctionBeginUser;
  EventScope scope(Event::surface_tension);
  const Box &box = *box_;
  const bool flat = box.dimension() == 2;
  const int parts = row_parts(box);
  phase_ = &phase;
  phi_ = phi;
  work_ = work.part(0, work_fields);
  band_.build_band(box, phi, phase.rows, 1);
  const Curvature curvature(box, phi, work_);
  clear_work();
  std::vector<long> counted(parts);
  const std::vector<Segment> &band = band_.all();
  in_parallel(parts, parts, [&](int part) {
    const Piece piece(band.size(), part, parts);
    counted[part] =
        (flat ? from_heights_2d : from_heights_3d)(curvature, band.data() + piece.begin, band.data() + piece.end);
  });
  if (exchange_) PetscCall(exchange_->update_ghosts(work_, work_ghosts, &phase.rows));
  for (int f = 0; f < work_fields; ++f) fill_wall_ghosts_even(box, at_centre, work_[f], work_ghosts, &phase.rows);
  std::vector<std::vector<AveragedCell>> averaged(parts);
  in_parallel(parts, parts, [&](int part) {
    const Piece piece(band.size(), part, parts);
    (flat ? average_neighbours<2> : average_neighbours<3>)(curvature, band.data() + piece.begin,
                                                           band.data() + piece.end, &averaged[part]);
  });
  long cells = 0;
  for (const long count : counted) cells += count;
  for (const std::vector<AveragedCell> &list : averaged)
    for (const AveragedCell &cell : list) {
      curvature.sum.origin[cell.at] = cell.sum;
      curvature.weight.origin[cell.at] = cell.weight;
    }
  scope.flops(double(cells) * (flat ? kernels::height_curvature_flops_2d : kernels::height_curvature_flops_3d));
  PetscFunctionReturn(0);
}

// Clears the scratch fields in owned cells and, in a box, also in the first ghosts, which no exchange fills.
void CapillaryForce::clear_work() {
  const int n = box_->cells()[0], ghosts = exchange_ ? 0 : 1;
  in_row_parts(*box_, [&](const RowPart &part) {
    for_rows_in_blocks(exchange_ ? part : part.with_ghosts(*box_), [&](int j, int k) {
      const OccupiedRows::Span span = phase_->rows.span(j, k);
      const int begin = std::max(span.begin, -ghosts), end = std::min(span.end, n + ghosts);
      for (int f = 0; f < work_fields && begin < end; ++f) std::fill_n(work_[f].row(j, k) + begin, end - begin, 0.0);
    });
  });
}

void CapillaryForce::add_to_row(double tension, int d, int j, int k, double *force) {
  const Faces faces{Curvature(*box_, phi_, work_), d, tension / box_->spacing()[d]};
  for_owned(*box_, band_, j, k, [&](const Segment &s) { force_row(faces, s, force); });
}

void CapillaryForce::add_force(double scale, Field &force, const WeightedTarget &slope, NetForce *net) {
  EventScope scope(Event::surface_tension);
  const Box &box = *box_;
  const int dim = box.dimension(), n = box.cells()[0];
  const double sigma = phase_->material.surface_tension;
  in_row_parts(box, [&](const RowPart &part) {
    std::vector<double> added(n);
    for (int d = 0; d < dim; ++d) {
      for_rows_in_blocks(part, [&](int j, int k) {
        if (band_.idle(j, k)) return;
        std::fill(added.begin(), added.end(), 0.0);
        add_to_row(scale * sigma, d, j, k, added.data());
        add_force_row(n, added.data(), slope.factor, force[d].row(j, k),
                      slope.field ? (*slope.field)[d].row(j, k) : nullptr);
        net->add_row(box, part.number, d, added.data());
      });
    }
  });
  scope.flops(band_.points() * dim * (slope.field ? 9 : 7));
}

void CapillaryForce::measure(const Field &velocity, int first_sum, std::vector<ExactSums> *sum) {
  EventScope scope(Event::sums);
  const Box &box = *box_;
  const int dim = box.dimension(), n = box.cells()[0], first = box.layout().begin[0];
  const double sigma = phase_->material.surface_tension;
  const Curvature curvature(box, phi_, work_);
  in_row_parts(box, [&](const RowPart &part) {
    std::vector<double> given(n), cut(n);
    for (const Segment &row : part.rows(box)) {
      if (phase_->rows.idle(row.j, row.k)) continue;
      std::fill(given.begin(), given.end(), 0.0);
      std::fill(cut.begin(), cut.end(), 0.0);
      for_owned(box, band_, row.j, row.k, [&](const Segment &s) {
        for (int d = 0; d < dim; ++d)
          power_row({curvature, d, sigma / box.spacing()[d]}, s, velocity[d].row(row.j, row.k), given.data());
        const double *q = phi_.row(row.j, row.k);
        for (int i = s.i_begin; i < s.i_end; ++i) cut[i] = (dim == 2 ? area_at<2> : area_at<3>)(curvature, q + i);
      });
      (*sum)[part.number].add_row(first_sum + power, given.data(), n, first);
      (*sum)[part.number].add_row(first_sum + area, cut.data(), n, first);
    }
  });
}

}  // namespace eulastic
