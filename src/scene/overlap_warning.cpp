#include "base/one_line.hpp"
#include "scene/scene_warnings.hpp"

#include "base/send_to_ranks.hpp"
#include "bodies/near_places.hpp"
#include "bodies/overlap.hpp"
#include "bodies/shapes.hpp"
#include "grid/domain.hpp"
#include "io/fail_together.hpp"
#include "scene/voxels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

namespace eulastic {
namespace {

const SpeciesSpec &species_of(const Config &config, int label) {
  const std::vector<int> first = first_labels(config.species, config.places);
  std::size_t s = 0;
  while (label >= first[s + 1]) ++s;
  return config.species[s];
}

// Pairs at the same place come before all others, and none at all comes last.
bool is_before(const Overlap &one, const Overlap &two) {
  const auto order = [](const Overlap &pair) {
    return std::make_tuple(pair.body == 0, !pair.same_place, pair.body, pair.other);
  };
  return order(one) < order(two);
}

// The option that says where the bodies of a species are.
std::string remedy(const SpeciesSpec &spec) {
  const std::string option = "-" + spec.name + "_";
  if (spec.placement == Placement::list)
    return "correct " + option + "positions, or use " + option + "placement random";
  if (spec.placement == Placement::lattice)
    return "fewer of them (" + option + "count), or " + option + "placement random";
  return "correct " + option + (spec.shape == Shape::slab ? "interval" : "centre");
}

std::string describe(const Config &config, const Overlap &first, long count) {
  const SpeciesSpec &one = species_of(config, first.body), &two = species_of(config, first.other);
  const auto volume = [&](const SpeciesSpec &spec) {
    return spec.shape == Shape::voxels ? std::numeric_limits<double>::infinity() : volume_in_box(spec, config.grid);
  };
  const bool moves_two = !two.material().anchored && two.shape != Shape::voxels, of_one = volume(one) < volume(two);
  return print(
             "%ld bodies overlap as placed; first body %d (%s) and body %d (%s), which share %s of at least %.3g, "
             "%.3g %% of body %d; ",
             count, first.body, one.name.c_str(), first.other, two.name.c_str(),
             config.grid.dimension() == 2 ? "an area" : "a volume", first.volume,
             100 * first.volume / std::min(volume(one), volume(two)), of_one ? first.body : first.other) +
         remedy(moves_two ? two : one);
}

// Bodies near this rank and those of a species from a file. `overlaps`: labels, in any order.
PetscErrorCode compare_with_file(MPI_Comm comm, const Config &config, const CellWindow &cells,
                                 const std::vector<Places> &near, std::size_t file, std::vector<int> *overlaps,
                                 Overlap *first) {
  PetscFunctionBeginUser;
  struct Record {
    int label;
    SharedVolume shared;
  };
  const SpeciesSpec &solid = config.species[file];
  const std::vector<int> label = first_labels(config.species, config.places);
  int ranks;
  std::vector<std::map<int, SharedVolume>> shared(config.species.size());
  std::vector<Record> records;
  std::vector<int> owners;
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  const auto add = [&](const CellWindow &window, ConstView fraction) {
    for (std::size_t s = 0; s < config.species.size(); ++s) {
      const SpeciesSpec &spec = config.species[s];
      if (spec.shape == Shape::voxels || spec.placement == Placement::random) continue;
      if (spec.material().anchored && solid.material().anchored) continue;
      add_shared(spec, near[s], config.grid, window, fraction, &shared[s]);
    }
  };
  PetscCall(fail_together(comm, read_voxels(solid, config.grid, cells, add)));
  for (std::size_t s = 0; s < config.species.size(); ++s)
    for (const auto &[body, with] : shared[s]) {
      records.push_back({label[s] + body, with});
      owners.push_back(BodyRange::owner(label[s] + body - 1, label.back() - 1, ranks));
    }
  PetscCall(send_to_ranks(comm, owners, &records));
  double cell = std::ldexp(1.0, -30);
  for (int d = 0; d < config.grid.dimension(); ++d) cell *= config.grid.spacing(d);
  std::map<int, SharedVolume> sums;
  for (const Record &record : records) {
    SharedVolume &sum = sums[record.label];
    sum.volume += record.shared.volume;
    sum.overlaps = sum.overlaps || record.shared.overlaps;
  }
  for (const auto &[body, sum] : sums) {
    if (!sum.overlaps) continue;
    overlaps->insert(overlaps->end(), {body, label[file]});
    const auto [one, two] = std::minmax({body, label[file]});
    const Overlap pair{one, two, cell * double(sum.volume)};
    if (is_before(pair, *first)) *first = pair;
  }
  PetscFunctionReturn(0);
}

std::string describe_same_place(const Config &config, const Overlap &pair) {
  const SpeciesSpec &one = species_of(config, pair.body), &two = species_of(config, pair.other);
  return "-species " + two.name + ": body " + std::to_string(pair.other) + " is at the same place as body " +
         std::to_string(pair.body) + " (" + one.name +
         "), periodic images included; accepted: bodies apart from each other: " + remedy(two);
}

// How many bodies ranks have named, each once.
PetscErrorCode count_bodies(MPI_Comm comm, int bodies, std::vector<int> *labels, long *count) {
  int ranks;
  std::vector<int> owners;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  for (const int label : *labels) owners.push_back(BodyRange::owner(label - 1, bodies, ranks));
  PetscCall(send_to_ranks(comm, owners, labels));
  *count = static_cast<long>(std::set<int>(labels->begin(), labels->end()).size());
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, count, 1, MPI_LONG, MPI_SUM, comm));
  PetscFunctionReturn(0);
}

