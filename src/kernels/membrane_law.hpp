// Parameters of an elastic surface around a fluid.
#pragma once

namespace eulastic::kernels {

enum class MembraneLaw { neo_hookean, skalak };
/// Storage of the undeformed shape: in the strain on the grid alone, or also in markers on the surface.
enum class MembraneScheme { grid, markers };

/// Shear modulus G_s (force per length) and, for Skalak's law, C: the area modulus is 3 G_s for a neo-Hookean membrane
/// and (1 + 2 C) G_s for Skalak's law.
struct Membrane {
  MembraneLaw law = MembraneLaw::neo_hookean;
  double shear_modulus = 0, area_modulus = 1;
  double initial_area_stretch = 1;
  double bending_modulus = 0, spontaneous_curvature = 0;  ///< E_b (energy) and c0 (1/length; 2/R of a ball at rest)
  MembraneScheme scheme = MembraneScheme::markers;
  double largest_modulus() const {
    return shear_modulus * (1 + (law == MembraneLaw::neo_hookean ? 3 : 1 + 2 * area_modulus));
  }
};

}  // namespace eulastic::kernels
