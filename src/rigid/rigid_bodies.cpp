#include "rigid/rigid_bodies.hpp"

#include "base/exact_sum.hpp"
#include "base/one_line.hpp"
#include "bodies/fill_phase.hpp"
#include "field/boundaries.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace eulastic {
namespace {

constexpr double inward = 1e-6;      // shift of faces on a boundary into the box, in cells
constexpr double shortest = 1e-3;    // least length of a link, in spacings
constexpr double least_open = 0.03;  // least factor of the pressure increment at a cut face

// The depth below which a face is inside, so that faces on a surface are fluid in spite of round-off.
double depth_inside(const Domain &domain) { return on_surface * domain.domain_shape().shortest_spacing(); }

}  // namespace

// Index of the image of a body that is shifted by `shift` boxes.
int RigidBodies::image_of(int body, const Int3 &shift) {
  return images * body + (shift[0] + 1) + 3 * (shift[1] + 1) + 9 * (shift[2] + 1);
}

RigidBodies::RigidBodies(const Domain &domain, GhostExchange &exchange) : domain_(domain), exchange_(exchange) {}

PetscErrorCode RigidBodies::add(const SpeciesSpec &spec, const Places &places, int first_label, Phase *phase,
                                std::string *wrong) {
  PetscFunctionBeginUser;
  const int dimension = domain_.dimension(), motion = static_cast<int>(faces_.motions.size());
  if (!exist())
    for (int a = 0; a < dimension; ++a) inside_[a] = Field(domain_, 1);
  faces_.motions.push_back(spec.motion);
  faces_.motions.back().travelling = spec.travelling(dimension);
  faces_.motions.back().turning = spec.turns(dimension);
  faces_.moves = faces_.moves || spec.motion.moves();
  faces_.travels = faces_.travels || faces_.motions.back().travels();
  const bool travels = faces_.motions.back().travels(), turns = spec.turns(dimension),
             file = spec.shape == Shape::voxels || spec.shape == Shape::state;
  phase->travels = travels;
  std::shared_ptr<const Surface> surface;
  RigidMass mass;
  if (file && travels) {
    PetscCall(map_file(spec, *phase, &surface, &mass, wrong));
    if (!wrong->empty()) PetscFunctionReturn(0);
  } else if (file) {
    PetscCall(exchange_.update_ghosts(phase->fraction, 1));
    fill_wall_ghosts_even(domain_, at_centre, phase->fraction[0], 1);
  } else {
    surface = std::make_shared<const Surface>(spec, dimension);
  }
  if (turns && !file)
    mass = moments(*surface, dimension);
  else if (spec.motion.moves() && !file)
    mass.volume = volume_in_box(spec, domain_.domain_shape());
  species_.push_back({spec, file ? Places{{spec.centre, {}}} : places, first_label, surface, mass});
  for (const NumberedPlace &place : species_.back().places.known) {
    const int index = faces_.count++;
    for (int image = 0; image < images; ++image) faces_.bodies.push_back({index, motion, {}});
    faces_.masses.push_back(mass);
    sources_.push_back({surface, nullptr, nullptr, place});
    set_position(index, place);
    for (int a = 0; a < dimension && !travels; ++a) {
      if (file)
        mark_file(a, phase->fraction[0], index);
      else
        mark(a, index);
    }
  }
  PetscFunctionReturn(0);
}

// Calls visit(mark, image, place) for the owned faces of component a that the body may reach. `mark` is the value in
// inside_.
template <class Visit>
void RigidBodies::for_faces(int a, int index, const Visit &visit) {
  const Layout &own = domain_.layout();
  const PlacedBody &body = *sources_[index].body;
  std::array<std::vector<PlacedBody::Range>, 3> pieces;
  for (int d = 0; d < 3; ++d) {
    const int first = own.begin[d], last = first + domain_.points_end(d, a == d);
    pieces[d] = d < domain_.dimension() && body.ends(d) ? body.ranges(d, first, last)
                                                        : std::vector<PlacedBody::Range>{{first, last, 0}};
  }
  const View inside = inside_[a][0];
  for (const auto &z : pieces[2])
    for (const auto &y : pieces[1])
      for (const auto &x : pieces[0]) {
        const Int3 shift{x.shift / domain_.domain_cells()[0], y.shift / domain_.domain_cells()[1],
                         z.shift / domain_.domain_cells()[2]};
        const int image = image_of(index, shift);
        for (int k = z.begin; k < z.end; ++k)
          for (int j = y.begin; j < y.end; ++j)
            for (int i = x.begin; i < x.end; ++i) {
              const Int3 local{i - own.begin[0], j - own.begin[1], k - own.begin[2]};
              Real3 place = face_position(domain_, a, local[0], local[1], local[2]);
              place[0] += x.shift;
              place[1] += y.shift;
              place[2] += z.shift;
              // Shift faces on a boundary inwards, so that a body that begins on the boundary covers them.
              const int at = own.begin[a] + local[a];
              if (domain_.is_wall(a) && at == 0) place[a] += inward;
              if (domain_.is_wall(a) && at == domain_.domain_cells()[a]) place[a] -= inward;
              visit(inside(local[0], local[1], local[2]), image, place);
            }
      }
}

