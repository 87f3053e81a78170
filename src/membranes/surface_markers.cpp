#include "membranes/surface_markers.hpp"

#include "base/events.hpp"
#include "base/send_to_ranks.hpp"
#include "grid/threads.hpp"
#include "kernels/surface_fit.hpp"
#include "membranes/membrane_tensor.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace eulastic {
namespace {

constexpr double pull_share = 0.2;   // part of the distance by which markers are pulled to the surface in every step
constexpr double least_label = 0.5;  // labels of one body differ by less

std::ptrdiff_t offset_of(const Layout &layout, const Int3 &c) { return c[0] + c[1] * layout.sy + c[2] * layout.sz; }

// Component a of the velocity at `offset` (in cells) from the centre of a cell.
template <int Dim>
double velocity_at(ConstView v, int a, const Int3 &cell, const Real3 &offset) {
  int first[3]{0, 0, cell[2]};
  double weight[3][4];
  for (int d = 0; d < Dim; ++d) {
    const double place = offset[d] + (d == a ? 0.5 : 0), low = std::floor(place);
    first[d] = cell[d] + static_cast<int>(low) - 1;
    for (int m = 0; m < 4; ++m) weight[d][m] = kernels::keys4(place - low - (m - 1));
  }
  double sum = 0;
  for (int k = 0; k < (Dim == 3 ? 4 : 1); ++k)
    for (int j = 0; j < 4; ++j) {
      const double *row = &v(first[0], first[1] + j, first[2] + k);
      double along = 0;
      for (int i = 0; i < 4; ++i) along = kernels::fma(weight[0][i], row[i], along);
      sum = kernels::fma(Dim == 3 ? weight[1][j] * weight[2][k] : weight[1][j], along, sum);
    }
  return sum;
}

template <int Dim>
void move_marker(const Real3 &spacing, double dt, const Field &velocity, const Int3 &cell, SurfaceMarker *marker) {
  Real3 half = marker->offset, end = half;
  for (int d = 0; d < Dim; ++d)
    half[d] += 0.5 * dt / spacing[d] * velocity_at<Dim>(velocity[d], d, cell, marker->offset);
  for (int d = 0; d < Dim; ++d) end[d] += dt / spacing[d] * velocity_at<Dim>(velocity[d], d, cell, half);
  marker->offset = end;
}

// M of (25a): the inverse of B_s along the surface, with the mean of its eigenvalues along the normal n.
template <int Dim>
std::array<double, 6> metric_of(const kernels::Tensor<Dim> &B, const kernels::Vector<Dim> &n) {
  const auto t = kernels::tangents<Dim>(n);
  double G[Dim - 1][Dim - 1] = {}, mean = 0;
  for (int a = 0; a < Dim - 1; ++a)
    for (int b = 0; b < Dim - 1; ++b)
      for (int x = 0; x < Dim; ++x)
        for (int y = 0; y < Dim; ++y) G[a][b] += t[a][x] * B[x][y] * t[b][y];
  const kernels::Tensor<Dim> inverse = kernels::inverse_in_plane<Dim>(t, G);
  for (int x = 0; x < Dim; ++x) mean += inverse[x][x] / (Dim - 1);
  std::array<double, 6> metric{1, 1, 1, 0, 0, 0};
  for (int x = 0; x < Dim; ++x)
    for (int y = x; y < Dim; ++y) metric[kernels::position<3>(x, y)] = inverse[x][y] + mean * (n[x] * n[y]);
  return metric;
}

}  // namespace

Int3 SurfaceMarkers::local_cell(const SurfaceMarker &marker) const {
  Int3 local;
  for (int d = 0; d < 3; ++d) local[d] = marker.cell[d] - box_->layout().begin[d];
  return local;
}

// Index of the cell that a marker has entered: wrapped around periodic directions, limited at boundaries.
int SurfaceMarkers::in_domain(int d, int index) const {
  if (box_->is_wall(d)) return std::clamp(index, 0, box_->domain_cells()[d] - 1);
  return domain_ ? box_->image(d, index) : index;
}

