// The tensor that a phase transports beside phi: the left Cauchy-Green tensor of a solid or the surface strain of a
// membrane.
#pragma once

#include "field/field.hpp"
#include "grid/active_segments.hpp"
#include "kernels/solid_shear.hpp"

#include <array>
#include <cstddef>
#include <limits>
#include <string>

namespace eulastic {

struct TensorComponent {
  int a, b;
  Staggering at{};  ///< its position

  bool on_edge() const { return at != at_centre; }  ///< between four centres
  /// Returns the two strides whose negatives lead from a point on an edge to the other centres around it: the centres
  /// are at the offsets 0, -first, -second and their sum. Both are 0 for a point at a centre.
  std::array<std::ptrdiff_t, 2> steps(ConstView view) const {
    return {on_edge() ? view.stride(a) : 0, on_edge() ? view.stride(b) : 0};
  }
  double rest() const { return a == b ? 1 : 0; }
  std::string name() const { return {"xyz"[a], "xyz"[b]}; }
};
/// Returns the components in the order of their field: xx, yy, xy in 2-D (zz stays 1) and xx, yy, zz, yz, xz, xy in
/// 3-D. Off-diagonal components are located on edges, or, if `centred`, at centres.
const std::vector<TensorComponent> &tensor_components(int dimension, bool centred = false);
/// Returns one component for every position of a solid's tensor: centres, then the edges in the order of the field.
std::vector<TensorComponent> tensor_locations(int dimension);

/// The rule by which a tensor evolves near bodies and is extrapolated outside. It also determines which strain counts
/// as unresolved (solids/unresolved.hpp).
struct EvolveRule {
  /// thresholds for no phi and for any phi
  static constexpr double nowhere = std::numeric_limits<double>::infinity(), everywhere = -nowhere;
  /// least solid fraction for evolution, at centres and (mean of four) on edges
  double centre = nowhere, edge = nowhere;
  double stressed = nowhere;    ///< least solid fraction that causes stress
  int layers = 0;               ///< number of layers of points to which the tensor is extrapolated
  int reach = 2;                ///< distance from cells with stress at which faces may feel it, now or a step ago
  bool linear = false;          ///< linear extrapolation, otherwise constant
  double viscosity_excess = 0;  ///< mu_s/mu_f - 1 where (29b) applies to the edge stress, otherwise 0
};

/// Rule for the surroundings of membranes: B_s does not evolve inside, and faces feel forces up to four cells around
/// the body (bending), or five with the motion in a step.
inline constexpr EvolveRule around_membranes{EvolveRule::nowhere, EvolveRule::nowhere, 1e-30, 0, 5};

/// Calls use(viscosity) with the viscosity type for the kernels of the elastic stress: SolidViscosity or SameViscosity.
template <class Use>
EULASTIC_INLINE auto with_viscosity(const EvolveRule &rule, const Use &use) {
  if (rule.viscosity_excess != 0) return use(kernels::SolidViscosity{rule.viscosity_excess});
  return use(kernels::SameViscosity{});
}

/// B of a solid, with off-diagonal components on edges, or B_s of a membrane, with all components at centres.
struct CarriedTensor {
  Field field;  ///< I where the tensor neither evolves nor is extrapolated
  bool centred = false;
  EvolveRule rule{};
  ActiveSegments evolving;  ///< points where the tensor may evolve
  ActiveSegments strained;  ///< points where it may differ from I: evolving points and the layers around them
  ActiveSegments stressed;  ///< faces that feel the stress

  /// Returns the components in the order of `field`, with their positions.
  const std::vector<TensorComponent> &components() const {
    return tensor_components(field.count() == 3 ? 2 : 3, centred);
  }
};

/// Returns a tensor field of the value I.
Field undeformed_tensor(const Box &box);

}  // namespace eulastic