void RigidBodies::mark(int a, int index) {
  const PlacedBody &body = *sources_[index].body;
  const double depth = depth_inside(domain_);
  for_faces(a, index, [&](double &mark, int image, const Real3 &place) {
    if (!(body.level(place) < -depth)) return;
    if (mark == 0)
      mark = 1 + image;
    else
      note_contact(static_cast<int>(mark) - 1, image);
  });
}

void RigidBodies::clear(int a, int index) {
  for_faces(a, index, [&](double &mark, int, const Real3 &) {
    if (mark != 0 && (static_cast<int>(mark) - 1) / images == index) mark = 0;
  });
}

// Corrects the volume of a travelling slab by the share that the bodies along which it slides leave to it.
PetscErrorCode RigidBodies::measure_pistons() {
  PetscFunctionBeginUser;
  const double depth = depth_inside(domain_);
  // Faces normal to its axis: all in the slab, and those marked as its own.
  std::vector<double> counted(2 * faces_.count);
  for (int index = 0; index < faces_.count; ++index) {
    const Species &species = species_[faces_.bodies[images * index].motion];
    if (species.spec.shape != Shape::slab || !species.spec.travels(domain_.dimension())) continue;
    const PlacedBody &body = *sources_[index].body;
    for_faces(species.spec.axis, index, [&](const double &mark, int, const Real3 &place) {
      if (!(body.level(place) < -depth)) return;
      ++counted[2 * index];
      counted[2 * index + 1] += mark != 0 && (static_cast<int>(mark) - 1) / images == index;
    });
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, counted.data(), 2 * faces_.count, MPI_DOUBLE, MPI_SUM, domain_.comm()));
  for (int index = 0; index < faces_.count; ++index)
    if (counted[2 * index] > 0)
      faces_.masses[index].volume =
          species_[faces_.bodies[images * index].motion].mass.volume * (counted[2 * index + 1] / counted[2 * index]);
  PetscFunctionReturn(0);
}

// Records a contact of two bodies, except for that of a piston with the tube or the plates along which it slides.
void RigidBodies::note_contact(int image, int other) {
  const RigidBody &one = faces_.bodies[image], &two = faces_.bodies[other];
  if (one.index == two.index || !(faces_.motions[one.motion].travels() || faces_.motions[two.motion].travels())) return;
  const SpeciesSpec &first = species_[one.motion].spec, &second = species_[two.motion].spec;
  if (first.shape == Shape::slab && second.slides(first.axis)) return;
  if (second.shape == Shape::slab && first.slides(second.axis)) return;
  contact_ = std::max(contact_, {std::min(one.index, two.index), std::max(one.index, two.index)});
}

// Number of periods from the nearest image of a body to a face at `way` cells from the body; the seam half a period
// away belongs to one side, so that a shift of the scene does not change it.
double RigidBodies::periods(int d, double way) const {
  return domain_.is_wall(d) ? 0 : std::floor(way / domain_.domain_cells()[d] + 0.5);
}

