#include "base/one_line.hpp"
#include "scene/scene_warnings.hpp"

#include "bodies/crowd.hpp"
#include "bodies/overlap.hpp"
#include "bodies/region.hpp"
#include "bodies/shapes.hpp"

#include <algorithm>
#include <climits>

namespace eulastic {
namespace {

// What keeps a film of a cell between itself and membranes.
class Walls {
public:
  explicit Walls(const Config &config)
      : config_(config),
        dimension_(config.grid.dimension()),
        film_(config.grid.longest_spacing() * (1 - 1e-9)),  // less the round-off of bodies a cell away
        posts_(config.grid, 2 * (config.grid.length[0] + config.grid.length[1] + config.grid.length[2]), 1) {
    shapes_.reserve(config.species.size());  // bodies point into it
    for (std::size_t s = 0; s < config.species.size(); ++s) {
      const SpeciesSpec &spec = config.species[s];
      if (spec.law != Law::rigid || spec.travels(dimension_)) continue;
      if (is_anchored(spec.shape)) attached_.push_back(spec);
      if (is_anchored(spec.shape) || spec.shape == Shape::voxels) continue;
      shapes_.emplace_back(spec, dimension_, film_, config.grid.length[spec.axis]);
      for (const BodyPlace &place : config.places[s].known)
        posts_.add({&shapes_.back(), place.centre, rotation(place.orientation)});
    }
    GridSpec endless = config.grid;  // is_near_side() knows which sides are solid
    endless.boundary.fill(Boundary::periodic);
    const auto add = [&](const SpeciesSpec *tube) {
      regions_.emplace_back(attached_, std::vector<Places>(), tube, no_files_, endless, film_);
    };
    add(nullptr);
    for (const SpeciesSpec &spec : attached_)
      if (is_tube(spec.shape)) add(&spec);
  }

  bool are_near(const SpeciesSpec &spec, const Surface &surface, const BodyPlace &place) const {
    const ConvexBody shape(spec, dimension_, 0);
    const PlacedConvex body{&shape, place.centre, rotation(place.orientation)};
    return is_near_side(surface, place) || !posts_.has_room_for(body) ||
           std::any_of(regions_.begin(), regions_.end(), [&](const Region &region) { return !region.holds(body); });
  }

private:
  bool is_near_side(const Surface &surface, const BodyPlace &place) const {
    for (int d = 0; d < dimension_; ++d) {
      if (config_.grid.boundary[d] != Boundary::wall) continue;
      const double extent = surface.support(rotation(place.orientation)[d]) + film_;
      if (is_solid(config_.sides[d][0].kind) && place.centre[d] < extent) return true;
      if (is_solid(config_.sides[d][1].kind) && place.centre[d] + extent > config_.grid.length[d]) return true;
    }
    return false;
  }

  const Config &config_;
  int dimension_;
  double film_;
  std::vector<ConvexBody> shapes_;
  Crowd posts_;
  std::vector<SpeciesSpec> attached_;  ///< slabs and tubes
  const SolidBodies no_files_{};
  std::vector<Region> regions_;
};

}  // namespace

PetscErrorCode find_membranes_near_walls(MPI_Comm comm, const Config &config, std::string *warning) {
  PetscFunctionBeginUser;
  warning->clear();
  const auto is_placed = [](const SpeciesSpec &s) { return s.is_membrane() && s.placement != Placement::random; };
  if (!config.initial_state.empty() || std::none_of(config.species.begin(), config.species.end(), is_placed))
    PetscFunctionReturn(0);
  const Walls walls(config);
  const std::vector<int> labels = first_labels(config.species, config.places);
  int first = INT_MAX;
  for (std::size_t s = 0; s < config.species.size(); ++s) {
    const SpeciesSpec &spec = config.species[s];
    if (!is_placed(spec) || is_from_file(spec.shape)) continue;
    const Surface surface(spec, config.grid.dimension());
    for (const NumberedPlace &place : config.places[s].known)
      if (walls.are_near(spec, surface, place)) first = std::min(first, labels[s] + place.index);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, comm));
  if (first == INT_MAX) PetscFunctionReturn(0);
  std::size_t s = 0;
  while (first >= labels[s + 1]) ++s;
  *warning = print(
      "the membrane of body %d (%s) starts less than a cell, %.3g, from a wall: the film of fluid between them "
      "is not resolved and makes energy while it pushes it away; place it farther away, or use a "
      "smaller spacing",
      first, config.species[s].name.c_str(), config.grid.longest_spacing());
  PetscFunctionReturn(0);
}

}  // namespace eulastic
