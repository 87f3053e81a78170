#include "app/overlap_warning.hpp"

#include "app/voxels.hpp"
#include "bodies/overlap.hpp"
#include "bodies/shapes.hpp"
#include "io/fail_together.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

namespace eulastic {
namespace {

// The first label of every species, and one more.
std::vector<int> first_labels(const Config &config) {
  std::vector<int> first{1};
  for (std::size_t s = 0; s < config.species.size(); ++s)
    first.push_back(first[s] +
                    (config.species[s].shape == Shape::voxels ? 1 : static_cast<int>(config.places[s].size())));
  return first;
}

const SpeciesSpec &species_of(const Config &config, int label) {
  const std::vector<int> first = first_labels(config);
  std::size_t s = 0;
  while (label >= first[s + 1]) ++s;
  return config.species[s];
}

bool is_before(const Overlap &one, const Overlap &two) {
  return two.body == 0 || std::make_pair(one.body, one.other) < std::make_pair(two.body, two.other);
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
  const bool moves_two = !two.material().attached && two.shape != Shape::voxels, of_one = volume(one) < volume(two);
  char text[512];
  std::snprintf(text, sizeof text,
                "%ld bodies overlap as placed; first body %d (%s) and body %d (%s), which share %s of at least %.3g, "
                "%.3g %% of body %d; ",
                count, first.body, one.name.c_str(), first.other, two.name.c_str(),
                config.grid.cells[2] == 1 ? "an area" : "a volume", first.volume,
                100 * first.volume / std::min(volume(one), volume(two)), of_one ? first.body : first.other);
  return text + remedy(moves_two ? two : one);
}

// Bodies and those of a species from a file, which each rank reads some layers of.
PetscErrorCode compare_with_file(MPI_Comm comm, const Config &config, std::size_t file, std::vector<char> *overlaps,
                                 Overlap *first) {
  PetscFunctionBeginUser;
  const SpeciesSpec &solid = config.species[file];
  std::vector<std::size_t> others;
  std::vector<SharedVolumes> shared;
  for (std::size_t s = 0; s < config.species.size(); ++s) {
    const SpeciesSpec &spec = config.species[s];
    if (spec.shape == Shape::voxels || spec.placement == Placement::random) continue;
    if (spec.material().attached && solid.material().attached) continue;
    others.push_back(s);
    shared.push_back({std::vector<std::int64_t>(config.places[s].size()), std::vector<char>(config.places[s].size())});
  }
  if (others.empty()) PetscFunctionReturn(0);
  int rank, ranks;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  const std::int64_t layers = config.grid.cells[2];
  const auto limit = [&](int r) { return static_cast<int>(layers * r / ranks); };
  PetscCall(fail_together(comm, read_voxels(solid, config.grid, limit(rank), limit(rank + 1),
                                            [&](const CellWindow &window, ConstView fraction) {
                                              for (std::size_t n = 0; n < others.size(); ++n)
                                                add_shared(config.species[others[n]], config.places[others[n]],
                                                           config.grid, window, fraction, &shared[n]);
                                            })));
  double cell = std::ldexp(1.0, -30);
  for (int d = 0; d < (config.grid.cells[2] == 1 ? 2 : 3); ++d) cell *= config.grid.length[d] / config.grid.cells[d];
  const std::vector<int> label = first_labels(config);
  for (std::size_t n = 0; n < others.size(); ++n) {
    const int count = static_cast<int>(shared[n].overlaps.size());
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, shared[n].overlaps.data(), count, MPI_SIGNED_CHAR, MPI_MAX, comm));
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, shared[n].volume.data(), count, MPI_INT64_T, MPI_SUM, comm));
    for (int b = 0; b < count; ++b) {
      if (!shared[n].overlaps[b]) continue;
      const auto [one, two] = std::minmax({label[others[n]] + b, label[file]});
      (*overlaps)[one - 1] = (*overlaps)[two - 1] = 1;
      const Overlap pair{one, two, cell * double(shared[n].volume[b])};
      if (is_before(pair, *first)) *first = pair;
    }
  }
  PetscFunctionReturn(0);
}

// Bodies of shapes.
PetscErrorCode compare_shapes(MPI_Comm comm, const Config &config, std::vector<char> *overlaps, Overlap *first) {
  PetscFunctionBeginUser;
  int rank, ranks;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  std::vector<char> found = find_overlaps(config.species, config.places, config.grid, rank, ranks, first);
  if (found.empty()) PetscFunctionReturn(0);  // on all ranks
  overlaps->swap(found);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, overlaps->data(), static_cast<int>(overlaps->size()), MPI_SIGNED_CHAR,
                             MPI_MAX, comm));
  std::vector<Overlap> firsts(ranks);
  PetscCallMPI(MPI_Allgather(first, sizeof *first, MPI_BYTE, firsts.data(), sizeof *first, MPI_BYTE, comm));
  for (const Overlap &other : firsts)
    if (other.body > 0 && is_before(other, *first)) *first = other;
  PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode find_overlap_warning(MPI_Comm comm, const Config &config, std::string *warning) {
  PetscFunctionBeginUser;
  warning->clear();
  if (!config.initial_state.empty()) PetscFunctionReturn(0);
  Overlap first;
  std::vector<char> overlaps(first_labels(config).back() - 1, 0);
  PetscCall(compare_shapes(comm, config, &overlaps, &first));
  for (std::size_t s = 0; s < config.species.size(); ++s)
    if (config.species[s].shape == Shape::voxels) PetscCall(compare_with_file(comm, config, s, &overlaps, &first));
  if (first.body > 0) *warning = describe(config, first, std::count(overlaps.begin(), overlaps.end(), 1));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