// Marks the faces inside a body from a file, those where phi, averaged to the face, is above 1/2, with its nearest
// image.
void RigidBodies::mark_file(int a, ConstView phi, int index) {
  if (!level_[a]) level_[a] = Field(domain_, 1);
  const View inside = inside_[a][0], level = level_[a][0];
  const std::ptrdiff_t step = phi.stride(a);
  const Real3 &centre = faces_.bodies[image_of(index, {0, 0, 0})].centre;
  for_points(domain_.points(at_face[a]), [&](int i, int j, int k) {
    const double *q = phi.row(j, k) + i;
    const double value = 0.5 - 0.5 * (q[0] + q[-step]);
    if (inside(i, j, k) != 0) return;
    level(i, j, k) = value;
    if (value >= 0) return;
    const Real3 place = face_position(domain_, a, i, j, k);
    Int3 shift{};
    for (int d = 0; d < domain_.dimension(); ++d) shift[d] = -static_cast<int>(periods(d, place[d] - centre[d]));
    inside(i, j, k) = 1 + image_of(index, shift);
  });
}

// Fraction of the link from a place outside to one inside the image at which the surface is, at least `shortest`.
double RigidBodies::crossing(int image, const Real3 &outside, const Real3 &inside, double level_outside,
                             double level_inside) const {
  const Source &source = sources_[image / images];
  const PlacedBody *body = source.before ? source.before.get() : source.body.get();
  if (!body) return std::max(shortest, level_outside / (level_outside - level_inside));
  const Real3 &centre = faces_.bodies[image].centre, &own = body->centre();
  const Real3 &ahead = faces_.ahead[faces_.bodies[image].motion];
  double low = 0, high = ahead == Real3{} && !source.before ? 1 : 2;
  for (int step = 0; step < 48; ++step) {
    const double middle = 0.5 * (low + high);
    Real3 place{};
    for (int d = 0; d < 3; ++d)
      place[d] = outside[d] + middle * (inside[d] - outside[d]) - centre[d] + own[d] + ahead[d];
    (body->level(place) < 0 ? high : low) = middle;
  }
  return std::max(shortest, 0.5 * (low + high));
}

// Classifies a fluid face: lengths and surface velocities of its links, and its share. walls = 0 if no neighbour is
// inside.
RigidFaces::Cut RigidBodies::cut_at(int a, int i, int j, int k) {
  const Int3 &N = domain_.domain_cells(), &begin = domain_.layout().begin, local{i, j, k};
  const double *inside = inside_[a][0].row(j, k) + i;
  const double *level = level_[a] ? level_[a][0].row(j, k) + i : nullptr;
  const auto travels = [this](int body) { return faces_.motions[faces_.bodies[body].motion].travels(); };
  RigidFaces::Cut cut;
  cut.i = i;
  double diagonal = 0, regular = 0;
  Real3 least{}, place{};  // wrapped into the box, so that all ranks get the same bits
  for (int d = 0; d < domain_.dimension(); ++d) {
    least[d] = (d == a ? 0 : 0.5) - 0.5 * N[d];
    place[d] = least[d] + domain_.image(d, begin[d] + local[d]);
  }
  for (int d = 0; d < domain_.dimension(); ++d)
    for (int high = 0; high < 2; ++high) {
      const double h = domain_.spacing()[d], one = high ? 1 : -1;
      const std::ptrdiff_t step = high ? inside_[a][0].stride(d) : -inside_[a][0].stride(d);
      const int link = 2 * d + high, body = static_cast<int>(inside[step]) - 1;
      cut.link[link] = 1 / (h * h);
      regular += cut.link[link];
      if (body >= 0) {
        // The neighbour's place is wrapped into the box, and the face's place is the one beside it.
        Real3 neighbour = place, beside = place;
        neighbour[d] += one;
        if (!domain_.is_wall(d) && neighbour[d] < least[d]) neighbour[d] += N[d];
        if (!domain_.is_wall(d) && neighbour[d] > least[d] + N[d] - 1) neighbour[d] -= N[d];
        beside[d] = neighbour[d] - one;
        const double part = crossing(body, beside, neighbour, level ? level[0] : 0, level ? level[step] : 0);
        if (cut.walls != 0) note_contact(cut.body, body);
        if (cut.walls == 0 || !travels(cut.body)) cut.body = body;
        cut.walls |= 1U << link;
        cut.of_link[link] = body;
        cut.link[link] /= part;
        Real3 surface = beside;
        surface[d] += one * part;
        for (int e = 0; e < domain_.dimension(); ++e) surface[e] += faces_.ahead[faces_.bodies[body].motion][e];
        cut.turn[link] = faces_.velocity(a, faces_.bodies[body], surface, domain_.spacing(), 0, 1);
      }
      diagonal += cut.link[link];
    }
  cut.share = std::min(1.0, regular / diagonal);
  cut.open = std::max(least_open, cut.share);
  return cut;
}