// Refers the marker to the cell that contains it.
void SurfaceMarkers::update_cell(SurfaceMarker *marker) const {
  for (int d = 0; d < box_->dimension(); ++d) {
    double &offset = marker->offset[d];
    const double cells = std::floor(offset + 0.5);
    const int to = marker->cell[d] + static_cast<int>(cells);
    offset -= cells;
    marker->cell[d] = in_domain(d, to);
    if (box_->is_wall(d) && to != marker->cell[d]) offset = to < 0 ? -0.5 : 0.5;
  }
}

bool SurfaceMarkers::approach(const SurfaceCells &surface, const Field &fields, double part,
                              SurfaceMarker *marker) const {
  const int number = surface.number(offset_of(box_->layout(), local_cell(*marker)));
  if (number < 0) return false;
  const SurfaceCells::Cell &cell = surface.all()[number];
  const double distance = part * surface.distance_at(fields, cell, marker->offset);
  for (int d = 0; d < 3; ++d) marker->offset[d] -= distance * cell.normal[d] / box_->spacing()[d];
  return true;
}

void SurfaceMarkers::place(const SurfaceCells &surface, const Field &fields, const Phase &phase, int number, int label,
                           std::vector<SurfaceMarker> *markers) const {
  constexpr int approaches = 3;
  const Int3 &begin = box_->layout().begin, &cells = box_->domain_cells();
  for (std::size_t c = 0; c < surface.nearest_count(); ++c) {
    const SurfaceCells::Cell &cell = surface.all()[c];
    const int own = phase.label ? static_cast<int>(phase.label[0].origin[cell.at]) : 0;
    if (!cell.owned || (phase.label && own == 0) || (label != 0 && own != label)) continue;
    SurfaceMarker marker;
    for (int d = 0; d < 3; ++d) marker.cell[d] = begin[d] + cell.place[d];
    const auto x = [&](int d) { return std::int64_t(box_->image(d, marker.cell[d])); };
    marker.number = x(0) + cells[0] * (x(1) + cells[1] * x(2));
    for (int n = 0; n < approaches; ++n) (void)approach(surface, fields, 1, &marker);
    for (int d = 0; d < 3; ++d) marker.rest[d] = (marker.cell[d] + 0.5 + marker.offset[d]) * box_->spacing()[d];
    marker.normal = cell.normal;
    marker.label = own;
    marker.phase = number;
    marker.metric = box_->dimension() == 2
                        ? metric_of<2>(tensor_at<2>(phase.tensor.field, cell.at), normal_of<2>(cell.normal))
                        : metric_of<3>(tensor_at<3>(phase.tensor.field, cell.at), normal_of<3>(cell.normal));
    update_cell(&marker);
    markers->push_back(marker);
  }
}

PetscErrorCode SurfaceMarkers::move(double dt, const Field &velocity, std::vector<SurfaceMarker> *markers) {
  PetscFunctionBeginUser;
  {
    EventScope scope(Event::membrane);
    const int parts = row_parts(*box_);
    in_parallel(parts, parts, [&](int part) {
      const Piece piece(markers->size(), part, parts);
      for (std::size_t m = piece.begin; m < piece.end; ++m) {
        SurfaceMarker *marker = &(*markers)[m];
        const auto move = box_->dimension() == 2 ? move_marker<2> : move_marker<3>;
        move(box_->spacing(), dt, velocity, local_cell(*marker), marker);
        update_cell(marker);
      }
    });
    scope.flops(double(markers->size()) * (box_->dimension() == 2 ? 300 : 1200));
  }
  PetscCall(exchange(markers));
  PetscFunctionReturn(0);
}

PetscErrorCode SurfaceMarkers::send_to_owners(std::vector<SurfaceMarker> *markers) const {
  std::vector<int> owners;
  PetscFunctionBeginUser;
  for (const SurfaceMarker &marker : *markers)
    owners.push_back(domain_->owner(marker.cell[0], marker.cell[1], marker.cell[2]));
  PetscCall(send_to_ranks(domain_->comm(), owners, markers));
  PetscFunctionReturn(0);
}

