#include "bodies/measures.hpp"

#include "base/events.hpp"
#include "base/exact_sum.hpp"
#include "base/send_to_ranks.hpp"
#include "bodies/body_runs.hpp"
#include "bodies/body_sums.hpp"
#include "bodies/unwrap.hpp"
#include "field/boundaries.hpp"
#include "grid/threads.hpp"

#include <petscblaslapack.h>
#include <cmath>

namespace eulastic {
namespace {

constexpr double degrees = 180 / 3.14159265358979323846;
// Order of the sums of one body; second moments xx, yy, zz, yz, xz, xy.
constexpr int first_moment = 1, second_moment = 4, momentum = 10, strain = 13, full_cells = 14, mean_tensor = 15;
constexpr int on_open_side = 21, all_sums = 22, position_sums = 4;
constexpr int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};

// Extends the largest |v_d| on the faces and |energy density| of the cells of a run, and tr B where phi >= 1/2.
void extend_largest(const Box &box, const Run &run, const Field &velocity, const double *density, double *speed,
                    double *energy, double *trace) {
  const auto extend = [&](const double *values, double *most) {
    for (int i = 0; i < run.size(); ++i) *most = std::max(*most, std::abs(values[i]));
  };
  for (int d = 0; d < box.dimension(); ++d) {
    extend(run.of(velocity, d), speed);
    extend(run.of(velocity, d) + velocity[d].stride(d), speed);
  }
  extend(density, energy);
  const double *phi = run.of(run.phase.fraction, 0), *xx = run.of(run.phase.tensor.field, 0),
               *yy = run.of(run.phase.tensor.field, 1),
               *zz = box.dimension() == 3 ? run.of(run.phase.tensor.field, 2) : nullptr;
  for (int i = 0; i < run.size(); ++i)
    if (phi[i] >= 0.5) *trace = std::max(*trace, xx[i] + yy[i] + (zz ? zz[i] : 1));
}

// Returns the sum of phi over cells of a run at open boundaries; `all` is its sum over the whole run.
double at_open_side(const Box &box, const Run &run, double all) {
  const Int3 cell{run.begin, run.j, run.k};
  const auto is_at = [&](int d, int i) {
    const int global = i + box.layout().begin[d];
    return (global == 0 && box.is_open(d, false)) || (global == box.domain_cells()[d] - 1 && box.is_open(d, true));
  };
  for (int d = 1; d < box.dimension(); ++d)
    if (is_at(d, cell[d])) return all;
  const double *phi = run.of(run.phase.fraction, 0);
  double sum = is_at(0, run.begin) ? phi[0] : 0;
  if (run.size() > 1 && is_at(0, run.end - 1)) sum += phi[run.size() - 1];
  return sum;
}

// Sums over all ranks for the owned bodies; add(part, sums) adds the contributions of a part of the owned rows.
// Collective.
template <class Add>
PetscErrorCode sum_bodies(const Box &box, const BodyOwners &owners, const Add &add, BodySums *sums) {
  PetscFunctionBeginUser;
  const int parts = row_parts(box);
  std::vector<BodySums> others(parts - 1, *sums);
  in_parallel(parts, parts, [&](int part) { add(row_part(box, part, parts), part == 0 ? *sums : others[part - 1]); });
  for (const BodySums &some : others) sums->add(some);
  PetscCall(sums->reduce(owners));
  PetscFunctionReturn(0);
}

// Returns the semi-axes, longest first, of the ellipsoid (ellipse) with central second moments M per volume after the
// mean stretch V, B = V V, is undone: V^-1 M V^-1 has the eigenvalues of M x = lambda B x. Components: xx yy zz yz xz
// xy.
Real3 semi_axes(const std::array<double, 6> &M, const std::array<double, 6> &B, int dimension) {
  double m[9], b[9], squares[3] = {}, work[9];  // columns of the lower triangles; squares ascend
  for (int c = 0; c < 6; ++c) {
    const auto [p, q] = pairs[c];
    m[3 * p + q] = M[c];
    b[3 * p + q] = B[c];
  }
  const PetscBLASInt type = 1, n = dimension, stride = 3, size = 9;
  PetscBLASInt info;
  LAPACKsygv_(&type, "N", "L", &n, m, &stride, b, &stride, squares, work, &size, &info);
  Real3 axes{};  // 0 if B is not positive definite
  for (int d = 0; d < dimension && info == 0; ++d)
    axes[d] = std::sqrt((dimension + 2) * std::max(squares[dimension - 1 - d], 0.0));
  return axes;
}

double taylor_deformation(const Real3 &axes, int dimension) {
  const double a = axes[0], c = axes[dimension - 1];
  return a + c > 0 ? (a - c) / (a + c) : 0;
}

// Sets lengths, deformations and inclination from central second moments per volume and the mean of B.
void set_lengths(const std::array<double, 6> &moments, const std::array<double, 6> &B, int dimension,
                 BodyMeasure *body) {
  body->semi_axes = semi_axes(moments, {1, 1, 1, 0, 0, 0}, dimension);
  body->taylor_deformation = taylor_deformation(body->semi_axes, dimension);
  body->rest_deformation = taylor_deformation(semi_axes(moments, B, dimension), dimension);
  const double angle = std::atan2(2 * moments[5], moments[0] - moments[1]) / 2 * degrees;
  body->inclination = angle > -90 ? angle : 90;
}

// Scales of the fixed-point numbers, and the largest tr B of every owned body.
struct Largest {
  double speed = 0, energy = 0;
  std::vector<double> trace;
};

// Finds the scales, the largest tr B of every body, and the energy densities of all rows, by parts. Collective.
PetscErrorCode find_largest(const Domain &domain, const std::vector<Phase> &phases, const Field &velocity,
                            const BodyOwners &owners, const RowEnergy &energy,
                            std::vector<std::vector<double>> *energies, Largest *largest) {
  PetscFunctionBeginUser;
  std::vector<std::vector<double>> found(row_parts(domain), std::vector<double>(2, 0.0)),
      traces(found.size(), std::vector<double>(owners.here().size(), 0.0));
  energies->resize(found.size());
  in_row_parts(domain, [&](const RowPart &part) {
    std::vector<double> &some = found[part.number], &trace_of = traces[part.number],
                        &density = (*energies)[part.number];
    std::vector<double> of_row(domain.cells()[0]);
    for_each_run(
        domain, part, phases, owners,
        [&](const Phase &phase, const Segment &row) {
          energy(domain, phase, row, of_row.data());
          density.insert(density.end(), of_row.begin() + row.i_begin, of_row.begin() + row.i_end);
        },
        [&](const Run &run) {
          extend_largest(domain, run, velocity, of_row.data() + run.begin, &some[0], &some[1], &trace_of[run.body]);
        });
  });
  std::vector<double> most;
  PetscCall(reduce_maxima(domain.comm(), found, &most));
  *largest = {most[0], most[1], std::vector<double>(static_cast<std::size_t>(owners.owned().size()), 0.0)};
  for (const std::vector<double> &some : traces)
    for (std::size_t b = 0; b < some.size(); ++b) traces[0][b] = std::max(traces[0][b], some[b]);
  PetscCall(owners.reduce(1, MPI_MAX, traces[0], &largest->trace));
  PetscFunctionReturn(0);
}

// Adds the contributions of a run, with the given energy densities, to the sums of its body.
void add_run(const Box &box, const Run &run, const RunPlaces &places, const Field &velocity, const double *density,
             double largest_speed, double largest_energy, BodySums *sums) {
  const int b = run.body;
  RunSums of_run;
  sum_run(box, run, places, &velocity, &of_run);
  const double cells = of_run.fraction, x = of_run.first_moment, y = places.y, z = places.z;
  const std::array first{x, cells * y, cells * z};
  const std::array second{of_run.second_moment, cells * (y * y), cells * (z * z), cells * (y * z), x * z, x * y};
  sums->add(b, 0, cells);
  for (int d = 0; d < 3; ++d) sums->add(b, first_moment + d, first[d]);
  for (int c = 0; c < 6; ++c) sums->add(b, second_moment + c, second[c]);
  for (int d = 0; d < box.dimension() && largest_speed > 0; ++d)
    sums->add(b, momentum + d, of_run.momentum[d] / largest_speed);
  if (largest_energy > 0) sums->add(b, strain, lane_sum(density, run.size(), run.first) / largest_energy);
  sums->add(b, full_cells, of_run.full_cells);
  for (int f = 0; f < run.phase.tensor.field.count() && of_run.full_cells > 0; ++f) {
    const auto [p, q, at] = run.phase.tensor.components()[f];
    sums->add(b, mean_tensor + (p == q ? p : 6 - p - q), of_run.tensor[f]);
  }
  if (box.any_open()) sums->add(b, on_open_side, at_open_side(box, run, cells));
}

BodyMeasure evaluate(const Box &box, const BodySums &sums, int b, const Int3 &reference, const Largest &largest) {
  BodyMeasure body;
  const Real3 &h = box.spacing();
  const double cells = sums.value(b, 0);
  body.volume = cells * box.cell_volume();
  body.leaves = box.any_open() && (body.volume == 0 || sums.value(b, on_open_side) > 0);
  Real3 mean{};
  for (int d = 0; d < 3; ++d) {
    mean[d] = cells > 0 ? sums.value(b, first_moment + d) / cells : 0;
    body.centroid[d] = (reference[d] + 0.5 + mean[d]) * h[d];
    body.velocity[d] = cells > 0 ? sums.value(b, momentum + d) / cells * largest.speed : 0;
  }
  body.elastic_energy = sums.value(b, strain) * largest.energy * box.cell_volume();
  body.trace_max = std::max(largest.trace[b], 3.0);  // det B = 1
  if (!(cells > 0)) return body;
  std::array<double, 6> moments{}, B{1, 1, 1, 0, 0, 0};
  const double full = sums.value(b, full_cells);
  for (int c = 0; c < 6; ++c) {
    const int p = pairs[c][0], q = pairs[c][1];
    if (std::max(p, q) >= box.dimension()) continue;
    if (full > 0) B[c] = sums.value(b, mean_tensor + c) / full;
    const double central = sums.value(b, second_moment + c) / cells - mean[p] * mean[q];
    moments[c] = (central - (p == q ? 1.0 / 12 : 0.0)) * h[p] * h[q];
  }
  set_lengths(moments, B, box.dimension(), &body);
  return body;
}

// Measures a body in a box of its own. Only cells with phi > 0 count and positions are relative to the middle of their
// extent, so that the bits do not depend on the extent of the box.
BodyMeasure measure_in_box(const BodyInBox &body, const RowEnergy &energy) {
  const Box &box = *body.box;
  const Phase &phase = *body.phase;
  const Layout &layout = box.layout();
  const Int3 middle = phase.extent(box).middle();
  Int3 reference{};
  for (int d = 0; d < 3; ++d) reference[d] = layout.begin[d] + middle[d];
  struct Piece {
    Run run;
    std::vector<double> energy;
  };
  std::vector<Piece> pieces;
  std::vector<double> density(layout.cells[0]);
  Largest largest{0, 0, {0}};
  for (const Segment &whole : box.rows()) {
    const Segment row = phase.filled(whole);
    energy(box, phase, row, density.data());
    for (int begin = row.i_begin, end; begin < row.i_end; begin = end) {
      const int first = layout.begin[0] + begin;
      end = std::min(row.i_end, begin + ExactSums::block - ExactSums::index_in_block(first));
      const Run run{phase, 0, begin, end, row.j, row.k, first};
      extend_largest(box, run, *body.velocity, density.data() + begin, &largest.speed, &largest.energy,
                     &largest.trace[0]);
      pieces.push_back({run, {density.begin() + begin, density.begin() + end}});
    }
  }
  BodySums sums(1, all_sums);
  for (const Piece &piece : pieces) {
    RunPlaces places;
    for (int i = 0; i < piece.run.size(); ++i) places.x[i] = piece.run.begin + i - middle[0];
    places.y = piece.run.j - middle[1];
    places.z = piece.run.k - middle[2];
    add_run(box, piece.run, places, *body.velocity, piece.energy.data(), largest.speed, largest.energy, &sums);
  }
  BodyMeasure measure = evaluate(box, sums, 0, reference, largest);
  measure.label = body.number;
  measure.species = body.species;
  return measure;
}

}  // namespace