// Builds the rows of component a. Cut faces are in or beside the marked part of their row or of the rows around it.
RigidFaces::Component RigidBodies::component(int a, const Int3 &layers) {
  struct Span {
    int begin, end;
  };
  const Int3 &n = domain_.cells(), &ghosts = domain_.layout().ghosts;
  const View inside = inside_[a][0];
  const int first = -ghosts[0], last = n[0] + ghosts[0], rows = n[1] + 2 * ghosts[1];
  std::vector<Span> marked;
  for (int k = -ghosts[2]; k < n[2] + ghosts[2]; ++k)
    for (int j = -ghosts[1]; j < n[1] + ghosts[1]; ++j) {
      const double *row = inside.row(j, k);
      Span span{first, last};
      while (span.begin < span.end && row[span.begin] == 0) ++span.begin;
      while (span.begin < span.end && row[span.end - 1] == 0) --span.end;
      marked.push_back(span);
    }
  RigidFaces::Component c;
  for (int k = -layers[2]; k < n[2] + layers[2]; ++k)
    for (int j = -layers[1]; j < n[1] + layers[1]; ++j) {
      c.first_cut.push_back(c.cuts.size());
      c.first_run.push_back(c.runs.size());
      const std::size_t at = (j + ghosts[1]) + std::size_t(rows) * (k + ghosts[2]);
      Span span = marked[at];
      const auto join = [&](const Span &other) {
        if (other.begin == other.end) return;
        span = span.begin == span.end ? other : Span{std::min(span.begin, other.begin), std::max(span.end, other.end)};
      };
      join(marked[at - 1]);
      join(marked[at + 1]);
      if (ghosts[2] > 0) {
        join(marked[at - rows]);
        join(marked[at + rows]);
      }
      c.all.push_back(span.begin < span.end && span.begin <= -layers[0] && span.end >= n[0] + layers[0]);
      if (span.begin == span.end) continue;
      const double *row = inside.row(j, k);
      for (int i = std::max(span.begin - 1, -layers[0]); i < std::min(span.end + 1, n[0] + layers[0]); ++i) {
        const int body = static_cast<int>(row[i]) - 1;
        if (body < 0) {
          c.all.back() = false;
          if (const RigidFaces::Cut cut = cut_at(a, i, j, k); cut.walls != 0) c.cuts.push_back(cut);
        } else if (c.runs.size() > c.first_run.back() && c.runs.back().end == i && c.runs.back().body == body) {
          ++c.runs.back().end;
        } else {
          c.runs.push_back({i, i + 1, body});
        }
      }
    }
  c.first_cut.push_back(c.cuts.size());
  c.first_run.push_back(c.runs.size());
  return c;
}

std::size_t RigidBodies::bytes() const {
  std::size_t sum = faces_.bytes();
  for (const Species &species : species_) sum += species.surface ? species.surface->bytes() : 0;
  for (int a = 0; a < 3; ++a) sum += inside_[a].bytes() + level_[a].bytes();
  return sum;
}

// The volume between the surface of bodies at rest and the faces inside them.

// Index of the body of a species with this label; bodies of a species have consecutive labels and indices.
int RigidBodies::index_of(const std::string &species, int label) const {
  for (std::size_t index = 0; index < sources_.size(); ++index) {
    const Species &own = species_[faces_.bodies[images * index].motion];
    if (own.spec.name == species) return static_cast<int>(index) + label - own.first_label;
  }
  return -1;
}

