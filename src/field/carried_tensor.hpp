// What a phase carries beside phi: a symmetric tensor that remembers its deformation.
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
  Staggering at{};  ///< where it lives

  bool on_edge() const { return at != at_centre; }  ///< between four centres
  /// The centres around a point on an edge are itself, and less one, the other, and both of these steps in a field; 0
  /// of a point at a centre.
  std::array<std::ptrdiff_t, 2> steps(ConstView view) const {
    return {on_edge() ? view.stride(a) : 0, on_edge() ? view.stride(b) : 0};
  }
  double rest() const { return a == b ? 1 : 0; }
  std::string name() const { return {"xyz"[a], "xyz"[b]}; }
};
/// In the order of their field: xx, yy, xy in 2-D (zz stays 1) and xx, yy, zz, yz, xz, xy in 3-D; off-diagonals lie on
/// edges, or all of it is `centred`.
const std::vector<TensorComponent> &tensor_components(int dimension, bool centred = false);
/// One component of every place where those of a solid live: centres, then the edges in the order of the field.
std::vector<TensorComponent> tensor_locations(int dimension);

/// Where a tensor evolves, and what is outside: I, or an extension; by that also what of it counts as unresolved
/// (solids/unresolved.hpp).
struct EvolveRule {
  static constexpr double nowhere = std::numeric_limits<double>::infinity(), everywhere = -nowhere;  ///< of any phi
  double centre = nowhere, edge = nowhere;  ///< least solid fraction, at centres and (mean of four) on edges
  double stressed = nowhere;                ///< least solid fraction that makes stress
  int layers = 0;                           ///< how far it is extended outside, in points
  int reach = 2;                ///< how far from such solid faces feel stress, that of a step before included
  bool linear = false;          ///< extended linearly, else as a constant
  double viscosity_excess = 0;  ///< mu_s/mu_f - 1, where the edge stress goes with the viscosity; docs/method.md, (29b)
};

/// Of membranes: nothing inside evolves; faces feel forces four cells around the body (bending), and one more.
inline constexpr EvolveRule around_membranes{EvolveRule::nowhere, EvolveRule::nowhere, 1e-30, 0, 5};

/// use(viscosity) with what the kernels of the elastic stress ask of the viscosities of solid and fluid.
template <class Use>
EULASTIC_INLINE auto with_viscosity(const EvolveRule &rule, const Use &use) {
  if (rule.viscosity_excess != 0) return use(kernels::OwnViscosity{rule.viscosity_excess});
  return use(kernels::SameViscosity{});
}

/// B of a solid, its off-diagonals on edges, or B_s of a membrane, all of it at centres.
struct CarriedTensor {
  Field field;  ///< I where nothing evolves or is extended
  bool centred = false;
  EvolveRule rule{};
  ActiveSegments evolving;  ///< points where it may evolve
  ActiveSegments strained;  ///< points where it may differ from I: those and the layers it is extended over
  ActiveSegments stressed;  ///< faces that feel its stress

  /// In the order of `field`, each with its place.
  const std::vector<TensorComponent> &components() const {
    return tensor_components(field.count() == 3 ? 2 : 3, centred);
  }
};

/// I everywhere.
Field tensor_at_rest(const Box &box);

}  // namespace eulastic
