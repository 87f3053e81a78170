#include "bodies/rigid.hpp"

#include "field/sides.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

constexpr int images = 27;           // of a body: itself and its neighbours across periodic sides
constexpr double inward = 1e-6;      // in cells
constexpr double shortest = 1e-3;    // of a link, in spacings
constexpr double least_open = 0.03;  // part of the pressure increment that a cut face feels at least

// Image of a body that lies `shift` boxes on.
int image_of(int body, const Int3 &shift) {
  return images * body + (shift[0] + 1) + 3 * (shift[1] + 1) + 9 * (shift[2] + 1);
}

}  // namespace

RigidBuilder::RigidBuilder(const Grid &grid, GhostExchange &exchange) : grid_(grid), exchange_(exchange) {}

PetscErrorCode RigidBuilder::add(const SpeciesSpec &spec, const std::vector<BodyPlace> &places, Phase *phase) {
  PetscFunctionBeginUser;
  const int dimension = grid_.dimension();
  if (!faces_) {
    faces_ = std::make_unique<RigidFaces>();
    for (int a = 0; a < dimension; ++a) inside_[a] = FieldBlock(grid_, 2);
  }
  const int motion = static_cast<int>(faces_->motions.size());
  faces_->motions.push_back(spec.motion);
  faces_->moves = faces_->moves || spec.motion.moves();
  const bool file = spec.shape == Shape::voxels || spec.shape == Shape::state;
  const auto surface = file ? nullptr : std::make_shared<const Surface>(spec, dimension);
  if (file) {
    PetscCall(exchange_.update(phase->fraction, 1));
    fill_wall_ghosts_even(grid_, at_centre, phase->fraction[0], 1);
  }
  const std::size_t count = file ? 1 : places.size();
  for (std::size_t b = 0; b < count; ++b) {
    Source source{surface, nullptr};
    Real3 centre{};
    if (!file) {
      source.body = std::make_unique<PlacedBody>(*surface, grid_.spec(), places[b]);
      centre = source.body->centre();
    }
    for (int image = 0; image < images; ++image) {
      const Int3 shift{image % 3 - 1, image / 3 % 3 - 1, image / 9 - 1};
      Real3 there = centre;
      for (int d = 0; d < dimension; ++d) there[d] -= shift[d] * grid_.cells()[d];
      faces_->bodies.push_back({faces_->count, motion, there});
    }
    for (int a = 0; a < dimension; ++a) {
      if (file)
        mark_file(a, phase->fraction[0], faces_->count);
      else
        mark_body(a, *source.body, faces_->count);
    }
    sources_.push_back(std::move(source));
    ++faces_->count;
  }
  PetscFunctionReturn(0);
}

void RigidBuilder::mark_body(int a, const PlacedBody &body, int index) {
  const Layout &own = grid_.layout();
  std::array<std::vector<PlacedBody::Range>, 3> pieces;
  for (int d = 0; d < 3; ++d) {
    const int first = own.begin[d], last = first + grid_.faces_end(a, d);
    pieces[d] = d < grid_.dimension() && body.ends(d) ? body.ranges(d, first, last)
                                                      : std::vector<PlacedBody::Range>{{first, last, 0}};
  }
  const View inside = inside_[a][0];
  for (const auto &z : pieces[2])
    for (const auto &y : pieces[1])
      for (const auto &x : pieces[0]) {
        const Int3 shift{x.shift / grid_.cells()[0], y.shift / grid_.cells()[1], z.shift / grid_.cells()[2]};
        const double image = 1 + image_of(index, shift);
        for (int k = z.begin; k < z.end; ++k)
          for (int j = y.begin; j < y.end; ++j)
            for (int i = x.begin; i < x.end; ++i) {
              const Int3 local{i - own.begin[0], j - own.begin[1], k - own.begin[2]};
              Real3 place = place_of_face(grid_, a, local[0], local[1], local[2]);
              place[0] += x.shift;
              place[1] += y.shift;
              place[2] += z.shift;
              // A body that begins on a side of the box covers it.
              const int at = own.begin[a] + local[a];
              if (grid_.is_wall(a) && at == 0) place[a] += inward;
              if (grid_.is_wall(a) && at == grid_.cells()[a]) place[a] -= inward;
              double &mark = inside(local[0], local[1], local[2]);
              if (mark == 0 && body.level(place) < 0) mark = image;
            }
      }
}

// Of a file a face is inside where phi, averaged to it, is above 1/2.
void RigidBuilder::mark_file(int a, ConstView phi, int index) {
  const View inside = inside_[a][0], level = inside_[a][1];
  const std::ptrdiff_t step = phi.stride(a);
  for (int k = 0; k < grid_.faces_end(a, 2); ++k)
    for (int j = 0; j < grid_.faces_end(a, 1); ++j)
      for (int i = 0; i < grid_.faces_end(a, 0); ++i) {
        const double *q = phi.row(j, k) + i;
        const double here = 0.5 - 0.5 * (q[0] + q[-step]);
        if (inside(i, j, k) != 0) continue;
        level(i, j, k) = here;
        if (here < 0) inside(i, j, k) = 1 + image_of(index, {0, 0, 0});
      }
}