PetscErrorCode BodyTracker::follow(const Domain &domain, const std::vector<Phase> &phases) {
  PetscFunctionBeginUser;
  EventScope scope(Event::bodies);
  BodyOwners owners;
  std::vector<Int3> references;
  PetscCall(connect(domain, phases, {}, &owners, &references));
  BodySums sums(references.size(), position_sums);
  const auto add = [&](const RowPart &part, BodySums &some) {
    for_each_run(
        domain, part, phases, owners, [](const Phase &, const Segment &) {},
        [&](const Run &run) {
          const RunPlaces places = places_of(domain, run, references[run.body]);
          RunSums of_run;
          sum_run(domain, run, places, nullptr, &of_run);
          some.add(run.body, 0, of_run.fraction);
          some.add(run.body, first_moment, of_run.first_moment);
          some.add(run.body, first_moment + 1, of_run.fraction * places.y);
          some.add(run.body, first_moment + 2, of_run.fraction * places.z);
        });
  };
  PetscCall(sum_bodies(domain, owners, add, &sums));
  for (int b = 0; b < owners.owned().size(); ++b)
    for (int d = 0; d < domain.dimension(); ++d) {
      const double mean = sums.value(b, 0) > 0 ? sums.value(b, first_moment + d) / sums.value(b, 0) : 0;
      // A body that fills a periodic direction has the mean -1/2 there; its reference must not move.
      if (std::abs(mean) > 0.75 && std::abs(mean) < 0x1p20) references_[b][d] += static_cast<int>(std::lround(mean));
    }
  PetscFunctionReturn(0);
}

