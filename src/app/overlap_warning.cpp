#include "app/overlap_warning.hpp"

#include "bodies/overlap.hpp"
#include "bodies/shapes.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

namespace eulastic {
namespace {

const SpeciesSpec &species_of(const Config &config, int label) {
  std::size_t s = 0;
  for (int last = 0; s + 1 < config.species.size(); ++s) {
    last += config.species[s].shape == Shape::voxels ? 1 : static_cast<int>(config.places[s].size());
    if (label <= last) break;
  }
  return config.species[s];
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
  const double smaller = std::min(volume_in_box(one, config.grid), volume_in_box(two, config.grid));
  const bool moves_two = !two.material().attached;
  char text[512];
  std::snprintf(
      text, sizeof text,
      "%ld bodies overlap as placed; first body %d (%s) and body %d (%s), which share %s at least %.3g, %.3g %% of "
      "the smaller; ",
      count, first.body, one.name.c_str(), first.other, two.name.c_str(),
      config.grid.cells[2] == 1 ? "an area of" : "a volume of", first.volume, 100 * first.volume / smaller);
  return text + remedy(moves_two ? two : one);
}

}  // namespace

PetscErrorCode find_overlap_warning(MPI_Comm comm, const Config &config, std::string *warning) {
  PetscFunctionBeginUser;
  warning->clear();
  if (!config.initial_state.empty()) PetscFunctionReturn(0);
  int rank, ranks;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  Overlap first;
  std::vector<char> overlaps = find_overlaps(config.species, config.places, config.grid, rank, ranks, &first);
  if (overlaps.empty()) PetscFunctionReturn(0);  // on all ranks
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, overlaps.data(), static_cast<int>(overlaps.size()), MPI_SIGNED_CHAR, MPI_MAX, comm));
  std::vector<Overlap> firsts(ranks);
  PetscCallMPI(MPI_Allgather(&first, sizeof first, MPI_BYTE, firsts.data(), sizeof first, MPI_BYTE, comm));
  for (const Overlap &other : firsts)
    if (other.body > 0 &&
        (first.body == 0 || std::make_pair(other.body, other.other) < std::make_pair(first.body, first.other)))
      first = other;
  if (first.body > 0) *warning = describe(config, first, std::count(overlaps.begin(), overlaps.end(), 1));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
