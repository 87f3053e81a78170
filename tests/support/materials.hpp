// Materials by their coefficients.
#pragma once

#include "field/material.hpp"

namespace eulastic::test {

inline Material mooney_rivlin(double c1, double c2, double c3) {
  Material m{2 * (c1 + c2)};
  m.law = Law::mooney_rivlin;
  m.c1 = c1, m.c2 = c2, m.c3 = c3;
  return m;
}

}  // namespace eulastic::test
