// Selects the constitutive law of a material; no other code branches on the law of a solid.
#pragma once

#include "field/material.hpp"
#include "kernels/elastic.hpp"

namespace eulastic {

/// Calls use(law) with the law of a material, or of any struct with the same coefficients.
template <class Material, class Use>
EULASTIC_INLINE auto with_law(const Material &m, const Use &use) {
  switch (m.law) {
    case Law::mooney_rivlin:
      return use(kernels::MooneyRivlin{2 * m.c1, 2 * m.c2, 4 * m.c3});
    case Law::membrane:  // fluid inside
    case Law::red_cell:
    case Law::rigid:  // no stress: the velocity is prescribed
    case Law::neo_hookean:
      break;
  }
  return use(kernels::NeoHookean{m.shear_modulus});
}

}  // namespace eulastic