// Each cell adds half of its solid fraction to both of its faces of a component. A fluid face has this volume in
// excess; a face inside lacks the fluid part of the cell. Where bodies overlap, only one of them counts.
PetscErrorCode RigidBodies::measure_gaps(const std::vector<Phase> &phases) {
  PetscFunctionBeginUser;
  if (!exist()) PetscFunctionReturn(0);
  constexpr int per_component = 4, per_body = 3 * per_component;
  const int dimension = domain_.dimension(), cells = domain_.cells()[0];
  ExactSums sums(per_body * faces_.count);
  faces_.footprints.clear();
  const auto add = [&](int image, int a, const Int3 &cell, int high, double part, bool nearest) {
    const int index = faces_.bodies[image].index, side = domain_.layout().begin[a] + cell[a] + high;
    Int3 face = cell;
    face[a] += high;
    const Real3 place = face_position(domain_, a, face[0], face[1], face[2]);
    if (domain_.is_wall(a) && (side == 0 || side == domain_.domain_cells()[a]))
      faces_.footprints.push_back({cell, a, high > 0, image, 2 * part});
    const PlacedBody *body = sources_[index].body.get();
    const Real3 &centre = faces_.bodies[image].centre;
    sums.add(per_body * index + per_component * a, part);
    for (int d = 0; d < dimension; ++d) {
      double arm = place[d] - centre[d];
      if (nearest && (!body || body->ends(d))) arm -= domain_.domain_cells()[d] * periods(d, arm);
      sums.add(per_body * index + per_component * a + 1 + d, part * arm * domain_.spacing()[d]);
    }
  };
  const auto rests = [&](const Phase &phase) { return phase.material.is_rigid() && !phase.travels; };
  std::array<std::vector<int>, 2> beside{std::vector<int>(cells), std::vector<int>(cells)};
  for (const Segment &row : domain_.rows())
    for (int a = 0; a < dimension; ++a) {
      for (const int high : {0, 1}) {
        faces_.find_bodies_beside(a, high > 0, row.j, row.k, &beside[high]);
        for (int &image : beside[high])
          if (image >= 0 && faces_.motions[faces_.bodies[image].motion].travels()) image = -1;
      }
      for (int i = 0; i < cells; ++i) {
        double solid = 0;
        for (const Phase &phase : phases)
          if (rests(phase)) solid += phase.fraction[0](i, row.j, row.k);
        const double fluid = 1 - std::min(1.0, solid);
        if (solid == 0 && beside[0][i] < 0 && beside[1][i] < 0) continue;
        for (const int high : {0, 1}) {
          const Int3 cell{i, row.j, row.k};
          if (beside[high][i] >= 0) {
            if (fluid > 0) add(beside[high][i], a, cell, high, -0.5 * fluid, false);
            continue;
          }
          for (const Phase &phase : phases) {
            const double part = rests(phase) ? phase.fraction[0](i, row.j, row.k) : 0;
            const int index =
                part > 0 && phase.label ? index_of(phase.species, int(phase.label[0](i, row.j, row.k))) : -1;
            if (index >= 0 && index < faces_.count)
              add(image_of(index, {0, 0, 0}), a, cell, high, 0.5 * part * std::min(1.0, 1 / solid), true);
          }
        }
      }
    }
  std::vector<double> total(per_body * faces_.count);
  PetscCall(sums.reduce(domain_.comm(), total.data()));
  set_gaps(total);
  PetscCall(measure_pistons());
  PetscFunctionReturn(0);
}

// Sets faces_.gaps from volume and first moments, in cells, of each component of each body.
void RigidBodies::set_gaps(const std::vector<double> &moments) {
  faces_.gaps.assign(faces_.count, {});
  const double *found = moments.data();
  for (RigidGap &gap : faces_.gaps)
    for (int a = 0; a < 3; ++a, found += 4) {
      gap.volume[a] = found[0] * domain_.cell_volume();
      for (int d = 0; d < 3; ++d) gap.first[a][d] = found[1 + d] * domain_.cell_volume();
    }
}

// Positions of bodies at a time.

namespace {

constexpr double most_lost = 0.05;  // largest relative loss of volume of a travelling body from a file

}  // namespace