// A rank has at least three cells in every direction, so that it and its neighbours own all cells within three.
PetscErrorCode SurfaceMarkers::exchange(std::vector<SurfaceMarker> *markers) {
  PetscFunctionBeginUser;
  if (!domain_ || domain_->ranks() == 1) {
    all_ = *markers;
    PetscFunctionReturn(0);
  }
  std::vector<int> ranks;
  all_.clear();
  for (const SurfaceMarker &marker : *markers) {
    const Int3 local = local_cell(marker);
    bool inside = true;  // no other rank needs the marker
    for (int d = 0; d < domain_->dimension(); ++d)
      inside = inside && (domain_->processors(d) == 1 || (local[d] >= reach && local[d] + reach < domain_->cells()[d]));
    if (inside) {
      ranks.push_back(domain_->rank());
      all_.push_back(marker);
      continue;
    }
    std::set<int> to;  // owners of corners and middles of the block within reach
    const int reach_z = domain_->dimension() == 3 ? reach : 0;
    for (const int z : {-reach_z, 0, reach_z})
      for (const int y : {-reach, 0, reach})
        for (const int x : {-reach, 0, reach})
          to.insert(domain_->owner(in_domain(0, marker.cell[0] + x), in_domain(1, marker.cell[1] + y),
                                   in_domain(2, marker.cell[2] + z)));
    for (const int rank : to) {
      ranks.push_back(rank);
      all_.push_back(marker);
    }
  }
  PetscCall(send_to_ranks(domain_->comm(), ranks, &all_));
  markers->clear();
  for (const SurfaceMarker &marker : all_)
    if (domain_->owner(marker.cell[0], marker.cell[1], marker.cell[2]) == domain_->rank()) markers->push_back(marker);
  PetscFunctionReturn(0);
}

void SurfaceMarkers::pull_to_surface(const SurfaceCells &surface, const Field &fields, int phase,
                                     std::vector<SurfaceMarker> *markers) const {
  const auto is_far = [&](SurfaceMarker &marker) {
    return marker.phase == phase && !approach(surface, fields, pull_share, &marker);
  };
  markers->erase(std::remove_if(markers->begin(), markers->end(), is_far), markers->end());
}

void SurfaceMarkers::update_phases(const std::vector<Phase> &phases, std::vector<SurfaceMarker> *markers) const {
  const Layout &layout = domain_->layout();
  const int layers_z = domain_->dimension() == 3 ? 1 : 0;
  const auto lost = [&](SurfaceMarker &marker) {
    if (marker.label == 0) return false;
    const Int3 cell = local_cell(marker);
    for (const int beside : {0, 1})  // in general its own cell suffices
      for (std::size_t p = 0; p < phases.size(); ++p) {
        if (!phases[p].material.is_membrane()) continue;
        const double *label = phases[p].label[0].origin + offset_of(layout, cell);
        for (int k = -beside * layers_z; k <= beside * layers_z; ++k)
          for (int j = -beside; j <= beside; ++j)
            for (int i = -beside; i <= beside; ++i)
              if (std::fabs(label[i + j * layout.sy + k * layout.sz] - marker.label) < least_label) {
                marker.phase = static_cast<int>(p);
                return false;
              }
      }
    return true;
  };
  markers->erase(std::remove_if(markers->begin(), markers->end(), lost), markers->end());
}

// Strain of a surface from present and undeformed positions of its markers, (25a).