PetscErrorCode BodyTracker::measure(const Domain &domain, const std::vector<Phase> &phases, const Field &velocity,
                                    const RowEnergy &energy, std::vector<BodyMeasure> *result,
                                    const std::vector<BodyInBox> &boxed) {
  PetscFunctionBeginUser;
  EventScope scope(Event::bodies);
  BodyOwners owners;
  std::vector<Int3> references;
  PetscCall(connect(domain, phases, {}, &owners, &references));
  std::vector<std::vector<double>> energies;
  Largest largest;
  PetscCall(find_largest(domain, phases, velocity, owners, energy, &energies, &largest));
  BodySums sums(references.size(), all_sums);
  const auto add = [&](const RowPart &part, BodySums &some) {
    const double *density = energies[part.number].data(), *of_row = nullptr;  // of cell 0 of the row
    const auto start = [&](const Phase &, const Segment &row) {
      of_row = density - row.i_begin;
      density += row.size();
    };
    for_each_run(domain, part, phases, owners, start, [&](const Run &run) {
      add_run(domain, run, places_of(domain, run, references[run.body]), velocity, of_row + run.begin, largest.speed,
              largest.energy, &some);
    });
  };
  PetscCall(sum_bodies(domain, owners, add, &sums));
  result->clear();
  for (int b = 0; b < owners.owned().size(); ++b) {
    result->push_back(evaluate(domain, sums, b, references_[b], largest));
    result->back().label = owners.owned().begin + b + 1;
    result->back().species = species(result->back().label);
  }
  std::vector<BodyMeasure> measured;
  std::vector<int> ranks;
  for (const BodyInBox &body : boxed) {
    measured.push_back(measure_in_box(body, energy));
    ranks.push_back(BodyRange::owner(body.number - 1, bodies(), domain.ranks()));
  }
  PetscCall(send_to_ranks(domain.comm(), ranks, &measured));
  for (const BodyMeasure &body : measured) (*result)[body.label - 1 - owners.owned().begin] = body;
  PetscFunctionReturn(0);
}