// Part of the way from a place outside to one inside, in cells of the image's own body, where the surface is.
double RigidBuilder::crossing(int image, const Real3 &outside, const Real3 &inside, double level_outside,
                              double level_inside) const {
  const PlacedBody *body = sources_[image / images].body.get();
  if (!body) return std::max(shortest, level_outside / (level_outside - level_inside));
  const Real3 &centre = faces_->bodies[image].centre, &own = body->centre();
  double low = 0, high = 1;
  for (int step = 0; step < 48; ++step) {
    const double middle = 0.5 * (low + high);
    Real3 place{};
    for (int d = 0; d < 3; ++d) place[d] = outside[d] + middle * (inside[d] - outside[d]) - centre[d] + own[d];
    (body->level(place) < 0 ? high : low) = middle;
  }
  return std::max(shortest, 0.5 * (low + high));
}

// What a fluid face sees of the bodies around it; not cut where it sees none.
RigidFaces::Cut RigidBuilder::cut_at(int a, int i, int j, int k) const {
  const Int3 &N = grid_.cells(), &begin = grid_.layout().begin, local{i, j, k};
  const double *inside = inside_[a][0].row(j, k) + i, *level = inside_[a][1].row(j, k) + i;
  RigidFaces::Cut cut;
  cut.i = i;
  double diagonal = 0, regular = 0;
  Real3 least{}, place{};  // wrapped into the box, like that of the owner
  for (int d = 0; d < grid_.dimension(); ++d) {
    const int g = begin[d] + local[d];
    least[d] = (d == a ? 0 : 0.5) - 0.5 * N[d];
    place[d] = least[d] + (grid_.is_wall(d) ? g : (g % N[d] + N[d]) % N[d]);
  }
  for (int d = 0; d < grid_.dimension(); ++d)
    for (int high = 0; high < 2; ++high) {
      const double h = grid_.spacing()[d], one = high ? 1 : -1;
      const std::ptrdiff_t step = high ? inside_[a][0].stride(d) : -inside_[a][0].stride(d);
      const int link = 2 * d + high, body = static_cast<int>(inside[step]) - 1;
      cut.link[link] = 1 / (h * h);
      regular += cut.link[link];
      if (body >= 0) {
        // The neighbour's own place is in the box: its image may be that of another side.
        Real3 neighbour = place, here = place;
        neighbour[d] += one;
        if (!grid_.is_wall(d) && neighbour[d] < least[d]) neighbour[d] += N[d];
        if (!grid_.is_wall(d) && neighbour[d] > least[d] + N[d] - 1) neighbour[d] -= N[d];
        here[d] = neighbour[d] - one;
        const double part = crossing(body, here, neighbour, level[0], level[step]);
        cut.walls |= 1U << link;
        cut.body = body;
        cut.link[link] /= part;
        here[d] += one * part;
        cut.turn[link] = faces_->velocity(a, faces_->bodies[body], here, grid_.spacing(), 0, 1);
      }
      diagonal += cut.link[link];
    }
  cut.share = std::min(1.0, regular / diagonal);
  cut.open = std::max(least_open, cut.share);
  return cut;
}

RigidFaces::Component RigidBuilder::component(int a, const Int3 &layers) const {
  const Int3 &n = grid_.owned();
  RigidFaces::Component c;
  for (int k = -layers[2]; k < n[2] + layers[2]; ++k)
    for (int j = -layers[1]; j < n[1] + layers[1]; ++j) {
      c.first_cut.push_back(c.cuts.size());
      c.first_run.push_back(c.runs.size());
      const double *inside = inside_[a][0].row(j, k);
      bool all = true;
      for (int i = -layers[0]; i < n[0] + layers[0]; ++i) {
        const int body = static_cast<int>(inside[i]) - 1;
        if (body < 0) {
          all = false;
          if (const RigidFaces::Cut cut = cut_at(a, i, j, k); cut.walls != 0) c.cuts.push_back(cut);
        } else if (c.runs.size() > c.first_run.back() && c.runs.back().end == i && c.runs.back().body == body) {
          ++c.runs.back().end;
        } else {
          c.runs.push_back({i, i + 1, body});
        }
      }
      c.all.push_back(all);
    }
  c.first_cut.push_back(c.cuts.size());
  c.first_run.push_back(c.runs.size());
  return c;
}

PetscErrorCode RigidBuilder::finish(std::unique_ptr<RigidFaces> *faces) {
  PetscFunctionBeginUser;
  faces->reset();
  if (!faces_) PetscFunctionReturn(0);
  Int3 layers{};
  for (int d = 0; d < grid_.dimension(); ++d) layers[d] = grid_.layout().ghosts[d] - 1;
  std::array<RigidFaces::Component, 3> components;
  for (int a = 0; a < grid_.dimension(); ++a) {
    PetscCall(exchange_.update(inside_[a], grid_.layout().ghosts[a]));
    components[a] = component(a, layers);
    for (const RigidFaces::Cut &cut : components[a].cuts) {
      const double along = std::fabs(faces_->motions[faces_->bodies[cut.body].motion].velocity[a]);
      for (const double turn : cut.turn) faces_->speed[a] = std::max(faces_->speed[a], along + std::fabs(turn));
    }
    inside_[a] = {};
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, faces_->speed.data(), 3, MPI_DOUBLE, MPI_MAX, grid_.comm()));
  faces_->set(layers, grid_.owned()[1] + 2 * layers[1], std::move(components));
  *faces = std::move(faces_);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
