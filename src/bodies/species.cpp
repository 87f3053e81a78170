#include "bodies/species.hpp"

#include "field/law.hpp"

namespace eulastic {

Material SpeciesSpec::material() const {
  const double at_rest = with_law(*this, [](const auto &chosen) { return chosen.shear_modulus(); });
  return {at_rest,
          anchored.value_or(is_anchored(shape)),
          is_membrane() ? Law::membrane : law,
          c1,
          c2,
          c3,
          viscosity.value_or(0),
          surface_tension,
          body_force,
          membrane,
          stretch_force};
}

}  // namespace eulastic
