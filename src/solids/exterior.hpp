// Extrapolation of B to four layers of points outside a body; B = I beyond, so that WENO5 never reads a jump to I.
//
// B evolves where phi > 1/2 (on edges: the mean phi of four centres). Layer L contains the remaining points with a face
// neighbour in layer L - 1, and takes the mean of its neighbours in lower layers. Only lower layers are read, so the
// order of points does not matter. Ghosts are extended together with owned points: B needs four valid ghost layers
// where it evolves; afterwards three must be exchanged.
#pragma once

#include "base/petsc.hpp"
#include "field/extend_layer.hpp"
#include "field/ghost_exchange.hpp"
#include "field/material.hpp"
#include "field/phase.hpp"
#include "grid/bit_rows.hpp"
#include "grid/box.hpp"
#include "solids/transport.hpp"

namespace eulastic {

/// B evolves where at least half of a point is solid. The margin on edges keeps round-off in the mean of full and empty
/// centres from deciding.
inline constexpr EvolveRule evolve_above_half{0.5, 0.5 + 1e-6, 1e-30, 4};
/// Anchored bodies: B evolves only where all is solid. With linear extrapolation, limited by minmod, this is of second
/// order wherever the surface is located.
inline constexpr EvolveRule evolve_where_full{0.99, 0.99, 1e-30, 4, 2, true};

/// Whether the body's viscosity damps elastic waves as short as a cell, sqrt(G/rho) h <= nu. Linear extrapolation at an
/// anchored body amplifies such waves where it does not.
bool damps_short_waves(const Real3 &spacing, int dimension, const Fluid &fluid, const Material &material);
/// The largest spacing at which damps_short_waves() holds; infinite without elasticity.
double damping_spacing(const Fluid &fluid, const Material &material);

/// The points of each layer; to be rebuilt whenever phi has changed.
class ExteriorLayers {
public:
  static constexpr int layers = evolve_above_half.layers;

  /// Finds the layers around the bodies of the phase. phi needs five valid ghost layers; find_solid() must have run.
  PetscErrorCode build(const Box &box, const Phase &phase);
  /// Extrapolates all components of B to the layers. Other points outside keep their value, I. Linear extrapolation
  /// reads three points inwards, so that for anchored bodies ghosts are exchanged after the first and the third layer;
  /// `exchange` is null for boxes that are complete on this rank.
  PetscErrorCode extend(const Box &box, const BoundaryConditions &sides, GhostExchange *exchange, Field &tensor) const;
  /// Number of points in the layers of all locations.
  double points() const noexcept;

private:
  struct Location {
    Staggering staggering{};
    std::array<std::vector<LayerPoint>, layers> layer;
  };
  using Masks = std::vector<BitRows>;  ///< [L]: the points that evolve or are in the layers up to L
  void build_location(const Box &box, const Phase &phase, Masks *masks, Location *location) const;
  double extend_part(const Box &box, int layer, int part, int parts, double *B) const;

  bool linear_ = false;
  std::vector<Location> locations_;  ///< centres first, then one for each off-diagonal component
  std::vector<Masks> masks_;         ///< for each location with threads, else for one at a time
};

}  // namespace eulastic