// Builds the surface of a travelling body from a file on all ranks, from its phi.
PetscErrorCode RigidBodies::map_file(const SpeciesSpec &spec, const Phase &phase,
                                     std::shared_ptr<const Surface> *surface, RigidMass *mass, std::string *wrong) {
  PetscFunctionBeginUser;
  const int dimension = domain_.dimension();
  const Int3 &N = domain_.domain_cells(), &begin = domain_.layout().begin;
  std::array<int, 6> ends{N[0], N[1], N[2], 1, 1, 1};  // first cells, and minus the last ones
  for_points(domain_.rows(), [&](int i, int j, int k) {
    const Int3 local{i, j, k};
    for (int d = 0; d < 3 && phase.fraction[0](i, j, k) > 0; ++d) {
      ends[d] = std::min(ends[d], begin[d] + local[d]);
      ends[3 + d] = std::min(ends[3 + d], -(begin[d] + local[d]));
    }
  });
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, ends.data(), 6, MPI_INT, MPI_MIN, domain_.comm()));
  FractionBox box;
  box.size = {1, 1, 1};
  std::ptrdiff_t count = 1;
  Int3 first{};
  for (int d = 0; d < dimension; ++d) {
    if (ends[d] == 0 || -ends[3 + d] == N[d] - 1)
      *wrong = "-" + spec.name + "_voxels: " + spec.voxels.path + " reaches the boundaries of the box along " +
               "xyz"[d] + ", and a body that moves needs fluid around it; accepted: a cell of fluid, or no motion";
    first[d] = ends[d] - LevelMap::margin;
    box.size[d] = -ends[3 + d] - ends[d] + 1 + 2 * LevelMap::margin;
    box.spacing[d] = domain_.spacing()[d];
    box.first[d] = (first[d] + 0.5) * domain_.spacing()[d] - spec.centre[d];
    count *= box.size[d];
  }
  if (!wrong->empty()) PetscFunctionReturn(0);
  box.fraction.resize(count);
  for_points(domain_.rows(), [&](int i, int j, int k) {
    const double phi = phase.fraction[0](i, j, k);
    if (phi > 0)
      box.fraction[(begin[0] + i - first[0]) +
                   box.size[0] *
                       ((begin[1] + j - first[1]) + std::ptrdiff_t(box.size[1]) * (begin[2] + k - first[2]))] = phi;
  });
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, box.fraction.data(), static_cast<int>(count), MPI_DOUBLE, MPI_SUM, domain_.comm()));
  *surface = std::make_shared<const Surface>(LevelMap(box, dimension));
  *mass = moments(**surface, dimension);
  const double cells = std::accumulate(box.fraction.begin(), box.fraction.end(), 0.0),
               found_cells = mass->volume / domain_.cell_volume();
  if (std::fabs(found_cells - cells) > most_lost * cells) {
    *wrong = "-" + spec.name + "_voxels: " + spec.voxels.path +
             print(
                 " moves and must be three cells thick to be resolved: it would have %.4g cells instead of %.4g; "
                 "accepted: a finer grid, or no motion",
                 found_cells, cells);
  }
  PetscFunctionReturn(0);
}

// Places a body and its images.
void RigidBodies::set_position(int index, const BodyPlace &place) {
  Source &source = sources_[index];
  Real3 centre{};
  for (int d = 0; d < domain_.dimension(); ++d)
    centre[d] = (place.centre[d] - domain_.domain_shape().length[d] / 2) / domain_.spacing()[d];
  if (source.surface) {
    source.body = std::make_unique<PlacedBody>(*source.surface, domain_.domain_shape(), place);
    centre = source.body->centre();
  } else {
    for (int d = 0; d < domain_.dimension(); ++d) centre[d] -= domain_.domain_cells()[d] * periods(d, centre[d]);
  }
  const int motion = faces_.bodies[images * index].motion;
  if (faces_.motions[motion].turning) faces_.masses[index] = species_[motion].mass.turned(rotation(place.orientation));
  for (int image = 0; image < images; ++image) {
    const Int3 shift{image % 3 - 1, image / 3 % 3 - 1, image / 9 - 1};
    Real3 &image_centre = faces_.bodies[images * index + image].centre;
    image_centre = centre;
    for (int d = 0; d < domain_.dimension(); ++d) image_centre[d] -= shift[d] * domain_.domain_cells()[d];
  }
}

// The place at a time, wrapped into the box in periodic directions.
BodyPlace RigidBodies::position_at(const BodyPlace &start, const RigidMotion &motion, double time) const {
  BodyPlace place = start;
  const Real3 shift = motion.shift(time);
  place.orientation = turned(start.orientation, motion.angle(time));
  for (int d = 0; d < domain_.dimension(); ++d) {
    const double length = domain_.domain_shape().length[d];
    place.centre[d] += shift[d];
    if (shift[d] != 0 && !domain_.is_wall(d)) place.centre[d] -= length * std::floor(place.centre[d] / length);
  }
  return place;
}

