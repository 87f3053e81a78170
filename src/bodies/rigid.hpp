// Finds the faces of the velocity that are inside rigid bodies, and those beside their surfaces.
#pragma once

#include "bodies/volume_fraction.hpp"
#include "field/ghost_exchange.hpp"
#include "field/phase.hpp"
#include "field/rigid_faces.hpp"

namespace eulastic {

/// Collects the bodies of all rigid species, then makes the faces. Where the surface crosses a link is found from the
/// shape itself; of bodies from files from phi, interpolated, = 1/2.
class RigidBuilder {
public:
  RigidBuilder(const Grid &grid, GhostExchange &exchange);
  /// Owned cells of `phase` are set. Collective. Bodies get their indices as they come.
  PetscErrorCode add(const SpeciesSpec &spec, const std::vector<BodyPlace> &places, Phase *phase);
  /// Collective; null where no species is rigid.
  PetscErrorCode finish(std::unique_ptr<RigidFaces> *faces);

private:
  /// A body, or all bodies of a file.
  struct Source {
    std::shared_ptr<const Surface> surface;  ///< null: of a file
    std::unique_ptr<PlacedBody> body;
  };
  void mark_body(int a, const PlacedBody &body, int index);
  void mark_file(int a, ConstView phi, int index);
  double crossing(int image, const Real3 &outside, const Real3 &inside, double level_outside,
                  double level_inside) const;
  RigidFaces::Cut cut_at(int a, int i, int j, int k) const;
  RigidFaces::Component component(int a, const Int3 &layers) const;

  const Grid &grid_;
  GhostExchange &exchange_;
  std::unique_ptr<RigidFaces> faces_;
  std::vector<Source> sources_;       ///< of every body
  std::array<FieldBlock, 3> inside_;  ///< of every component: 1 + image of the body a face is in, level of files
};

}  // namespace eulastic
