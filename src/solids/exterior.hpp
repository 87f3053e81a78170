// B outside the body: constant extrapolation over four layers, I beyond, so that WENO5 never sees a jump to I.
//
// B evolves where phi > 1/2 (on edges: where the mean of the four centres is). Layer L holds the other points with a
// face neighbour in layer L - 1 and takes the mean of its neighbours in the layers before. Synchronous: only lower
// layers are read. Ghosts are extended along with the owned points: B needs four valid ghost layers where it
// evolves, and afterwards an exchange of three.
#pragma once

#include "base/petsc.hpp"
#include "field/extend_layer.hpp"
#include "field/ghost_exchange.hpp"
#include "field/material.hpp"
#include "field/phase.hpp"
#include "grid/box.hpp"
#include "solids/transport.hpp"

namespace eulastic {

/// B evolves where at least half of the point is solid; a little more on edges, so that round-off in a mean of full
/// and empty centres does not decide.
inline constexpr EvolveRule evolve_above_half{0.5, 0.5 + 1e-6, 1e-30, 4};
/// Attached bodies: only where all is solid. With linear extension, of the smaller of two slopes, that is second order
/// wherever the surface lies.
inline constexpr EvolveRule evolve_where_full{0.99, 0.99, 1e-30, 4, 2, true};

/// Whether the body's viscosity damps elastic waves as short as a cell, sqrt(G/rho) h <= nu: linear extension of an
/// attached body amplifies those that it does not.
bool damps_short_waves(const Real3 &spacing, int dimension, const Fluid &fluid, const Material &material);
/// The largest spacing at which it does; infinite without elasticity.
double damping_spacing(const Fluid &fluid, const Material &material);

/// Which points each layer holds; made anew whenever phi has changed.
class ExteriorLayers {
public:
  static constexpr int layers = evolve_above_half.layers;

  /// phi of the phase needs five valid ghost layers; find_solid() has run.
  PetscErrorCode build(const Box &box, const Phase &phase);
  /// Extends all components of B. Points outside every layer are left alone (they hold I). Linear extension sees
  /// three points in, so that attached bodies exchange ghosts after every layer; `exchange` is null for boxes that are
  /// whole on this rank.
  PetscErrorCode extend(const Box &box, const BoxSides &sides, GhostExchange *exchange, Field &tensor) const;
  /// Points in the layers of all locations.
  double points() const noexcept;

private:
  struct Location {
    Staggering staggering{};
    std::array<std::vector<LayerPoint>, layers> layer;
  };
  using Mask = std::vector<unsigned char>;
  void build_location(const Box &box, const Phase &phase, Mask *layer_of, Location *location) const;
  double extend_part(const Box &box, int layer, int part, int parts, double *B) const;

  bool linear_ = false;
  std::vector<Location> locations_;  ///< centres first, then one per off-diagonal component
  std::vector<Mask> masks_;          ///< of every location, without threads of one at a time
};

}  // namespace eulastic
