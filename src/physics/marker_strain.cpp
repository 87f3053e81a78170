// SurfaceMarkers: the strain of a surface from where its markers are and were.
#include "base/events.hpp"
#include "grid/threads.hpp"
#include "kernels/surface_fit.hpp"
#include "physics/membrane_tensor.hpp"
#include "physics/surface_markers.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

template <int Dim>
constexpr double radius = Dim == 2 ? 2.5 : 2;  // cells around a point of the surface in which markers tell of it
constexpr int reach = SurfaceMarkers::reach;
constexpr double round_off = 1e-9;  // of a metric
template <int Dim>
constexpr int fewest = Dim == 2 ? 5 : 8;  // markers: two more than coefficients
constexpr double same_side = 0.3;         // least cosine between normals
constexpr double trusted = 0.3;           // cells: largest deviation of their places at rest from a quadratic, rms

struct Sources {
  const Box *box;
  const SurfaceCells *surface;
  const SurfaceMarker *markers;
  const int *begin;  // by offset from the origin
};

// What is seen of a marker from a point of the surface.
struct Seen {
  const SurfaceMarker *marker;
  Real3 away;     // length
  double square;  // of the distance in cells
};

template <int Dim>
EULASTIC_INLINE int look_around(const Sources &from, const int *marker_of, const SurfaceCells::Cell &cell, Seen *seen,
                                int most) {
  const Real3 &h = from.box->spacing();
  const Layout &layout = from.box->layout();
  int count = 0;
  for (int z = Dim == 3 ? -reach : 0; z <= (Dim == 3 ? reach : 0); ++z)
    for (int y = -reach; y <= reach; ++y) {
      const std::ptrdiff_t row = cell.at + y * layout.sy + z * layout.sz;
      for (int x = -reach; x <= reach; ++x) {
        const int first = from.begin[row + x], last = from.begin[row + x + 1];
        if (first == last) continue;
        const Real3 &normal = from.surface->all()[from.surface->number(row + x)].normal;
        double cosine = 0;
        for (int d = 0; d < Dim; ++d) cosine += normal[d] * cell.normal[d];
        if (!(cosine > same_side)) continue;
        const Int3 step{x, y, z};
        for (int m = first; m < last && count < most; ++m) {
          Seen &one = seen[count];
          one.marker = from.markers + marker_of[m];
          one.square = 0;
          for (int d = 0; d < Dim; ++d) {
            one.away[d] = (step[d] + one.marker->offset[d]) * h[d] + cell.distance * cell.normal[d];
            one.square += (one.away[d] / h[d]) * (one.away[d] / h[d]);
          }
          count += one.square < radius<Dim> * radius<Dim>;
        }
      }
    }
  return count;
}

// B_s at a point of the surface from the places at rest of the markers around it and from their heights over the plane
// t: both as quadratics. `nearest`: a marker of its body and its side.
template <int Dim, int Values>
EULASTIC_INLINE bool strain_around(const Box &box, const kernels::Vector<Dim> &n, const Seen *seen, int count,
                                   const SurfaceMarker &nearest, kernels::Tensor<Dim> *B) {
  constexpr int height = Dim, metric = Dim + 1;
  const auto t = kernels::tangents<Dim>(n);
  const Real3 &h = box.spacing();
  const double length = radius<Dim> * std::max({h[0], h[1], Dim == 3 ? h[2] : 0});
  kernels::SurfacePoints<Values> points;
  for (int m = 0; m < count; ++m) {
    const SurfaceMarker &marker = *seen[m].marker;
    double cosine = 0, along[2] = {}, up = 0;
    for (int d = 0; d < Dim; ++d) cosine += marker.normal[d] * nearest.normal[d];
    if (marker.label != nearest.label || !(cosine > same_side)) continue;
    for (int a = 0; a < Dim - 1; ++a)
      for (int d = 0; d < Dim; ++d) along[a] += seen[m].away[d] * t[a][d];
    for (int d = 0; d < Dim; ++d) up += seen[m].away[d] * n[d];
    const double near = 1 - seen[m].square / (radius<Dim> * radius<Dim>);
    points.u[points.count] = along[0] / length;
    points.v[points.count] = along[1] / length;
    points.weight[points.count] = near * near;
    points.value[height][points.count] = up / length;
    for (int d = 0; d < Dim; ++d) {
      const double period = box.domain_shape().length[d];
      double away = marker.rest[d] - nearest.rest[d];
      if (!box.is_wall(d)) away -= away > 0.5 * period ? period : away < -0.5 * period ? -period : 0;
      points.value[d][points.count] = away / length;
    }
    for (int q = metric; q < Values; ++q) points.value[q][points.count] = marker.metric[q - metric];
    ++points.count;
  }
  if (points.count < fewest<Dim>) return false;
  points.fill_up();
  kernels::SurfaceFit<Dim, Values> fit;
  if (!kernels::fit_surface<Dim, Values>(points, &fit)) return false;
  constexpr double most = trusted / radius<Dim>;
  if (!(fit.residual < most * most)) return false;
  std::array<double, 6> rest = nearest.metric;
  for (int q = metric; q < Values; ++q) rest[q - metric] = fit.coefficient[0][q];
  double G[Dim - 1][Dim - 1] = {};
  for (int a = 0; a < Dim - 1; ++a)
    for (int b = 0; b < Dim - 1; ++b)
      for (int x = 0; x < Dim; ++x)
        for (int y = 0; y < Dim; ++y)
          G[a][b] += fit.coefficient[1 + a][x] * rest[kernels::position<3>(x, y)] * fit.coefficient[1 + b][y];
  const double area = Dim == 2 ? G[0][0] : G[0][0] * G[Dim - 2][Dim - 2] - G[0][Dim - 2] * G[Dim - 2][0];
  if (!(area > 0)) return false;
  auto slanted = t;  // along the surface itself
  for (int a = 0; a < Dim - 1; ++a)
    for (int d = 0; d < Dim; ++d) slanted[a][d] += fit.coefficient[1 + a][height] * n[d];
  *B = kernels::project_surface<Dim>(kernels::inverse_in_plane<Dim>(slanted, G), n);
  return true;
}