PetscErrorCode RigidBodies::find_faces(double time, double surface_time) {
  PetscFunctionBeginUser;
  contact_ = {};
  faces_.ahead.assign(faces_.motions.size(), {});
  for (std::size_t m = 0; m < faces_.ahead.size(); ++m)
    for (int d = 0; d < domain_.dimension(); ++d) {
      const RigidMotion &motion = faces_.motions[m];
      faces_.ahead[m][d] = (motion.shift(time)[d] - motion.shift(surface_time)[d]) / domain_.spacing()[d];
    }
  for (int index = 0; index < faces_.count; ++index) {
    const RigidMotion &motion = faces_.motions[faces_.bodies[images * index].motion];
    if (!motion.travels()) continue;
    for (int a = 0; a < domain_.dimension(); ++a) clear(a, index);
  }
  for (int index = 0; index < faces_.count; ++index) {
    const RigidMotion &motion = faces_.motions[faces_.bodies[images * index].motion];
    if (!motion.travels()) continue;
    Source &source = sources_[index];
    BodyPlace place = position_at(source.start, motion, time);
    set_position(index, place);
    if (motion.turning && surface_time != time) {
      place.orientation = position_at(source.start, motion, surface_time).orientation;
      source.before = std::make_unique<PlacedBody>(*source.surface, domain_.domain_shape(), place);
    } else {
      source.before.reset();
    }
    for (int a = 0; a < domain_.dimension(); ++a) mark(a, index);
  }
  Int3 layers{};
  for (int d = 0; d < domain_.dimension(); ++d) layers[d] = domain_.layout().ghosts[d] - 1;
  std::array<RigidFaces::Component, 3> components;
  faces_.speed = {};
  for (int a = 0; a < domain_.dimension(); ++a) {
    PetscCall(exchange_.update_ghosts(inside_[a], domain_.layout().ghosts[a]));
    if (level_[a]) PetscCall(exchange_.update_ghosts(level_[a], domain_.layout().ghosts[a]));
    components[a] = component(a, layers);
    for (const RigidFaces::Cut &cut : components[a].cuts) {
      for (int link = 0; link < 6; ++link) {
        if (!(cut.walls >> link & 1U)) continue;
        const double along = std::fabs(faces_.motions[faces_.bodies[cut.of_link[link]].motion].velocity[a]);
        faces_.speed[a] = std::max(faces_.speed[a], along + std::fabs(cut.turn[link]));
      }
    }
    if (travel()) continue;
    inside_[a] = {};
    level_[a] = {};
  }
  const double count = faces_.count;  // encodes the pair in one number, so that all ranks report the same pair
  std::array<double, 4> most{faces_.speed[0], faces_.speed[1], faces_.speed[2], contact_[0] * count + contact_[1]};
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, most.data(), 4, MPI_DOUBLE, MPI_MAX, domain_.comm()));
  std::copy_n(most.begin(), 3, faces_.speed.begin());
  faces_.set(layers, domain_.cells()[1] + 2 * layers[1], std::move(components));
  contact_message_.clear();
  if (most[3] != 0)
    report_contact({static_cast<int>(most[3] / count), static_cast<int>(std::fmod(most[3], count))}, time);
  PetscFunctionReturn(0);
}

void RigidBodies::report_contact(const std::array<int, 2> &bodies, double time) {
  const auto species = [&](int index) { return species_[faces_.bodies[images * index].motion].spec; };
  const SpeciesSpec first = species(bodies[0]), second = species(bodies[1]),
                    mover = first.travels(domain_.dimension()) ? first : second;
  contact_message_ = print(
      "-%s_%svelocity: two rigid bodies (%s and %s) come within a cell of each other at t = %.6g; accepted: "
      "paths with fluid between the bodies",
      mover.name.c_str(), mover.turns(domain_.dimension()) ? "angular_" : "", first.name.c_str(), second.name.c_str(),
      time);
}

PetscErrorCode RigidBodies::fill(double time, std::vector<Phase> *phases) const {
  PetscFunctionBeginUser;
  for (std::size_t s = 0; s < species_.size(); ++s)
    for (Phase &phase : *phases) {
      const RigidMotion &motion = faces_.motions[s];
      if (!motion.travels() || phase.species != species_[s].spec.name) continue;
      Places places = species_[s].places;
      for (BodyPlace &place : places.known) place = position_at(place, motion, time);
      Phase filled;
      fill_bodies(domain_, *species_[s].surface, places, species_[s].first_label, &filled);
      phase.fraction = std::move(filled.fraction);
      if (phase.label) phase.label = std::move(filled.label);
    }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