void BodyTracker::add_phase(const Domain &domain, const Places &places) {
  const BodyRange own = BodyRange::of(places.count, domain.rank(), domain.ranks());
  for (const NumberedPlace &place : places.known) {
    if (!own.has(place.index)) continue;
    placed_.push_back({first_.back() + place.index, cell_of(domain, place.centre), 0});
  }
  first_.push_back(first_.back() + places.count);
}

// The owners of bodies depend on the number of bodies: sends what is known to the present owners.
PetscErrorCode BodyTracker::give_to_owners(const Domain &domain, std::vector<Known> known) {
  std::vector<int> owners;
  PetscFunctionBeginUser;
  for (const Known &one : known) owners.push_back(BodyRange::owner(one.body, bodies(), domain.ranks()));
  PetscCall(send_to_ranks(domain.comm(), owners, &known));
  std::sort(known.begin(), known.end(), [](const Known &a, const Known &b) { return a.body < b.body; });
  references_.clear();
  for (const Known &one : known) references_.push_back(one.reference);
  if (sent_to_owners_) first_volumes_.clear();
  for (const Known &one : known)
    if (sent_to_owners_) first_volumes_.push_back(one.first_volume);
  PetscFunctionReturn(0);
}

PetscErrorCode BodyTracker::send_placed_to_owners(const Domain &domain) {
  PetscFunctionBeginUser;
  if (sent_to_owners_) PetscFunctionReturn(0);
  PetscCall(give_to_owners(domain, std::move(placed_)));
  sent_to_owners_ = true;
  PetscFunctionReturn(0);
}