template <int Dim>
EULASTIC_INLINE bool strain_at(const Sources &from, const int *marker_of, const SurfaceCells::Cell &cell, double *B) {
  constexpr int most = kernels::SurfacePoints<Dim>::most;
  Seen seen[most];
  const int count = look_around<Dim>(from, marker_of, cell, seen, most);
  if (count < fewest<Dim>) return false;
  const auto nearer = [](const Seen &a, const Seen &b) { return a.square < b.square; };
  const SurfaceMarker &nearest = *std::min_element(seen, seen + count, nearer)->marker;
  bool uniform = true;
  for (int m = 0; m < count; ++m)
    for (int q = 0; q < 6; ++q)
      uniform = uniform && __builtin_fabs(seen[m].marker->metric[q] - nearest.metric[q]) < round_off;
  const kernels::Vector<Dim> n = normal_of<Dim>(cell.normal);
  kernels::Tensor<Dim> strain;
  const bool told = uniform ? strain_around<Dim, Dim + 1>(*from.box, n, seen, count, nearest, &strain)
                            : strain_around<Dim, Dim + 7>(*from.box, n, seen, count, nearest, &strain);
  if (!told) return false;
  for (int a = 0; a < Dim; ++a)
    for (int b = a; b < Dim; ++b) B[kernels::position<Dim>(a, b)] = strain[a][b];
  return true;
}

EULASTIC_CLONES bool strain_2d(const Sources &from, const int *marker_of, const SurfaceCells::Cell &cell, double *B) {
  return strain_at<2>(from, marker_of, cell, B);
}
EULASTIC_CLONES bool strain_3d(const Sources &from, const int *marker_of, const SurfaceCells::Cell &cell, double *B) {
  return strain_at<3>(from, marker_of, cell, B);
}

}  // namespace

// Those whose cell is one of the nearest or beside one, which every rank sees as far as it needs them. In an order that
// is the same on any ranks.
void SurfaceMarkers::sort(const SurfaceCells &surface, int phase) {
  const Layout &layout = box_->layout();
  near_.clear();
  for (std::size_t m = 0; m < all_.size(); ++m) {
    if (all_[m].phase != phase) continue;
    Box::Range images[3]{{0, 1}, {0, 1}, {0, 1}};
    for (int d = 0; d < box_->dimension(); ++d)
      if (domain_ && !box_->is_wall(d)) images[d] = {-1, 2};
    for (int z = images[2].begin; z < images[2].end; ++z)
      for (int y = images[1].begin; y < images[1].end; ++y)
        for (int x = images[0].begin; x < images[0].end; ++x) {
          const Int3 image{x, y, z};
          Int3 local;
          bool here = true;
          for (int d = 0; d < 3; ++d) {
            const int ghosts = d < box_->dimension() ? reach : 0;
            local[d] = all_[m].cell[d] - layout.begin[d] + image[d] * box_->domain_cells()[d];
            here = here && local[d] >= -ghosts && local[d] < layout.cells[d] + ghosts;
          }
          if (!here) continue;
          const std::ptrdiff_t at = local[0] + local[1] * layout.sy + local[2] * layout.sz;
          const int number = surface.number(at);
          if (number >= 0 && surface.all()[number].layer <= 1) near_.push_back({at, static_cast<int>(m)});
        }
  }
  std::sort(near_.begin(), near_.end(), [&](const Near &a, const Near &b) {
    if (a.at != b.at) return a.at < b.at;
    const SurfaceMarker &one = all_[a.marker], &other = all_[b.marker];
    return one.label != other.label ? one.label < other.label : one.number < other.number;
  });
  begin_.assign(layout.size + 1, 0);
  int *count = begin_.data() + layout.origin + 1;
  for (const Near &near : near_) ++count[near.at];
  for (std::ptrdiff_t o = 0; o < layout.size; ++o) begin_[o + 1] += begin_[o];
}

void SurfaceMarkers::find_strain(const SurfaceCells &surface, int phase, std::vector<Strain> *strains) {
  VerbScope scope(Verb::membrane);
  sort(surface, phase);
  std::vector<int> marker_of;
  for (const Near &near : near_) marker_of.push_back(near.marker);
  const Sources from{box_, &surface, all_.data(), begin_.data() + box_->layout().origin};
  const int parts = row_parts(*box_);
  std::vector<std::vector<Strain>> found(parts);
  in_parallel(parts, parts, [&](int part) {
    const Piece piece(surface.nearest(), part, parts);
    for (std::size_t c = piece.begin; c < piece.end; ++c) {
      const SurfaceCells::Cell &cell = surface.all()[c];
      Strain strain{c, {}};
      if (cell.owned && (box_->dimension() == 2 ? strain_2d : strain_3d)(from, marker_of.data(), cell, strain.B.data()))
        found[part].push_back(strain);
    }
  });
  strains->clear();
  for (const auto &part : found) strains->insert(strains->end(), part.begin(), part.end());
  scope.flops(double(strains->size()) * (box_->dimension() == 2 ? 500 : 4000));
}

}  // namespace eulastic