// The first of the pairs that ranks have found, those at the same place before all others.
PetscErrorCode agree(MPI_Comm comm, Overlap *first) {
  PetscFunctionBeginUser;
  const std::array<int, 4> mine{first->body == 0, !first->same_place, first->body, first->other};
  std::array<int, 4> least{};
  for (std::size_t n = 0; n < mine.size(); ++n) {  // of the ranks that have the least of all before it
    const bool last = !std::equal(mine.begin(), mine.begin() + n, least.begin());
    const int value = last ? std::numeric_limits<int>::max() : mine[n];
    PetscCallMPI(MPI_Allreduce(&value, &least[n], 1, MPI_INT, MPI_MIN, comm));
  }
  double volume = mine == least ? first->volume : 0;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &volume, 1, MPI_DOUBLE, MPI_MAX, comm));
  *first = {least[2], least[3], volume, least[1] == 0};
  PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode find_overlap(MPI_Comm comm, const Config &config, std::string *warning, std::string *refusal) {
  PetscFunctionBeginUser;
  warning->clear();
  refusal->clear();
  if (!config.initial_state.empty()) PetscFunctionReturn(0);
  const auto is_file = [](const SpeciesSpec &spec) { return spec.shape == Shape::voxels; };
  const bool files = std::any_of(config.species.begin(), config.species.end(), is_file);
  if (!files && !may_overlap(config.species, config.places)) PetscFunctionReturn(0);
  int rank, ranks;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  // Any split does, also where there are more ranks than the cells of -check_only are for.
  GridSpec spec = config.grid;
  spec.processors = {};
  spec.starts = {};
  const bool share = Domain::refusal_reason(spec, ranks).empty();
  const Domain domain = Domain::planned(spec, share ? ranks : 1);
  const Layout box = share || rank == 0 ? domain.split().box_of(rank, spec, 0).layout() : Layout{};
  std::vector<Places> near(config.species.size());
  for (std::size_t s = 0; s < near.size(); ++s)
    PetscCall(send_to_near_ranks(comm, domain, config.species[s], config.places[s], &near[s]));
  Overlap first;
  std::vector<int> overlaps;
  if (may_overlap(config.species, config.places)) overlaps = find_overlaps(config.species, near, config.grid, &first);
  for (std::size_t s = 0; s < near.size(); ++s)
    if (is_file(config.species[s]))
      PetscCall(compare_with_file(comm, config, {config.grid, box.begin, box.cells}, near, s, &overlaps, &first));
  PetscCall(agree(comm, &first));
  long count;
  PetscCall(count_bodies(comm, first_labels(config.species, config.places).back() - 1, &overlaps, &count));
  if (first.same_place)
    *refusal = describe_same_place(config, first);
  else if (first.body > 0)
    *warning = describe(config, first, count);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