namespace {

template <int Dim>
constexpr double radius = Dim == 2 ? 2.5 : 2;  // cells, distance of the markers that are used at a surface point
constexpr int reach = SurfaceMarkers::reach;
constexpr double round_off = 1e-9;  // of a metric
template <int Dim>
constexpr int least_count = Dim == 2 ? 5 : 8;  // number of markers: two more than coefficients
constexpr double same_side = 0.3;              // least cosine between normals
constexpr double largest_residual = 0.3;       // cells: rms deviation of undeformed positions from a quadratic

struct Sources {
  const Box *box;
  const SurfaceCells *surface;
  const SurfaceMarker *markers;
  const int *begin;  // first index in marker_of, by offset of the cell from the origin
};

// A marker near a point of the surface.
struct Neighbour {
  const SurfaceMarker *marker;
  Real3 away;     // from the point, length
  double square;  // squared distance in cells
};

// Lists the markers near a cell's surface point that are on the same side of the body. Returns their number.
template <int Dim>
EULASTIC_INLINE int find_neighbours(const Sources &from, const int *marker_of, const SurfaceCells::Cell &cell,
                                    Neighbour *neighbours, int most) {
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
          Neighbour &one = neighbours[count];
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

// Computes B_s at a surface point from undeformed positions of the markers around it and their heights over the plane
// with tangents t, both fitted by quadratics. `nearest`: a marker that identifies body and side. Returns false if the
// markers do not determine it.
template <int Dim, int Values>
EULASTIC_INLINE bool strain_around(const Box &box, const kernels::Vector<Dim> &n, const Neighbour *neighbours,
                                   int count, const SurfaceMarker &nearest, kernels::Tensor<Dim> *B) {
  constexpr int height = Dim, metric = Dim + 1;
  const auto t = kernels::tangents<Dim>(n);
  const Real3 &h = box.spacing();
  const double length = radius<Dim> * std::max({h[0], h[1], Dim == 3 ? h[2] : 0});
  kernels::SurfacePoints<Values> points;
  for (int m = 0; m < count; ++m) {
    const SurfaceMarker &marker = *neighbours[m].marker;
    double cosine = 0, along[2] = {}, up = 0;
    for (int d = 0; d < Dim; ++d) cosine += marker.normal[d] * nearest.normal[d];
    if (marker.label != nearest.label || !(cosine > same_side)) continue;
    for (int a = 0; a < Dim - 1; ++a)
      for (int d = 0; d < Dim; ++d) along[a] += neighbours[m].away[d] * t[a][d];
    for (int d = 0; d < Dim; ++d) up += neighbours[m].away[d] * n[d];
    const double near = 1 - neighbours[m].square / (radius<Dim> * radius<Dim>);
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
  if (points.count < least_count<Dim>) return false;
  points.pad_to_lanes();
  kernels::SurfaceFit<Dim, Values> fit;
  if (!kernels::fit_surface<Dim, Values>(points, &fit)) return false;
  constexpr double most = largest_residual / radius<Dim>;
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
  auto tangent = t;  // tangents of the surface itself
  for (int a = 0; a < Dim - 1; ++a)
    for (int d = 0; d < Dim; ++d) tangent[a][d] += fit.coefficient[1 + a][height] * n[d];
  *B = kernels::project_surface<Dim>(kernels::inverse_in_plane<Dim>(tangent, G), n);
  return true;
}

// Computes B_s at the surface point nearest to a cell; false if the markers do not determine it.
template <int Dim>
EULASTIC_INLINE bool strain_at(const Sources &from, const int *marker_of, const SurfaceCells::Cell &cell, double *B) {
  constexpr int most = kernels::SurfacePoints<Dim>::most;
  Neighbour neighbours[most];
  const int count = find_neighbours<Dim>(from, marker_of, cell, neighbours, most);
  if (count < least_count<Dim>) return false;
  const auto nearer = [](const Neighbour &a, const Neighbour &b) { return a.square < b.square; };
  const SurfaceMarker &nearest = *std::min_element(neighbours, neighbours + count, nearer)->marker;
  bool uniform = true;
  for (int m = 0; m < count; ++m)
    for (int q = 0; q < 6; ++q)
      uniform = uniform && __builtin_fabs(neighbours[m].marker->metric[q] - nearest.metric[q]) < round_off;
  const kernels::Vector<Dim> n = normal_of<Dim>(cell.normal);
  kernels::Tensor<Dim> strain;
  const bool is_found = uniform ? strain_around<Dim, Dim + 1>(*from.box, n, neighbours, count, nearest, &strain)
                                : strain_around<Dim, Dim + 7>(*from.box, n, neighbours, count, nearest, &strain);
  if (!is_found) return false;
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

// Lists the markers whose cell is a nearest cell or beside one, which each rank knows as far as it needs them, in an
// order that does not depend on the ranks.
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
  EventScope scope(Event::membrane);
  sort(surface, phase);
  std::vector<int> marker_of;
  for (const Near &near : near_) marker_of.push_back(near.marker);
  const Sources from{box_, &surface, all_.data(), begin_.data() + box_->layout().origin};
  const int parts = row_parts(*box_);
  std::vector<std::vector<Strain>> found(parts);
  in_parallel(parts, parts, [&](int part) {
    const Piece piece(surface.nearest_count(), part, parts);
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