PetscErrorCode BodyTracker::add_like(const Domain &domain, int label, const Int3 &shift) {
  PetscFunctionBeginUser;
  PetscCall(send_placed_to_owners(domain));
  const BodyRange own = BodyRange::of(bodies(), domain.rank(), domain.ranks());
  std::vector<Known> known;
  first_volumes_.resize(references_.size());
  for (int b = own.begin; b < own.end; ++b)
    known.push_back({b, references_[b - own.begin], first_volumes_[b - own.begin]});
  if (own.has(label - 1)) {
    Known copy = known[label - 1 - own.begin];
    copy.body = bodies();
    for (int d = 0; d < 3; ++d) copy.reference[d] += shift[d];
    copy.reference = within_box(domain, {copy.reference})[0];
    known.push_back(copy);
  }
  like_.push_back(placed(label));
  PetscCall(give_to_owners(domain, std::move(known)));
  PetscFunctionReturn(0);
}

void BodyTracker::set_like(const std::vector<long> &like) {
  like_.clear();
  for (const long label : like) like_.push_back(placed(static_cast<int>(label)));
}

int BodyTracker::species(int label) const {
  return static_cast<int>(std::lower_bound(first_.begin(), first_.end(), placed(label)) - first_.begin()) - 1;
}

PetscErrorCode BodyTracker::connect(const Domain &domain, const std::vector<Phase> &phases,
                                    const std::vector<int> &more, BodyOwners *owners, std::vector<Int3> *references) {
  std::vector<int> here;
  PetscFunctionBeginUser;
  const auto see = [&](int label) {
    if (label > 0 && label <= bodies() && (here.empty() || here.back() != label - 1)) here.push_back(label - 1);
  };
  for (const int label : more) see(label);
  for (const Phase &phase : phases)
    for (const Segment &whole : phase.label ? domain.rows() : std::vector<Segment>()) {
      const Segment row = phase.rows.within(whole, phase.label[0]);
      for (int i = row.i_begin; i < row.i_end; ++i) see(static_cast<int>(phase.label[0](i, row.j, row.k)));
    }
  std::sort(here.begin(), here.end());
  here.erase(std::unique(here.begin(), here.end()), here.end());
  PetscCall(owners->connect(domain.comm(), bodies(), std::move(here)));
  PetscCall(send_placed_to_owners(domain));
  std::vector<double> owned, brought(3 * owners->here().size());
  for (const Int3 &cell : within_box(domain, references_)) owned.insert(owned.end(), cell.begin(), cell.end());
  PetscCall(owners->bring(3, owned, &brought));
  references->resize(owners->here().size());
  for (std::size_t n = 0; n < brought.size(); ++n) (*references)[n / 3][n % 3] = static_cast<int>(brought[n]);
  PetscFunctionReturn(0);
}

PetscErrorCode BodyTracker::set_last_references(const Domain &domain, const std::vector<std::pair<int, Int3>> &last) {
  std::vector<Known> known;
  std::vector<int> owners;
  PetscFunctionBeginUser;
  PetscCall(send_placed_to_owners(domain));
  for (const auto &[label, cell] : last) {
    known.push_back({label - 1, cell, 0});
    owners.push_back(BodyRange::owner(label - 1, bodies(), domain.ranks()));
  }
  PetscCall(send_to_ranks(domain.comm(), owners, &known));
  const int first = BodyRange::of(bodies(), domain.rank(), domain.ranks()).begin;
  for (const Known &one : known) references_[one.body - first] = one.reference;
  PetscFunctionReturn(0);
}

PetscErrorCode BodyTracker::owned_references(const Domain &domain, std::vector<Int3> *references) {
  PetscFunctionBeginUser;
  PetscCall(send_placed_to_owners(domain));
  *references = references_;
  PetscFunctionReturn(0);
}

void BodyTracker::wrap(const Box &box) { references_ = within_box(box, std::move(references_)); }

PetscErrorCode BodyTracker::known(const Domain &domain, std::vector<Int3> *references,
                                  std::vector<double> *first_volumes) {
  PetscFunctionBeginUser;
  PetscCall(send_placed_to_owners(domain));
  std::vector<double> volumes = first_volumes_;
  volumes.resize(references_.size());
  PetscCall(gather_bodies(domain.comm(), bodies(), bodies(), references_, references));
  PetscCall(gather_bodies(domain.comm(), bodies(), bodies(), volumes, first_volumes));
  PetscFunctionReturn(0);
}

void BodyTracker::set_known(std::vector<Int3> owned_references, std::vector<double> owned_first_volumes) {
  references_ = std::move(owned_references);
  first_volumes_ = std::move(owned_first_volumes);
  placed_.clear();
  sent_to_owners_ = true;
}

}  // namespace eulastic
